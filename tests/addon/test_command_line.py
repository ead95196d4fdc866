# SPDX-License-Identifier: GPL-3.0-or-later
"""Granita's options after `--`: what is read, what is refused, what is left to others."""

import pytest

from addon.command_line import CommandLine, CommandLineError, log_kind, parse

BLENDER = ["blender", "-b", "scene.blend", "-E", "GRANITA", "-f", "1"]


@pytest.mark.parametrize(
    "words, expected",
    [
        ([], CommandLine()),
        (["--granita-device", "cpu"], CommandLine(device="CPU")),
        (["--granita-device=GPU"], CommandLine(device="GPU")),
        (["--granita-device", "auto"], CommandLine(device="AUTO")),
        (["--granita-stats", "a b.json"], CommandLine(stats="a b.json")),
        (["--granita-stats=x=y"], CommandLine(stats="x=y")),
        (["--granita-threads", "0"], CommandLine(threads=0)),
        (["--granita-threads", "2", "--granita-threads", "5"], CommandLine(threads=5)),
        (["--granita-memory", "1800"], CommandLine(memory=1800)),
        (["--granita-part", "3/8", "--granita-parts=a"], CommandLine(part=(3, 8), parts="a")),
        (["--granita-log", "openjd"], CommandLine(log="openjd")),
        (["--granita-merge=64"], CommandLine(merge=64)),
        (["--cycles-device", "CPU", "scene", "--granita-threads=3"], CommandLine(threads=3)),
    ],
)
def test_reads(words, expected):
    assert parse([*BLENDER, "--", *words]) == expected


def test_words_before_the_dashes_are_blenders():
    assert parse(["blender", "--granita-device", "nonsense"]) == CommandLine()


@pytest.mark.parametrize(
    "words, message",
    [
        (["--granita-devcie", "cpu"], "unknown option --granita-devcie"),
        (["--granita-"], "unknown option --granita- "),
        (["--granita-device", "tpu"], "'tpu' is not one of cpu, gpu, auto"),
        (["--granita-device"], "--granita-device needs a value"),
        (["--granita-stats", "--granita-threads", "2"], "--granita-stats needs a value"),
        (["--granita-stats="], "--granita-stats needs a value"),
        (["--granita-threads", "two"], "'two' is not a number"),
        (["--granita-threads=-1"], "'-1' is not a number"),
        (["--granita-part", "3"], "'3' is not K/N"),
        (["--granita-part", "0/8"], "no part '0' of 8"),
        (["--granita-part", "9/8"], "no part '9' of 8"),
        (["--granita-part", "1/0"], "'0' is not a number from 1"),
        (["--granita-log", "xml"], "'xml' is not one of json, openjd"),
        (["--granita-merge", "x"], "'x' is not a number from 1"),
        (["--granita-merge=2", "--granita-part=1/2"], "exclude one another"),
        (["--granita-cut=2", "--granita-part=1/2"], "exclude one another"),
        (["--granita-cut", "0"], "'0' is not a number from 1"),
        (["--granita-threads", "1025"], "'1025' is not a number"),
        (["--granita-memory=0"], "'0' is not a number from 1"),
    ],
)
def test_refuses(words, message):
    with pytest.raises(CommandLineError) as failure:
        parse([*BLENDER, "--", *words])
    assert message in str(failure.value)


@pytest.mark.parametrize(
    "words, kind",
    [
        ([], None),
        (["--granita-log", "json"], "json"),
        (["--granita-log=json", "--granita-log", "openjd"], "openjd"),
        (["--granita-devcie", "cpu", "--granita-log", "json"], "json"),
        (["--granita-stats", "--granita-log", "json"], "json"),
        (["--granita-log", "json", "--granita-stats"], "json"),
        (["--granita-log", "xml"], None),
        (["--granita-log"], None),
    ],
)
def test_what_is_wrong_with_other_options_can_be_told_to_the_log(words, kind):
    assert log_kind([*BLENDER, "--", *words]) == kind
