# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of a module that any Linux loads: each broken by a small module of its own."""

import shutil
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
        symbols = shutil.copy(module, f"{module}.debug")
        if strip:
            subprocess.run(["strip", str(module)], check=True)
        return " ".join(broken_rules(module, symbols))

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


def test_symbols_are_found(problems):
    assert "is not stripped" in problems(ENTRY, MAP, strip=False)


@pytest.mark.parametrize(
    "tag, new", [("RUNPATH", "--enable-new-dtags"), ("RPATH", "--disable-new-dtags")]
)
def test_search_paths_are_found(problems, tag, new):
    assert problems(ENTRY, MAP, f"-Wl,-rpath,/home/me,{new}") == f"has {tag}"


def test_text_relocations_are_found(problems):
    """An address in code, which the loader would have to write there."""
    code = 'extern void *PyCode;\n__asm__(".text\\n .quad PyCode");\n'
    assert problems(code + ENTRY, MAP, "-Wl,-z,notext") == "has TEXTREL"


def test_a_path_of_the_machine_is_named(problems):
    text = 'const char *where = "/home/me/granita/thing.hpp";\n'
    text += ENTRY.replace("return 0", "return (void *)where")
    assert "names folders of the machine: /home/me/granita/thing.hpp" in problems(text, MAP)


def scale(name):
    """A function of AVX instructions by that name in the module's symbols."""
    return f"""
        __attribute__((noinline)) void scale(float *) __asm__("{name}");
        void scale(float *values) {{ for (int i = 0; i < 256; i++) values[i] *= 2; }}
        void *PyInit_granita_core(void) {{ static float v[256]; scale(v); return v; }}
    """


def test_instructions_of_newer_processors_are_named(problems):
    said = problems(scale("scale"), MAP, "-mavx2")
    assert said.startswith("has instructions beyond x86-64-v2 in 1 function(s): scale: vaddss")
    assert problems(scale("scale"), MAP) == ""


@pytest.mark.parametrize(
    "text, flag, instruction",
    [
        ("return (void *)(x >> (n & 63));", "-mbmi2", "shrx"),
        ("return (void *)(long)__builtin_clzl(x);", "-mlzcnt", "lzcnt"),
        ("return (void *)(~x & n);", "-mbmi", "andn"),
    ],
)
def test_instructions_that_are_no_vectors_are_named_too(problems, text, flag, instruction):
    text = f"void *PyInit_granita_core(unsigned long x, unsigned long n) {{ {text} }}\n"
    assert problems(text, MAP, flag).endswith(f"PyInit_granita_core: {instruction}")
    assert problems(text, MAP, "-march=x86-64-v2") == ""


@pytest.mark.parametrize(
    "name",
    [
        "_ZN7granita5shade6N_AVX25scaleEPf",
        "_ZN7granita5shade6N_AVX35scaleEPf",
        "_ZN6embree3avx5scaleEPf",
        "_ZN3tbb3runIZN6embree5buildINS_4avx24RaysEEEvvEEvv",
        "_ZN6embree4BVHNILi8EE5scaleEPf",
        "jsimd_scale_avx2",
        "jsimd_scale_avx2.loop",
        "dctInverse8x8_avx_0",
        "fromHalfZigZag_f16c",
    ],
)
def test_what_is_chosen_at_run_time_may_have_them(problems, name):
    assert problems(scale(name), MAP, "-mavx2") == ""


@pytest.mark.parametrize(
    "name", ["_ZN6embree4BVHNILi4EE5scaleEPf", "_ZN6embree5sse425scaleEPf", "_ZN3avx5scaleEPf"]
)
def test_what_is_not_chosen_may_not(problems, name):
    assert f"1 function(s): {name}: " in problems(scale(name), MAP, "-mavx2")


def test_tzcnt_may_stand_for_bsf(problems):
    """As `rep bsf`, which older processors run without the prefix."""
    text = (
        "void *PyInit_granita_core(unsigned long x) { return (void *)(long)__builtin_ctzl(x); }\n"
    )
    assert problems(text, MAP) == ""
