# SPDX-License-Identifier: GPL-3.0-or-later
"""`dev` as a user meets it: exit codes, messages, what it leaves alone."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def dev(*arguments: str, **environment: str) -> subprocess.CompletedProcess:
    """Run ./dev with no input and no terminal."""
    return subprocess.run(
        [str(ROOT / "dev"), *arguments],
        env=os.environ | environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=600,
    )


def test_an_unknown_command_fails_and_shows_what_there_is():
    done = dev("rendr")
    assert done.returncode != 0
    assert "rendr" in done.stderr
    assert "./dev demo" in done.stderr


@pytest.mark.parametrize("command", ["demo", "test", "build", "bench", "lint", "package"])
def test_another_system_gets_one_message_with_what_is_needed(command, tmp_path):
    release = tmp_path / "os-release"
    release.write_text('ID=ubuntu\nVERSION_ID="24.04"\n')
    done = dev(command, GRANITA_OS_RELEASE=str(release), GRANITA_SKIP_INSTALL="")
    assert done.returncode != 0
    assert done.stderr.count("Debian 12") >= 1
    for package in ("libosd-dev", "libopenimageio-dev", "blender", "GRANITA_SKIP_INSTALL"):
        assert package in done.stderr


def test_a_sanitizer_that_does_not_exist_is_named():
    done = dev("test", "--sanitize", "memory")
    assert done.returncode != 0
    assert "memory" in done.stderr and "thread" in done.stderr


def test_a_second_build_installs_and_compiles_nothing():
    assert dev("build").returncode == 0
    done = dev("build")
    assert done.returncode == 0, done.stderr
    assert "no work to do" in done.stderr
    assert "Installing" not in done.stderr


def test_blender_has_the_addon_and_the_exit_code_comes_through():
    script = "import sys, addon_utils; sys.exit(40 + addon_utils.check('granita')[1])"
    done = dev("blender", "-b", "--factory-startup", "--python-expr", script)
    assert done.returncode == 41, done.stdout + done.stderr


def test_blender_leaves_the_users_configuration_untouched(tmp_path):
    script = "import bpy; bpy.ops.wm.save_userpref()"
    cache = os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))
    home = {"HOME": str(tmp_path), "XDG_CACHE_HOME": cache, "XDG_CONFIG_HOME": ""}
    done = dev("blender", "-b", "--python-expr", script, **home)
    assert done.returncode == 0, done.stdout + done.stderr
    assert not (tmp_path / ".config" / "blender").exists()


@pytest.mark.parametrize("cache", [True, False])
def test_no_home_is_no_obstacle(cache):
    """As systemd and some farms start a process."""
    given = {k: v for k, v in os.environ.items() if k not in ("HOME", "XDG_CACHE_HOME")}
    if cache:
        given["XDG_CACHE_HOME"] = os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))
    done = subprocess.run(
        [str(ROOT / "dev"), "help"], env=given, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr


def test_a_failing_part_makes_the_test_run_fail(tmp_path):
    """The functions of dev with a part that fails in its middle, not at its end."""
    script = (ROOT / "dev").read_text().replace('main "$@"\n', "")
    script += "half() { false; true; }\npart good true\npart bad half\nexit $FAILED\n"
    copy = tmp_path / "dev"
    copy.write_text(script)
    (tmp_path / "tools").symlink_to(ROOT / "tools")  # which dev reads a part of itself from
    done = subprocess.run(["bash", str(copy)], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1
