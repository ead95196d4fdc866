# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules as they are delivered: stripped, what was taken off beside them.

modules.py BUILD FOLDER    BUILD/native/python/granita_core.*.so -> FOLDER/granita_core.*.so and
                           FOLDER/granita_core.*.so.debug, which addr2line and gdb find by the build id
"""

import subprocess
import sys
from pathlib import Path


def deliver(module: Path, folder: Path) -> None:
    target = folder / module.name
    symbols = folder / f"{module.name}.debug"
    for command in (
        ["objcopy", "--only-keep-debug", module, symbols],
        ["strip", "--strip-all", "--remove-section=.comment", "-o", target, module],
    ):
        subprocess.run([str(word) for word in command], check=True)


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    build, folder = Path(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for left in folder.iterdir():
        left.unlink()
    modules = sorted((build / "native/python").glob("granita_core.*.so"))
    if not modules:
        sys.exit(f"no module in {build}")
    for module in modules:
        deliver(module, folder)


if __name__ == "__main__":
    main()
