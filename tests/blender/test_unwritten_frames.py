# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that cannot be written: exit code 1, path and reason for people and machines, no half file.

Folders that nobody can write into stand for a farm's, and failing_disk.c for disks that fail late.
"""

import errno
import json
import os
import shutil
import subprocess

import bpy
import pytest
import render_host
import window_host

MACHINES = ("--granita-log", "json")
TO = "import bpy; bpy.context.scene.render.filepath = {!r}"
FORMAT = """
import bpy
image = bpy.context.scene.render.image_settings
if hasattr(image, "media_type"):
    image.media_type = "IMAGE"
image.file_format = {!r}
"""
# For the command alone: nobody else sees it.
READ_ONLY = 'mount --bind "$0" "$0" && mount -o remount,ro,bind "$0" && exec "$@"'
ONE_BY_F = pytest.param(
    True, marks=pytest.mark.skipif(not bpy.app.binary_path, reason="a module has no command line")
)


def told(outcome):
    """What machines read: objects, one a line."""
    return [json.loads(line) for line in outcome.output.splitlines() if line.startswith("{")]


def only_error(outcome):
    """In a module the frame after the lost one fails, by the same words."""
    (error,) = {event["text"] for event in told(outcome) if event["event"] == "error"}
    lines = [line for line in outcome.output.splitlines() if line.startswith("Error: ")]
    assert any(line.endswith(error) for line in lines)
    return error


def earlier(path):
    """A frame of another render, of long ago."""
    path.parent.mkdir()
    path.write_bytes(b"earlier")
    os.utime(path, (0, 0))
    return path


def succeeds(*words):
    """Whether this machine has such a program, and it does what it is asked for."""
    return shutil.which(words[0]) and subprocess.run(words, check=False).returncode == 0


def assert_is_told(outcome, path, reason):
    assert outcome.code == 1, outcome.output
    text = f"'{path}' could not be written: {os.strerror(reason)}"
    assert f"Error: Granita: {text}" in outcome.output.splitlines()
    errors = [event for event in told(outcome) if event["event"] == "error"]
    assert [(event["frame"], event["text"]) for event in errors] == [(1, text)]


@pytest.mark.parametrize(
    "kind, ending, below, alone",
    [
        ("PNG", "png", "", False),
        ("OPEN_EXR", "exr", "folder/", False),
        pytest.param("OPEN_EXR", "exr", "", *ONE_BY_F.values, marks=ONE_BY_F.marks),
        pytest.param("JPEG", "jpg", "folder/", *ONE_BY_F.values, marks=ONE_BY_F.marks),
    ],
)
def test_a_folder_that_is_a_file_ends_with_exit_code_1(blend, tmp_path, kind, ending, below, alone):
    (tmp_path / "file").write_text("not a folder")
    prepare = FORMAT.format(kind) + TO.format(f"{tmp_path}/file/{below}frame_####")
    out = tmp_path / "out"
    outcome = render_host.run(blend, out, prepare, last=2, options=MACHINES, alone=alone)
    assert_is_told(outcome, f"{tmp_path}/file/{below}frame_0001.{ending}", errno.ENOTDIR)
    assert outcome.files == [] and "frame_0002" not in outcome.output
    assert (tmp_path / "file").read_text() == "not a folder"


@pytest.mark.parametrize("alone", [ONE_BY_F, False])
def test_a_folder_that_cannot_be_made_ends_with_exit_code_1(blend, tmp_path, alone):
    prepare = TO.format("/proc/frames/frame_####")
    outcome = render_host.run(blend, tmp_path / "out", prepare, options=MACHINES, alone=alone)
    assert_is_told(outcome, "/proc/frames/frame_0001.exr", errno.ENOENT)


@pytest.mark.parametrize("alone", [ONE_BY_F, False])
@pytest.mark.parametrize("below", ["", "folder/"])
def test_a_read_only_folder_ends_with_exit_code_1(blend, tmp_path, alone, below):
    out = tmp_path / "out"
    earlier(out / "frame_0001.exr")
    prefix = ("unshare", "--mount", "--map-root-user", "sh", "-c", READ_ONLY, str(out))
    if not succeeds(*prefix, "true"):
        pytest.skip("folders cannot be made read-only here")
    prepare = TO.format(f"{out}/{below}frame_####")
    outcome = render_host.run(blend, out, prepare, options=MACHINES, alone=alone, prefix=prefix)
    assert_is_told(outcome, f"{out}/{below}frame_0001.exr", errno.EROFS)
    assert [path.read_bytes() for path in outcome.files] == [b"earlier"]


@pytest.fixture
def immutable(tmp_path):
    """An earlier frame, until the test's end."""
    final = earlier(tmp_path / "out" / "frame_0001.exr")
    is_made = succeeds("chattr", "+i", str(final))
    try:
        if not is_made:
            pytest.skip("files cannot be made immutable here")
        yield final
    finally:
        assert not is_made or succeeds("chattr", "-i", str(final))


