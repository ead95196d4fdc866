# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of docs/decisions/portable.md on zips that users download.

check_package.py ZIP... [-- VALIDATOR...]    prints what is broken; exit code 1 if anything is

ZIP: the extension's or the legacy add-on's; their symbols lie beside them.
VALIDATOR: a Python interpreter and Blender's blender_ext.py, joined by a colon.
"""

import json
import subprocess
import sys
import tempfile
import zipfile
from functools import cache
from pathlib import Path

from check_module import broken_rules, build_id

MOST_BYTES = 40 * 2**20
MANIFEST = "blender_manifest.toml"
MODULES = {f"granita_core.cpython-{v}-x86_64-linux-gnu.so" for v in ("311", "313")}


def broken_package_rules(path: Path) -> list[str]:
    """In words, each with what it is about."""
    problems = []
    legacy = path.stem.endswith("-legacy")
    prefix = "granita/" if legacy else ""
    if path.stat().st_size > MOST_BYTES:
        problems.append(f"has {path.stat().st_size / 2**20:.1f} MiB")
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        if names != sorted(names) or any(i.date_time[0] != 1980 for i in archive.infolist()):
            problems.append("is not the same whenever it is made")
        if any(not name.startswith(prefix) for name in names):
            problems.append(f"holds files outside of {prefix}")
        if legacy and prefix not in names:
            problems.append(f"has no entry of {prefix} itself, by which Blender 3.4 upgrades")
        modules = {n.removeprefix(prefix) for n in names if n.endswith(".so")}
        if modules != MODULES:
            problems.append(f"has the modules {sorted(modules)}, not {sorted(MODULES)}")
        for name in ("LICENSE", "THIRD-PARTY.txt", "bom.cdx.json", "__init__.py"):
            if prefix + name not in names:
                problems.append(f"has no {name}")
        if (prefix + MANIFEST in names) == legacy:
            problems.append(f"has {'a' if legacy else 'no'} {MANIFEST}")
        if not problems:
            problems += _notices(archive, prefix)
        for name in sorted(modules):
            debug = _symbols(path, name)
            if debug is None:
                problems.append(f"has no symbols of {name} beside it")
            found = _module_problems(archive.read(prefix + name), debug)
            problems += [f"{name} {problem}" for problem in found]
    return problems


def _symbols(path: Path, module: str) -> bytes | None:
    """What was stripped off a module of that zip."""
    beside = path.with_name(f"{path.stem.removesuffix('-legacy')}-symbols.zip")
    try:
        with zipfile.ZipFile(beside) as archive:
            return archive.read(f"{module}.debug")
    except (FileNotFoundError, KeyError):
        return None


@cache  # both zips have the same modules
def _module_problems(module: bytes, symbols: bytes | None) -> list[str]:
    with tempfile.TemporaryDirectory() as folder:
        path, debug = Path(folder, "module.so"), Path(folder, "module.so.debug")
        path.write_bytes(module)
        if symbols is None:
            return broken_rules(path)
        debug.write_bytes(symbols)
        problems = broken_rules(path, debug)
        if build_id(debug) != build_id(path):
            problems.append("is not what the symbols beside it are of, by the build id")
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
        hashes = [len(entry["content"]) for entry in component["hashes"]]
        if hashes != [64] or not component["licenses"]:
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
