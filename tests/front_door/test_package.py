# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user downloads: the module's exports, the installed folder, the two zips."""

import ast
import importlib.util
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
VERSION = (ROOT / "VERSION").read_text().strip()


@pytest.fixture(scope="module")
def module() -> Path:
    return Path(importlib.util.find_spec("granita_core").origin)


def package(*arguments: object) -> None:
    script = ROOT / "tools" / "package.py"
    subprocess.run([sys.executable, str(script), *map(str, arguments)], check=True)


@pytest.fixture(scope="module")
def zips(module, tmp_path_factory) -> dict[str, list[str]]:
    dist = tmp_path_factory.mktemp("dist")
    package("zips", ROOT, dist, "here", module)
    names = {}
    for path in dist.iterdir():
        with zipfile.ZipFile(path) as archive:
            names[path.name] = archive.namelist()
    return names


def test_the_module_exports_nothing_but_its_entry(module):
    """Blender's own copies of the same libraries share the process with ours."""
    listing = subprocess.run(
        ["nm", "-D", "--defined-only", str(module)], check=True, capture_output=True, text=True
    )
    symbols = [line.split()[-1] for line in listing.stdout.splitlines()]
    assert symbols == ["PyInit_granita_core"]


def test_the_legacy_zip_is_a_folder_with_the_module(zips, module):
    names = zips[f"granita-{VERSION}-here-legacy.zip"]
    assert all(name.startswith("granita/") for name in names)
    assert names[0] == "granita/"  # Blender 3.4 replaces what has an entry of its own
    assert {"granita/__init__.py", f"granita/{module.name}", "granita/LICENSE"} <= set(names)
    assert not [name for name in names if "__pycache__" in name or "manifest" in name]


def test_the_extension_zip_has_its_manifest_at_the_top(zips, module):
    names = zips[f"granita-{VERSION}-here.zip"]
    assert {"blender_manifest.toml", "__init__.py", module.name, "LICENSE"} <= set(names)


def test_both_zips_bring_the_presets(zips):
    for zip_name, prefix in (
        (f"granita-{VERSION}-here-legacy.zip", "granita/"),
        (f"granita-{VERSION}-here.zip", ""),
    ):
        presets = {prefix + f"presets/{name}.py" for name in ("Preview", "Final")}
        assert presets <= set(zips[zip_name])


def test_the_version_is_the_same_everywhere():
    manifest = tomllib.loads((ROOT / "addon/blender_manifest.toml").read_text())
    assert manifest["version"] == VERSION
    tree = ast.parse((ROOT / "addon/__init__.py").read_text())
    info = next(
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info"
    )
    assert ".".join(map(str, info["version"])) == VERSION


def test_installing_replaces_an_older_add_on_whole(module, tmp_path):
    folder = tmp_path / "addons" / "granita"
    folder.mkdir(parents=True)
    (folder / "__init__.py").write_text("")
    (folder / "left_over.py").write_text("")
    package("folder", ROOT, folder, module)
    assert (folder / "engine.py").is_file()
    assert (folder / module.name).is_file()
    assert not (folder / "left_over.py").exists()


def test_installing_does_not_empty_a_folder_that_is_no_add_on(module, tmp_path):
    (tmp_path / "thesis.txt").write_text("")
    with pytest.raises(subprocess.CalledProcessError):
        package("folder", ROOT, tmp_path, module)
    assert (tmp_path / "thesis.txt").exists()
