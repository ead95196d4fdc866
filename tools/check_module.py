# SPDX-License-Identifier: GPL-3.0-or-later
"""What a native module may ask of the system that loads it, and give to others in its process.

check_module.py MODULE...    prints what is broken; exit code 1 if anything is

Instructions are looked at where MODULE.debug, what was stripped off it, lies beside it.
"""

import os
import re
import subprocess
import sys
from bisect import bisect
from collections import defaultdict
from pathlib import Path

# Of glibc, everywhere.
NEEDED = {
    *("libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1"),
    "ld-linux-x86-64.so.2",
}
NEWEST_GLIBC = (2, 28)
ENTRY = "PyInit_granita_core"
# Weak, and either always or never there: no library of a host answers to them.
HARMLESS_WEAK = re.compile(
    r"__gmon_start__|_ITM_(de)?registerTMCloneTable|__cxa_(finalize|thread_atexit_impl)|"
    r"__tls_get_addr|_dl_find_object|gnu_get_libc_version"
)
# What x86-64-v3 and later add, as objdump spells it: all of VEX and EVEX (`v`, and `k` for masks), BMI, LZCNT, MOVBE.
# Not TZCNT: compilers write it for v2 too where it does what BSF does.  Nor XGETBV, by which dispatch asks.
NEWER = (
    r"^ *[0-9a-f]+:\t(\{\w+\} )*(v\w+|k(add|and|mov|not|or|shift|test|unpck|xnor|xor)\w*|"
    r"andn|bextr|blsi|blsmsk|blsr|bzhi|mulx|pdep|pext|rorx|sarx|shlx|shrx|lzcnt|movbe)\b"
)
# Functions that are called on a processor that has them alone, by their mangled names.
DISPATCHED = re.compile(
    r"N_AVX\d|"  # Highway's targets, Granita's own code among them
    r"6embree.*?(?<!\d)(3avx|4avx2)|"  # Embree's kernels: its device takes the widest there is
    r"6embree.*(BVHN|BVHNStatistics|CurveN[iv]\w*)ILi8E|"  # its trees of eight, which AVX alone has
    r"^jsimd_\w+_avx2\b|"  # libjpeg-turbo's, which asks in jsimd_x86_64.c
    r"dctInverse8x8_avx|(convertFloatToHalf64|fromHalfZigZag)_f16c"  # OpenEXR's DWA, which asks once
)


def _run(*command: object) -> str:
    return subprocess.run(
        [str(word) for word in command], check=True, capture_output=True, text=True
    ).stdout


def broken_rules(module: Path, symbols: Path | None = None) -> list[str]:
    """In words, each with what it is about.  `symbols`: what was stripped off, for instructions."""
    problems = []
    dynamic = _run("readelf", "-dW", module)
    needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic))
    if needed - NEEDED:
        problems.append(f"needs {', '.join(sorted(needed - NEEDED))}")
    for tag in ("RPATH", "RUNPATH", "TEXTREL"):
        if f"({tag})" in dynamic:
            problems.append(f"has {tag}")
    exported, undefined, weak = _symbols(module)
    if exported != {ENTRY}:
        problems.append(f"exports {', '.join(sorted(exported ^ {ENTRY}))}, not {ENTRY} alone")
    versions = {
        tuple(map(int, v.split("."))) for v in re.findall(r"@GLIBC_([\d.]+)", " ".join(undefined))
    }
    if any(version > NEWEST_GLIBC for version in versions):
        problems.append(f"needs glibc {'.'.join(map(str, max(versions)))}")
    hooks = {name for name in weak if not HARMLESS_WEAK.fullmatch(name.split("@")[0])}
    if hooks:
        problems.append(f"has weak hooks that a host could bind: {', '.join(sorted(hooks))}")
    strangers = {n for n in undefined - weak if "@" not in n and not re.match(r"_?Py", n)}
    if strangers:
        problems.append(f"needs symbols of no library: {', '.join(sorted(strangers))}")
    # What assert and exceptions say of themselves: a module made elsewhere would differ.
    if paths := set(
        re.findall(rb"\0((?:\.\./|/)[\w./+-]+\.(?:c|cc|cpp|h|hpp|ipp))\0", module.read_bytes())
    ):
        problems.append(f"names folders of the machine: {min(paths).decode()}")
    sections = _run("readelf", "-SW", module)
    if re.search(r"\.(symtab|debug_)", sections):
        problems.append("is not stripped")
    if symbols:
        problems += _newer_instructions(module, symbols)
    return problems


def build_id(file: Path) -> str:
    """Hexadecimal; "" where there is none."""
    found = re.search(r"Build ID: (\w+)", _run("readelf", "-n", file))
    return found[1] if found else ""


def _newer_instructions(module: Path, symbols: Path) -> list[str]:
    """Those that a processor of x86-64-v2 lacks, in functions that any processor may call."""
    names = {}  # by address
    for line in _run("nm", "--defined-only", "--numeric-sort", symbols).splitlines():
        address, kind, name = line.split(maxsplit=2)
        if kind in "tTwWi":
            names[int(address, 16)] = name
    begins, found = list(names), defaultdict(set)
    # A module has gigabytes of it: never held whole.
    listing = ["objdump", "-d", "--no-show-raw-insn", str(module)]
    with (
        subprocess.Popen(listing, stdout=subprocess.PIPE) as objdump,
        subprocess.Popen(
            ["grep", "-P", NEWER],
            stdin=objdump.stdout,
            stdout=subprocess.PIPE,
            env={"LC_ALL": "C", "PATH": os.environ["PATH"]},
            text=True,
        ) as grep,
    ):
        for line in grep.stdout:
            address, _, instruction = line.partition(":\t")
            at = bisect(begins, int(address, 16)) - 1
            name = names[begins[at]] if at >= 0 else "a function without a name"
            if not DISPATCHED.search(name):
                found[name].add(re.sub(r"\{\w+\} ", "", instruction).split()[0])
    if objdump.returncode or grep.returncode not in (0, 1):
        return ["cannot be disassembled"]
    some = "; ".join(f"{name}: {', '.join(sorted(found[name]))}" for name in sorted(found)[:5])
    return (
        [f"has instructions beyond x86-64-v2 in {len(found)} function(s): {some}"] if found else []
    )


def _symbols(module: Path) -> tuple[set[str], set[str], set[str]]:
    """Names with versions: those that are exported, those that are not defined, the weak of these."""
    exported, undefined, weak = set(), set(), set()
    for line in _run("readelf", "--dyn-syms", "-W", module).splitlines():
        fields = line.split()
        if len(fields) < 8 or not fields[0].rstrip(":").isdigit():
            continue
        binding, section, name = fields[4], fields[6], fields[7]
        if section == "UND":
            undefined.add(name)
            if binding == "WEAK":
                weak.add(name)
        elif binding != "LOCAL" and section != "ABS":
            exported.add(name)
    return exported, undefined, weak


def main() -> None:
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    problems = []
    for module in map(Path, sys.argv[1:]):
        symbols = module.with_name(f"{module.name}.debug")
        found = broken_rules(module, symbols if symbols.is_file() else None)
        problems += [f"{module}: {problem}" for problem in found]
    if problems:
        sys.exit("\n".join(problems))


if __name__ == "__main__":
    main()
