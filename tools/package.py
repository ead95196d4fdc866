# SPDX-License-Identifier: GPL-3.0-or-later
"""Put the add-on and its native module together: a folder for one's own Blender, or the two zips.

package.py folder ROOT MODULE FOLDER     FOLDER becomes the installed add-on
package.py zips ROOT MODULE DIST         DIST/granita-VERSION-legacy.zip (3.4 and later) and
                                         DIST/granita-VERSION.zip (extension, 4.2 and later)
"""

import shutil
import sys
import zipfile
from pathlib import Path

MANIFEST = "blender_manifest.toml"
# A fixed date makes equal trees give equal zips.
ZIP_DATE = (1980, 1, 1, 0, 0, 0)


def package_files(root: Path, module: Path) -> dict[str, Path]:
    """Path inside the add-on -> file, for everything that is installed."""
    addon = root / "addon"
    files = {
        path.relative_to(addon).as_posix(): path
        for path in sorted(addon.rglob("*"))
        if path.is_file() and "__pycache__" not in path.parts
    }
    return files | {module.name: module, "LICENSE": root / "LICENSE"}


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


def write_zip(files: dict[str, Path], target: Path, prefix: str) -> None:
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, source in sorted(files.items()):
            info = zipfile.ZipInfo(prefix + name, ZIP_DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            archive.writestr(info, source.read_bytes())
    print(target)


def write_zips(files: dict[str, Path], dist: Path, version: str) -> None:
    dist.mkdir(parents=True, exist_ok=True)
    # A legacy add-on lies in a folder of its module's name; an extension's files lie at the top,
    # and only there is the manifest read.
    legacy = {name: path for name, path in files.items() if name != MANIFEST}
    write_zip(legacy, dist / f"granita-{version}-legacy.zip", "granita/")
    write_zip(files, dist / f"granita-{version}.zip", "")


def main() -> None:
    if len(sys.argv) != 5 or sys.argv[1] not in ("folder", "zips"):
        sys.exit(__doc__)
    root, module, target = (Path(argument) for argument in sys.argv[2:])
    files = package_files(root, module)
    if sys.argv[1] == "folder":
        write_folder(files, target)
    else:
        write_zips(files, target, (root / "VERSION").read_text().strip())


main()
