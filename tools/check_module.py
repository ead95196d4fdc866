# SPDX-License-Identifier: GPL-3.0-or-later
"""What a native module may ask of the system that loads it, and give to others in its process.

check_module.py MODULE...    prints what is broken; exit code 1 if anything is
"""

import re
import subprocess
import sys
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


def _run(*command: object) -> str:
    return subprocess.run(
        [str(word) for word in command], check=True, capture_output=True, text=True
    ).stdout


def broken_rules(module: Path) -> list[str]:
    """In words, each with what it is about."""
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
    return problems


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
    problems = [f"{module}: {p}" for module in sys.argv[1:] for p in broken_rules(Path(module))]
    if problems:
        sys.exit("\n".join(problems))


if __name__ == "__main__":
    main()
