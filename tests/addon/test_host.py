# SPDX-License-Identifier: GPL-3.0-or-later
"""Machines that Granita's module cannot run on: each gets its reason."""

import pytest

from addon.host import INSTRUCTIONS, Host, problem, this_host


@pytest.mark.parametrize(
    "host, words",
    [
        (Host(system="Windows", machine="AMD64", libc=""), "this is Windows"),
        (Host(system="Darwin", machine="arm64", libc=""), "this is Darwin"),
        (Host(machine="aarch64"), "this one is aarch64"),
        (Host(libc=""), "GNU C library"),
        (Host(libc="glibc 2.17"), "this system has 2.17"),
        (Host(instructions=INSTRUCTIONS - {"sse4_2", "popcnt"}), "has no popcnt, sse4_2"),
    ],
)
def test_an_unfit_host_is_told_why(host, words):
    assert words in problem(host)


@pytest.mark.parametrize(
    "host",
    [
        Host(),
        Host(libc="glibc 2.40"),
        Host(libc="glibc 3.0"),
        Host(instructions=INSTRUCTIONS | {"avx2"}),
        Host(instructions=frozenset()),  # a kernel that does not say
    ],
)
def test_a_fit_host_is_left_alone(host):
    assert problem(host) == ""


def test_this_host_is_fit():
    assert problem(this_host()) == ""
    assert this_host().instructions