def test_a_file_that_cannot_be_replaced_ends_with_exit_code_1(blend, immutable):
    final = immutable
    outcome = render_host.run(blend, final.parent, last=2, options=MACHINES)
    assert outcome.code == 1, outcome.output
    left, stays = outcome.files
    error = f"'{final}' could not be written: {os.strerror(errno.EPERM)}; the frame is in '{left}'"
    assert only_error(outcome) == error
    assert stays.read_bytes() == b"earlier"


def test_an_engine_that_gave_up_is_told_once(blend, tmp_path):
    """No file was begun, though none could have been."""
    (tmp_path / "file").write_text("")
    prepare = (
        TO.format(f"{tmp_path}/file/frame_####") + "; bpy.context.scene.camera.data.type = 'PANO'"
    )
    outcome = render_host.run(blend, tmp_path / "out", prepare, options=MACHINES)
    assert outcome.code == 1, outcome.output
    (error,) = [event["text"] for event in told(outcome) if event["event"] == "error"]
    assert "camera" in error and "could not be written" not in outcome.output


def test_an_option_that_is_wrong_is_told_to_machines_too(blend, tmp_path):
    options = ("--granita-devcie", "cpu", *MACHINES)
    outcome = render_host.run(blend, tmp_path / "out", options=options)
    (error,) = [event for event in told(outcome) if event["event"] == "error"]
    assert outcome.code == 1 and "--granita-devcie" in error["text"]


def test_a_script_that_saves_a_still_gets_an_exception(blend, tmp_path):
    """And goes on, with another path."""
    (tmp_path / "file").write_text("")
    prepare = TO.format(f"{tmp_path}/file/still") + (
        "\ntry:\n    bpy.ops.render.render(write_still=True)\nexcept RuntimeError:\n"
        f"    {TO.format(f'{tmp_path}/out/frame_####')}"
    )
    outcome = render_host.run(blend, tmp_path / "out", prepare)
    assert outcome.code == 0, outcome.output
    assert [path.name for path in outcome.files] == ["frame_0001.exr"]


@pytest.mark.parametrize("layers", [1, 2])
def test_progress_for_machines_grows_to_the_end(blend, tmp_path, layers):
    prepare = "import bpy; s = bpy.context.scene; s.granita.samples = 256"
    prepare += "; s.view_layers.new('Second')" if layers == 2 else ""
    outcome = render_host.run(blend, tmp_path / "out", prepare, options=MACHINES)
    assert outcome.code == 0, outcome.output
    fractions = [event["fraction"] for event in told(outcome) if event["event"] == "progress"]
    assert fractions == sorted(fractions) and fractions[0] == 0.0
    assert set(fractions) >= {layer / layers for layer in range(1, layers + 1)}
    done = [event["view_layer"] for event in told(outcome) if event["event"] == "layer"]
    assert done == ["ViewLayer", "Second"][:layers]


# One of two layers, by the operator's own word: the scene says nothing of it.
ONE_LAYER = """
import bpy

bpy.context.scene.view_layers.new("Second")

def render():
    bpy.ops.render.render(layer="Second")
    bpy.ops.wm.quit_blender()

bpy.app.timers.register(render, first_interval=0.5)
"""


@window_host.needed
def test_progress_of_one_layer_alone_begins_at_0(blend, tmp_path):
    script = tmp_path / "script.py"
    script.write_text(ONE_LAYER)
    _, output = window_host.run(script, *MACHINES, blend=blend)
    outcome = render_host.Outcome(0, output, [])
    fractions = [event["fraction"] for event in told(outcome) if event["event"] == "progress"]
    assert fractions[0] == 0.0 and fractions[-1] == 1.0
    assert [e["view_layer"] for e in told(outcome) if e["event"] == "layer"] == ["Second"]


