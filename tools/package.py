# SPDX-License-Identifier: GPL-3.0-or-later
"""Put the add-on and its native modules together: a folder for one's own Blender, or the two zips.

package.py folder ROOT FOLDER FILE...         FOLDER becomes the installed add-on
package.py zips ROOT DIST PLATFORM FILE...    DIST/granita-VERSION-PLATFORM.zip (extension, 4.2 and
                                              later) and DIST/granita-VERSION-PLATFORM-legacy.zip
                                              (add-on, 3.4 and later)
package.py files ZIP FILE...                  a plain zip

FILE: the modules, and what else goes beside the add-on's own files.
"""

import shutil
import sys
import zipfile
from pathlib import Path

MANIFEST = "blender_manifest.toml"
# A fixed date makes equal trees give equal zips.
ZIP_DATE = (1980, 1, 1, 0, 0, 0)


def package_files(root: Path, others: list[Path]) -> dict[str, Path]:
    """Path inside the add-on -> file, for everything that is installed."""
    addon = root / "addon"
    files = {
        path.relative_to(addon).as_posix(): path
        for path in sorted(addon.rglob("*"))
        if path.is_file() and "__pycache__" not in path.parts
    }
    return files | {path.name: path for path in others} | {"LICENSE": root / "LICENSE"}


def write_folder(files: dict[str, Path], folder: Path) -> None:
    """Replace folder by the add-on; a link there (to a tree) is removed, not followed."""
    if folder.is_symlink():
        folder.unlink()
    elif folder.exists():
        if not (folder / "__init__.py").is_file():
            sys.exit(f"{folder} is not an add-on: not replaced")
        shutil.rmtree(folder)
    for name, source in files.items():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, target)


def _entry(name: str, mode: int) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name, ZIP_DATE)
    info.compress_type = zipfile.ZIP_DEFLATED
    info.create_system = 3  # Unix, wherever it is made
    info.external_attr = mode << 16
    return info


def write_zip(files: dict[str, Path], target: Path, prefix: str) -> None:
    """Whole or not at all: a zip that was interrupted has no name that anyone would install."""
    unfinished = target.with_name(target.name + ".unfinished")
    with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        if prefix:
            # By this entry Blender 3.4 knows which folder an upgrade replaces.  Without it the files are
            # written over the old ones, the loaded module among them, and Blender crashes.
            archive.writestr(_entry(prefix, 0o40755), b"")
        for name, source in sorted(files.items()):
            archive.writestr(_entry(prefix + name, 0o100644), source.read_bytes())
    unfinished.replace(target)
    print(target)


def write_zips(files: dict[str, Path], dist: Path, name: str) -> None:
    dist.mkdir(parents=True, exist_ok=True)
    # A legacy add-on lies in a folder of its module's name; an extension's files lie at the top,
    # and only there is the manifest read.
    legacy = {path: source for path, source in files.items() if path != MANIFEST}
    write_zip(files, dist / f"{name}.zip", "")
    write_zip(legacy, dist / f"{name}-legacy.zip", "granita/")


def main() -> None:
    arguments = sys.argv[1:]
    if arguments[:1] == ["folder"] and len(arguments) >= 4:
        root, folder, *others = map(Path, arguments[1:])
        write_folder(package_files(root, others), folder)
    elif arguments[:1] == ["zips"] and len(arguments) >= 5:
        root, dist, platform, *others = map(Path, arguments[1:])
        version = (root / "VERSION").read_text().strip()
        write_zips(package_files(root, others), dist, f"granita-{version}-{platform}")
    elif arguments[:1] == ["files"] and len(arguments) >= 3:
        target, *others = map(Path, arguments[1:])
        write_zip({path.name: path for path in others}, target, "")
    else:
        sys.exit(__doc__)


main()
