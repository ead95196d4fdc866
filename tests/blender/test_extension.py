# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own validator of extensions takes the zip that users download."""

import subprocess
import sys
from pathlib import Path

import bpy
import pytest

ROOT = Path(__file__).resolve().parents[2]


def validator():
    """The program that Blender checks extensions with, or None: Blender has extensions from 4.2 on."""
    core = Path(bpy.utils.resource_path("LOCAL")) / "scripts" / "addons_core"
    found = core / "bl_pkg" / "cli" / "blender_ext.py"
    return found if found.exists() else None


@pytest.mark.smoke
@pytest.mark.skipif(bpy.app.version < (4, 2, 0), reason="Blender has no extensions before 4.2")
def test_blender_accepts_the_extension(tmp_path):
    import granita_core

    package = [ROOT / "tools" / "package.py", "zips", ROOT, tmp_path, "here", granita_core.__file__]
    subprocess.run([sys.executable, *map(str, package)], check=True)
    (archive,) = (path for path in tmp_path.iterdir() if "legacy" not in path.name)
    done = subprocess.run(
        [sys.executable, str(validator()), "validate", str(archive)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "error" not in (done.stdout + done.stderr).lower()