@pytest.fixture(scope="session")
def failing_disk(tmp_path_factory):
    """failing_disk(call, error) -> variables for Blender; and their log."""
    if not (compiler := shutil.which("cc") or shutil.which("gcc")):
        pytest.skip("no compiler of C")
    folder = tmp_path_factory.mktemp("disk")
    library = folder / "failing_disk.so"
    source = render_host.HERE / "failing_disk.c"
    subprocess.run([compiler, "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)

    def failing(call, error=0, name="_0001.", log="/dev/null"):
        return {
            "LD_PRELOAD": str(library),
            "FAILING_CALL": call,
            "FAILING_ERROR": str(error),
            "FAILING_NAME": name,
            "FAILING_LOG": str(log),
        }

    return failing


@pytest.mark.parametrize("error", [errno.ENOSPC, errno.EDQUOT, errno.EIO])
@pytest.mark.parametrize("call", ["open", "close", "fsync"])
def test_a_disk_that_fails_at(blend, tmp_path, failing_disk, call, error):
    """The first of two frames; the second is not tried."""
    out = tmp_path / "out"
    env = failing_disk(call, error)
    outcome = render_host.run(blend, out, last=2, options=MACHINES, env=env)
    assert outcome.code == 1, outcome.output
    assert outcome.files == []
    assert f"'{out}/frame_0001.exr'" in only_error(outcome)
    # Blender drops what its closing was told.
    reason = "the disk may be full" if call == "close" else os.strerror(error)
    assert only_error(outcome).endswith(reason)
    assert "frame_0002" not in outcome.output


def test_a_frame_that_was_not_flushed_leaves_the_earlier_file(blend, tmp_path, failing_disk):
    out = tmp_path / "out"
    earlier(out / "frame_0001.exr")
    env = failing_disk("fsync", errno.EIO)
    outcome = render_host.run(blend, out, last=2, options=MACHINES, env=env)
    assert outcome.code == 1, outcome.output
    assert [path.read_bytes() for path in outcome.files] == [b"earlier"]
    assert "the one that was there before is left" in only_error(outcome)


def test_a_frame_is_on_the_disk_before_it_has_its_name(blend, tmp_path, failing_disk):
    log = tmp_path / "log"
    outcome = render_host.run(blend, tmp_path / "out", env=failing_disk("none", log=log))
    assert outcome.code == 0, outcome.output
    frame = [line for line in log.read_text().splitlines() if "frame_0001.exr" in line]
    flushed, renamed = (line.split(" ", 1) for line in frame)
    assert flushed[0] == "flushed" and "/.unfinished-" in flushed[1]
    assert renamed == ["renamed", f"{tmp_path}/out/frame_0001.exr"]


@pytest.mark.parametrize("error", [errno.ENOSPC, errno.EDQUOT, errno.EIO])
def test_a_part_that_was_not_flushed_is_not_there(blend, tmp_path, failing_disk, error):
    parts = tmp_path / "parts"
    options = (*MACHINES, "--granita-part", "1/2", "--granita-parts", str(parts))
    env = failing_disk("fsync", error, name=".part.")
    outcome = render_host.run(blend, tmp_path / "out", options=options, env=env)
    assert outcome.code == 1, outcome.output
    assert "part file" in only_error(outcome) and os.strerror(error) in only_error(outcome)
    assert outcome.files == [] and list(parts.iterdir()) == []


# Renders an animation to where nothing can be written, then looks whether the window still answers.
IN_A_WINDOW = """
import sys
import bpy

scene = bpy.context.scene
scene.render.filepath = sys.argv[-1]
ended = []
bpy.app.handlers.render_cancel.append(lambda *_: ended.append(True))

def render():
    bpy.ops.render.render("INVOKE_DEFAULT", animation=True)

def look():
    if not ended:
        return 0.1
    print("answers still:", scene.render.filepath, flush=True)
    bpy.ops.wm.quit_blender()

bpy.app.timers.register(render, first_interval=0.5)
bpy.app.timers.register(look, first_interval=1.0)
"""


@window_host.needed
def test_a_window_survives_a_folder_that_cannot_be_written(blend, tmp_path):
    (tmp_path / "file").write_text("")
    script = tmp_path / "script.py"
    script.write_text(IN_A_WINDOW)
    path = f"{tmp_path}/file/frame_####"
    _, output = window_host.run(script, path, blend=blend)  # its code is that of the last render
    assert f"answers still: {path}" in output and "Blender quit" in output
    assert "Error: Granita" not in output  # Blender's own report is in the window
