# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the native module cannot run: the add-on registers, draws and says why; and what it says
where it can."""

import os

import bpy
import pytest
import scene_parts

from granita import bridge, host, preferences, system_report


@pytest.fixture
def windows(monkeypatch):
    monkeypatch.setattr(host, "this_host", lambda: host.Host("Windows", "AMD64", ""))
    system_report.native_lines.cache_clear()
    yield
    system_report.native_lines.cache_clear()


def test_it_registers_and_says_why(windows):
    import granita

    granita.unregister()
    granita.register()
    assert "this is Windows" in bridge.problem()


def test_a_render_ends_with_the_reason(windows, scene, tmp_path):
    scene_parts.add_camera(scene)
    scene.render.filepath = str(tmp_path / "frame.png")
    with pytest.raises(RuntimeError, match="this is Windows"):
        bpy.ops.render.render(write_still=True)
    assert not list(tmp_path.iterdir())


def test_the_report_is_made_all_the_same(windows):
    text = system_report.text("Blender 9")
    assert "native module missing: Granita renders on Linux alone" in text
    assert "Blender: Blender 9\n" in text


@pytest.mark.smoke
def test_the_report_names_versions_processor_and_opengl():
    lines = dict(line.split(": ", 1) for line in system_report.text("Blender 9").splitlines())
    assert set(lines) == {
        *("Granita", "Compiler", "Libraries", "Vector units", "OpenGL"),
        *("Blender", "System", "Processor", "Python"),
    }
    for library in ("Embree", "OpenImageIO", "OpenSubdiv", "oneTBB"):
        assert f"{library} " in lines["Libraries"]
    assert "SSE4" in lines["Vector units"]
    assert all(lines.values())


class Layout:
    """Stands for Blender's: keeps the texts that are drawn."""

    def __init__(self, texts):
        self.texts = texts
        self.alert = False

    def label(self, text="", icon=None):
        self.texts.append(text)

    def operator(self, name, icon=None):
        self.texts.append(name)

    def split(self, **_):
        return self

    column = row = box = split


@pytest.mark.parametrize("unfit", [False, True])
def test_preferences_show_what_is_there(unfit, request):
    if unfit:
        request.getfixturevalue("windows")
    texts = []
    drawn = type("Drawn", (), {"layout": Layout(texts)})
    preferences.GranitaPreferences.draw(drawn, None)
    shown = " ".join(texts)
    assert ("this is Windows" in shown) == unfit
    assert ("Vector units" in shown and "OpenGL" in shown) != unfit
    assert "granita.copy_system_report" in texts and "granita.open_log" in texts


def test_the_log_opens(monkeypatch, tmp_path, scene):
    """By the desktop's own program, for which a script stands that keeps what it is given."""
    opener, opened = tmp_path / "xdg-open", tmp_path / "opened.txt"
    opener.write_text(f'#!/bin/sh\ncp "$1" {opened}\n')
    opener.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    scene.render.filepath = str(tmp_path / "frame.png")
    scene_parts.add_camera(scene)
    scene.camera.data.type = "PANO"
    with pytest.raises(RuntimeError, match="camera"):
        bpy.ops.render.render(write_still=True)
    assert bpy.ops.granita.open_log() == {"FINISHED"}
    text = opened.read_text()
    assert "OpenGL: " in text
    assert f"frame {scene.frame_current}: error: camera" in text
