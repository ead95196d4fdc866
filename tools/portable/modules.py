# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules as they are delivered: stripped, what was taken off beside them.

modules.py BUILD FOLDER    BUILD/native/python/granita_core.*.so -> FOLDER/granita_core.*.so and
                           FOLDER/granita_core.*.so.debug, which addr2line and gdb find by the build id

The linker's own build id would be of the lines of debugging too, and these name the folders of this machine; ours is of what is
delivered.
"""

import hashlib
import subprocess
import sys
from pathlib import Path

# Of an ELF file: lengths of name and id, the kind, the name.
_NOTE = (
    (4).to_bytes(4, "little") + (20).to_bytes(4, "little") + (3).to_bytes(4, "little") + b"GNU\0"
)


def deliver(module: Path, folder: Path) -> None:
    target = folder / module.name
    symbols = folder / f"{module.name}.debug"
    for command in (
        ["objcopy", "--only-keep-debug", module, symbols],
        ["strip", "--strip-all", "--remove-section=.comment", "-o", target, module],
    ):
        subprocess.run([str(word) for word in command], check=True)
    build_id = hashlib.sha1(target.read_bytes(), usedforsecurity=False).digest()
    for file in (target, symbols):
        write_build_id(file, build_id)


def write_build_id(file: Path, build_id: bytes) -> None:
    """In place of the zeros that the linker was given."""
    with file.open("r+b") as opened:
        found = opened.read(64 * 1024).find(_NOTE + bytes(len(build_id)))
        if found < 0:
            sys.exit(f"{file} has no build id to write")
        opened.seek(found + len(_NOTE))
        opened.write(build_id)


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
