# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of docs/decisions/portable.md on zips that users download.

check_package.py ZIP... [-- VALIDATOR...]    prints what is broken; exit code 1 if anything is

VALIDATOR: a Python interpreter and Blender's blender_ext.py, joined by a colon.
"""

import json
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from check_module import broken_rules

MOST_BYTES = 40 * 2**20
MODULES = {f"granita_core.cpython-{v}-x86_64-linux-gnu.so" for v in ("311", "313")}


def broken_package_rules(path: Path) -> list[str]:
    problems = []
    if path.stat().st_size > MOST_BYTES:
        problems.append(f"has {path.stat().st_size / 2**20:.1f} MiB")
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        prefix = "granita/" if path.stem.endswith("-legacy") else ""
        if names != sorted(names) or any(i.date_time[0] != 1980 for i in archive.infolist()):
            problems.append("is not the same whenever it is made")
        if any(not name.startswith(prefix) for name in names):
            problems.append(f"holds files outside of {prefix}")
        modules = {n.removeprefix(prefix) for n in names if n.endswith(".so")}
        if modules != MODULES:
            problems.append(f"has the modules {sorted(modules)}, not {sorted(MODULES)}")
        for name in ("LICENSE", "THIRD-PARTY.txt", "bom.cdx.json", "__init__.py"):
            if prefix + name not in names:
                problems.append(f"has no {name}")
        if not problems:
            problems += _notices(archive, prefix)
        with tempfile.TemporaryDirectory() as folder:
            for name in sorted(modules):
                module = Path(archive.extract(prefix + name, folder))
                problems += [f"{name} {problem}" for problem in broken_rules(module)]
    return problems


def _notices(archive: zipfile.ZipFile, prefix: str) -> list[str]:
    """Every library of the list has a version, a hash, a licence and its notice."""
    problems = []
    components = json.loads(archive.read(prefix + "bom.cdx.json"))["components"]
    text = archive.read(prefix + "THIRD-PARTY.txt").decode()
    for component in components:
        name, version = component["name"], component["version"]
        if f"  {name} {version}  (" not in text:
            problems.append(f"has no notice of {name} {version}")
        if len(component["hashes"][0]["content"]) != 64 or not component["licenses"]:
            problems.append(f"does not say what {name} was built from")
    return problems if components else ["lists no library"]


def refused(path: Path, validator: str) -> list[str]:
    python, _, program = validator.partition(":")
    run = subprocess.run([python, program, "validate", str(path)], capture_output=True, text=True)
    said = (run.stdout + run.stderr).strip()
    return [f"is refused by {program}: {said}"] if run.returncode or "error" in said.lower() else []


def main() -> None:
    arguments = sys.argv[1:]
    at = arguments.index("--") if "--" in arguments else len(arguments)
    paths, validators = arguments[:at], arguments[at + 1 :]
    problems = []
    for path in map(Path, paths):
        found = broken_package_rules(path)
        if not path.stem.endswith("-legacy"):
            for validator in validators:
                found += refused(path, validator)
        problems += [f"{path.name} {problem}" for problem in found]
    if problems or not paths:
        sys.exit("\n".join(problems) or __doc__)


if __name__ == "__main__":
    main()
