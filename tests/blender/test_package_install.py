# SPDX-License-Identifier: GPL-3.0-or-later
"""A zip by Blender's own operators in an empty configuration: install, enable, render, upgrade to other
bytes while it is loaded, disable, remove.  GRANITA_ZIP names the extension's zip; without it, zips are made of the tree."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import bpy
import pytest

ROOT = Path(__file__).resolve().parents[2]
# Prints "ok" last; an operator that is refused raises.
LIFE = """
import sys
from pathlib import Path
import bpy

archive, newer, picture = {archive!r}, {newer!r}, {picture!r}
extension = bpy.app.version >= (4, 2, 0)
module = "bl_ext.user_default.granita" if extension else "granita"

def install(file):
    if extension:
        bpy.ops.extensions.package_install_files(
            filepath=file, repo="user_default", enable_on_install=True, overwrite=True)
    else:
        bpy.ops.preferences.addon_install(filepath=file, overwrite=True)
        bpy.ops.preferences.addon_enable(module=module)

def render(name):
    scene = bpy.context.scene
    scene.render.engine = "GRANITA"
    scene.render.resolution_x = scene.render.resolution_y = 32
    scene.granita.samples = 4
    scene.render.filepath = picture + name + ".png"
    bpy.ops.render.render(write_still=True)
    assert Path(scene.render.filepath).stat().st_size > 0
    scene.render.engine = "BLENDER_WORKBENCH"

def modules():
    return {{p.name: p.read_bytes()[-len({mark!r}):] for p in folder.glob("granita_core*")}}

install(archive)
folder = Path(sys.modules[module].__file__).parent
print("folder", folder)
assert sys.modules[module + ".bridge"].problem() == "", sys.modules[module + ".bridge"].problem()
render("first")
installed = modules()
assert installed
install(newer)  # in place, while the native module is loaded
assert {{name: {mark!r} for name in installed}} == modules()
render("second")
bpy.ops.preferences.addon_disable(module=module)
assert not hasattr(bpy.types.Scene, "granita")
engines = [c for c in bpy.types.RenderEngine.__subclasses__() if c.is_registered]
assert "GRANITA" not in [getattr(c, "bl_idname", "") for c in engines]
if extension:
    repos = bpy.context.preferences.extensions.repos
    index = [repo.module for repo in repos].index("user_default")
    bpy.ops.extensions.package_uninstall(repo_index=index, pkg_id="granita")
else:
    try:
        bpy.ops.preferences.addon_remove(module=module)
    except RuntimeError as error:  # 3.4 wants to draw its window then, also where it has none
        assert "tag_redraw" in str(error)
assert not folder.exists(), sorted(folder.iterdir())
print("ok", flush=True)
"""


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    extension = os.environ.get("GRANITA_ZIP")
    if not extension:
        import granita_core

        dist = tmp_path_factory.mktemp("dist")
        package = [ROOT / "tools/package.py", "zips", ROOT, dist, "here", granita_core.__file__]
        subprocess.run([sys.executable, *map(str, package)], check=True)
        (extension,) = (str(p) for p in dist.iterdir() if "legacy" not in p.name)
    if bpy.app.version >= (4, 2, 0):
        return extension
    return extension.replace(".zip", "-legacy.zip")


# Of an ELF file: lengths of name and id, the kind, the name; 20 bytes of id follow.
BUILD_ID = b"\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0"
MARK = b"of another build"


def newer(archive, folder):
    """The same package with modules of other bytes: another build id, and more of them."""
    target = folder / Path(archive).name
    with zipfile.ZipFile(archive) as old, zipfile.ZipFile(target, "w") as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename.endswith(".so"):
                note = content.index(BUILD_ID) + len(BUILD_ID)
                content = content[:note] + MARK + content[note + len(MARK) :] + MARK
            new.writestr(entry, content, compresslevel=1)
    return str(target)


def test_the_life_of_an_installed_add_on(archive, tmp_path, tmp_path_factory):
    code = LIFE.format(
        archive=archive,
        newer=newer(archive, tmp_path_factory.mktemp("newer")),
        picture=str(tmp_path / "picture_"),
        mark=MARK,
    )
    if bpy.app.binary_path:
        words = [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1"]
        words += ["--python-expr", code]
    else:
        words = [sys.executable, "-c", code + "\nimport os\nos._exit(0)"]
    places = ("SCRIPTS", "CONFIG", "EXTENSIONS", "DATAFILES")
    for place in places:
        (tmp_path / place).mkdir()
    variables = {f"BLENDER_USER_{place}": str(tmp_path / place) for place in places}
    variables |= {"BLENDER_USER_RESOURCES": str(tmp_path), "PYTHONPATH": "", "HOME": str(tmp_path)}
    done = subprocess.run(
        words,
        env=os.environ | variables,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "\nok" in done.stdout, done.stdout + done.stderr
    left = [p for p in tmp_path.rglob("*") if "granita" in p.name.lower() and p.is_file()]
    assert not left


# Blender's own installer on another machine.
ELSEWHERE = """
import platform, runpy, sys
platform.system, platform.machine = (lambda name=name: name for name in sys.argv[1:3])
del sys.argv[:3]
runpy.run_path(sys.argv[0], run_name="__main__")
"""


@pytest.mark.skipif(bpy.app.version < (4, 2, 0), reason="has no extensions")
@pytest.mark.parametrize(
    "system, machine, refused",
    [
        ("Linux", "x86_64", ""),
        ("Linux", "aarch64", "linux-arm64"),
        ("Windows", "AMD64", "windows-x64"),
        ("Darwin", "arm64", "macos-arm64"),
    ],
)
def test_blender_refuses_the_extension_on_other_systems(
    archive, tmp_path, system, machine, refused
):
    scripts = Path(bpy.utils.system_resource("SCRIPTS"))
    program = scripts / "addons_core/bl_pkg/cli/blender_ext.py"
    versions = {"blender": bpy.app.version, "python": sys.version_info[:3]}
    options = [
        f"--{name}-version={'.'.join(map(str, version))}"
        for name, version in versions.items()
        if f"--{name}-version" in program.read_text()
    ]
    words = [sys.executable, "-c", ELSEWHERE, system, machine, program, "install-files"]
    words += [*options, f"--local-dir={tmp_path}", archive]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    assert (tmp_path / "granita").exists() != bool(refused), done.stdout + done.stderr
    assert f"This platform ({refused}) isn't one of (linux-x64)" in done.stdout or not refused
