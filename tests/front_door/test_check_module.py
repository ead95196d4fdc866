# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of a module that any Linux loads: each broken by a small module of its own."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from check_module import broken_rules  # noqa: E402

ENTRY = "void *PyInit_granita_core(void) { return 0; }\n"
MAP = "-Wl,--version-script=" + str(ROOT / "cmake/exports.map")


@pytest.fixture
def problems(tmp_path):
    """problems(C text, *flags) -> what the rules say of a shared library made of it."""

    def check(text, *flags, strip=True):
        source, module = tmp_path / "m.c", tmp_path / "m.so"
        source.write_text(text)
        command = [
            "gcc",
            "-shared",
            "-fPIC",
            "-O1",
            "-nostartfiles",
            str(source),
            "-o",
            str(module),
        ]
        subprocess.run([*command, *flags], check=True, capture_output=True)
        if strip:
            subprocess.run(["strip", str(module)], check=True)
        return " ".join(broken_rules(module))

    return check


def test_a_plain_module_breaks_none(problems):
    python = "extern void *PyModule_Create2(void *, int);\n"
    python += "void *PyInit_granita_core(void) { return PyModule_Create2(0, 1013); }\n"
    assert problems(python, MAP) == ""


def test_a_library_beside_glibc_is_named(problems, tmp_path):
    (tmp_path / "other.c").write_text("void *other(void) { return 0; }\n")
    other = str(tmp_path / "libother.so.7")
    command = ["gcc", "-shared", "-fPIC", str(tmp_path / "other.c"), "-Wl,-soname,libother.so.7"]
    subprocess.run([*command, "-o", other], check=True)
    text = "extern void *other(void);\n" + ENTRY.replace("return 0", "return other()")
    assert "needs libother.so.7" in problems(text, MAP, other)


def test_an_export_is_named(problems):
    assert "exports other" in problems(ENTRY + "int other(void) { return 1; }\n")


def test_a_module_without_its_entry_is_told(problems):
    assert "PyInit_granita_core" in problems("int f(void) { return 1; }\n", MAP)


def test_newer_glibc_is_named(problems):
    text = "#include <stdlib.h>\nextern unsigned arc4random(void);\n"
    text += ENTRY.replace("return 0", "return (void *)(long)arc4random()")
    assert "needs glibc 2.36" in problems(text, MAP)


def test_a_weak_hook_is_named(problems):
    text = "extern void *scalable_malloc(unsigned long) __attribute__((weak));\n"
    text += ENTRY.replace("return 0", "return scalable_malloc ? scalable_malloc(1) : 0")
    assert "weak hooks that a host could bind: scalable_malloc" in problems(text, MAP)


def test_a_symbol_of_no_library_is_named(problems):
    text = "extern void *rtcNewDevice(void);\n" + ENTRY.replace("return 0", "return rtcNewDevice()")
    assert "needs symbols of no library: rtcNewDevice" in problems(text, MAP)


def test_symbols_and_search_paths_are_found(problems):
    assert "is not stripped" in problems(ENTRY, MAP, strip=False)
    assert "has RUNPATH" in problems(ENTRY, MAP, "-Wl,-rpath,/home/me")


def test_a_path_of_the_machine_is_named(problems):
    text = 'const char *where = "/home/me/granita/thing.hpp";\n'
    text += ENTRY.replace("return 0", "return (void *)where")
    assert "names folders of the machine: /home/me/granita/thing.hpp" in problems(text, MAP)
