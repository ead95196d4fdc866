# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the native module cannot run: the add-on registers, draws and says why; and what it says
where it can."""

import os
from types import SimpleNamespace

import bpy
import pytest
import scene_parts

import granita
from granita import bridge, host, preferences, system_report
from granita.ui import render_panels

OLD = host.Host(processor="Core 2", instructions=host.INSTRUCTIONS - {"sse4_2", "popcnt"})
# What stands for the machine, and what is said of it.
UNFIT = {
    "Windows": (host.Host("Windows", "AMD64", ""), "this is Windows"),
    "macOS": (host.Host("Darwin", "arm64", ""), "this is Darwin"),
    "ARM": (host.Host(machine="aarch64"), "this one is aarch64"),
    "musl": (host.Host(libc=""), "the GNU C library (glibc); this one has another"),
    "old glibc": (host.Host(libc="glibc 2.17"), "this system has 2.17"),
    "old processor": (OLD, "Core 2 has no popcnt, sse4_2"),
    "foreign Python": (host.Host(), "the native module is not for Python 3."),
}


@pytest.fixture(params=UNFIT)
def unfit(request, monkeypatch, tmp_path_factory):
    """What is said where the module cannot run."""
    machine, words = UNFIT[request.param]
    monkeypatch.setattr(host, "this_host", lambda: machine)
    if request.param == "foreign Python":
        # By a name of its own, for that of this Python is loaded.
        monkeypatch.setattr(bridge, "MODULE", "granita_core_of_another")
        folder = tmp_path_factory.mktemp("foreign")
        (folder / "granita_core_of_another.cpython-399-x86_64-linux-gnu.so").write_bytes(b"")
        monkeypatch.syspath_prepend(str(folder))
    system_report.native_lines.cache_clear()
    yield words
    system_report.native_lines.cache_clear()


def own_handlers():
    lists = (getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers))
    functions = [f for functions in lists if isinstance(functions, list) for f in functions]
    return [f for f in functions if f.__module__.partition(".")[0] == "granita"]


def test_it_registers_says_why_and_leaves_no_handler(unfit):
    granita.unregister()
    try:
        assert own_handlers() == []
        granita.register()
        assert own_handlers() and hasattr(bpy.types.Scene, "granita")
        assert unfit in bridge.problem()
        granita.unregister()
        assert own_handlers() == [] and not hasattr(bpy.types.Scene, "granita")
    finally:
        if not hasattr(bpy.types.Scene, "granita"):
            granita.register()


def test_a_render_ends_with_the_reason(unfit, scene, tmp_path):
    scene_parts.add_camera(scene)
    scene.render.filepath = str(tmp_path / "frame.png")
    with pytest.raises(RuntimeError) as failure:
        bpy.ops.render.render(write_still=True)
    assert unfit in str(failure.value)
    assert not list(tmp_path.iterdir())


def test_the_report_is_made_all_the_same(unfit):
    text = system_report.text("Blender 9")
    assert "Granita: native module missing: " in text and unfit in text
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

    def prop(self, owner, name):
        self.texts.append(name)

    def split(self, **_):
        return self

    column = row = box = split


def shown():
    """By the preferences and by the panel: what is drawn, a text each."""
    in_preferences, in_panel = [], []
    preferences.GranitaPreferences.draw(SimpleNamespace(layout=Layout(in_preferences)), bpy.context)
    panel = SimpleNamespace(column=lambda: Layout(in_panel))
    render_panels.GRANITA_RENDER_PT_device.draw(panel, bpy.context)
    assert "device" in in_panel
    assert "granita.copy_system_report" in in_preferences and "granita.open_log" in in_preferences
    return " ".join(in_preferences), " ".join(in_panel)


def test_preferences_and_panel_say_what_is_missing(unfit):
    for text in shown():
        assert unfit in text and "Vector units" not in text


def test_preferences_show_what_is_there():
    in_preferences, in_panel = shown()
    assert "Vector units" in in_preferences and "OpenGL" in in_preferences
    assert in_panel == "device"


def copied():
    """What the operator hands over: a clipboard there is with a window alone."""
    taken = SimpleNamespace(clipboard="", reported=[])
    operator = SimpleNamespace(report=lambda kind, text: taken.reported.append(kind))
    context = SimpleNamespace(window_manager=taken)
    assert preferences.CopySystemReport.execute(operator, context) == {"FINISHED"}
    assert taken.reported == [{"INFO"}]
    assert bpy.ops.granita.copy_system_report() == {"FINISHED"}
    return taken.clipboard


def test_the_report_is_copied():
    text = copied()
    assert f"\nBlender: {bpy.app.version_string}, " in text
    assert "\nVector units: " in text and "\nPython: " in text


def test_the_report_of_an_unfit_host_is_copied(unfit):
    assert unfit in copied()


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
