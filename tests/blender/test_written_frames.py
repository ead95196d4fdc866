# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a disk cut off: told apart from whole ones in every format and at every length, removed, exit code 1.

A limit on the size of files stands for the disk: writing fails in the same places.
"""

from pathlib import Path

import bpy
import numpy as np
import pytest
import render_host
import scene_parts

from granita import whole_file, written_frames

# (format, codec of OpenEXR, other settings): those whose end can be seen.
FORMATS = [
    ("PNG", None, {}),
    ("JPEG", None, {}),
    *(("OPEN_EXR", codec, {}) for codec in ("NONE", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "DWAA")),
    ("OPEN_EXR_MULTILAYER", "ZIP", {"use_exr_interleave": True}),
    ("OPEN_EXR_MULTILAYER", "ZIP", {"use_exr_interleave": False}),
]
# A signal ends the process where Blender writes, at the first byte beyond a thousand, as SIGKILL may.
KILLED = """
import resource, signal
import bpy
signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
bpy.context.scene.render.resolution_x = bpy.context.scene.render.resolution_y = 256
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))
"""
# What others see of the output path, and of the file, at each event.
WATCHED = """
import os
import bpy

def tell(event):
    def told(scene, *_):
        path = scene.render.frame_path()
        print("at", event, os.path.basename(path), os.path.exists(path))
    getattr(bpy.app.handlers, event).append(told)

for event in ("render_pre", "render_post", "render_write"):
    tell(event)
"""
LIMIT = """
import resource, signal
import bpy
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
render = bpy.context.scene.render
image = render.image_settings
if hasattr(image, "media_type"):
    image.media_type = "IMAGE"
image.file_format, codec = "{}", "{}"
if codec != "None":
    image.exr_codec = codec
render.resolution_x = render.resolution_y = 256
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))
"""


def set_format(image, kind, codec, others):
    if hasattr(image, "media_type"):
        image.media_type = "MULTI_LAYER_IMAGE" if "MULTI" in kind else "IMAGE"
    image.file_format = kind
    if codec:
        image.exr_codec = codec
    for name, value in others.items():
        if hasattr(image, name):
            setattr(image, name, value)


def happens(scene, *events):
    """As Blender says it."""
    for event in events:
        for handler in list(getattr(bpy.app.handlers, event)):
            handler(scene, None)


@pytest.mark.parametrize("kind, codec, others", FORMATS)
def test_a_cut_is_seen(scene, tmp_path, kind, codec, others):
    scene_parts.add_camera(scene, ortho_scale=4.0)
    scene_parts.add_square(scene, material=scene_parts.emission("Glow", (0.25, 0.5, 0.75)))
    set_format(scene.render.image_settings, kind, codec, others)
    path = tmp_path / "picture"
    scene.render.use_file_extension = False
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    whole = path.read_bytes()
    assert whole_file.is_whole(path)
    lengths = np.random.default_rng(3).integers(0, len(whole), 40)
    for length in {0, 1, 8, 9, len(whole) - 1, *map(int, lengths)}:
        path.write_bytes(whole[:length])
        assert not whole_file.is_whole(path), length


@pytest.mark.parametrize("kind, codec", [("OPEN_EXR", "NONE"), ("OPEN_EXR", "ZIP"), ("PNG", None)])
def test_a_full_disk_leaves_no_half_file(blend, tmp_path, kind, codec):
    """The first of two frames fails; the second is not tried."""
    outcome = render_host.run(blend, tmp_path / "out", LIMIT.format(kind, codec), last=2)
    assert outcome.code == 1, outcome.output
    assert outcome.files == []
    assert "frame_0001" in outcome.output and "frame_0002" not in outcome.output
    assert "removed" in outcome.output


def test_a_full_disk_leaves_the_earlier_file(blend, tmp_path):
    earlier = render_host.run(blend, tmp_path / "out").files[0].read_bytes()
    outcome = render_host.run(blend, tmp_path / "out", LIMIT.format("OPEN_EXR", "ZIP"), last=2)
    assert outcome.code == 1, outcome.output
    assert "the one that was there before is left" in outcome.output
    assert [path.read_bytes() for path in outcome.files] == [earlier]


def test_what_cannot_take_its_name_is_told(blend, tmp_path):
    (tmp_path / "out" / "frame_0001.exr" / "in the way").mkdir(parents=True)
    outcome = render_host.run(blend, tmp_path / "out", last=2)
    assert outcome.code == 1, outcome.output
    left, in_the_way = outcome.files
    assert left.name.startswith(".unfinished-") and whole_file.is_whole(left)
    assert in_the_way.is_dir() and "frame_0002" not in outcome.output
    error = next(line for line in outcome.output.splitlines() if line.startswith("Error:"))
    assert str(left) in error and str(in_the_way) in error


def test_previews_lie_beside_their_frames(blend, tmp_path):
    preview = "import bpy; bpy.context.scene.render.image_settings.use_preview = True"
    outcome = render_host.run(blend, tmp_path / "out", preview)
    assert outcome.code == 0, outcome.output
    assert [path.name for path in outcome.files] == ["frame_0001.exr", "frame_0001.jpg"]


def test_a_render_that_saves_nothing_removes_nothing(blend, tmp_path):
    """What another began to write under its frame's name meanwhile."""
    render = f"""
import bpy, pathlib
other = pathlib.Path({str(tmp_path)!r}) / "other_0001.exr"
render = bpy.context.scene.render
ours, render.filepath = render.filepath, str(other.with_name("other_####"))
other.touch()
bpy.ops.render.render()
print("others:", other.exists())
render.filepath = ours
"""
    outcome = render_host.run(blend, tmp_path / "out", render)
    assert outcome.code == 0, outcome.output
    assert "others: True" in outcome.output
    assert [path.name for path in outcome.files] == ["frame_0001.exr"]


def test_whole_files_stay(blend, tmp_path):
    outcome = render_host.run(blend, tmp_path / "out", last=2)
    assert outcome.code == 0
    assert [path.name for path in outcome.files] == ["frame_0001.exr", "frame_0002.exr"]
    assert all(map(whole_file.is_whole, outcome.files))


def test_what_ends_within_the_writing_leaves_nothing_under_the_frames_name(blend, tmp_path):
    outcome = render_host.run(blend, tmp_path / "out", KILLED)
    assert outcome.code not in (0, 1), outcome.output
    (left,) = outcome.files
    assert left.name.startswith(".unfinished-") and left.name.endswith("frame_0001.exr")
    assert not whole_file.is_whole(left)


def test_a_frame_is_under_its_name_when_others_hear_of_it(blend, tmp_path):
    outcome = render_host.run(blend, tmp_path / "out", WATCHED, last=2)
    told = [line for line in outcome.output.splitlines() if line.startswith("at render_")]
    assert told == [
        f"at {event} frame_000{frame}.exr {there}"
        for frame in (1, 2)
        for event, there in (("render_pre", False), ("render_post", True), ("render_write", True))
    ]
    assert [path.name for path in outcome.files] == ["frame_0001.exr", "frame_0002.exr"]
    assert f"Saved: '{outcome.files[1]}'" in outcome.output


def test_frames_that_are_there_and_placeholders_are_blenders_affair(blend, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "frame_0001.exr").write_bytes(b"another's")
    kept = (
        "import bpy; r = bpy.context.scene.render; r.use_overwrite, r.use_placeholder = False, True"
    )
    outcome = render_host.run(blend, out, kept, last=2)
    assert outcome.code == 0, outcome.output
    assert [path.name for path in outcome.files] == ["frame_0001.exr", "frame_0002.exr"]
    assert outcome.files[0].read_bytes() == b"another's"
    assert whole_file.is_whole(outcome.files[1])


def test_a_link_stays_a_link(blend, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "frame_0001.exr").symlink_to(tmp_path / "elsewhere.exr")
    render_host.run(blend, out)
    assert (out / "frame_0001.exr").is_symlink()
    assert whole_file.is_whole(tmp_path / "elsewhere.exr")


def test_an_output_path_that_another_changes_is_theirs(blend, tmp_path):
    """As a script does that gives each frame a name of its own when its render has begun."""
    changes = f"""
import bpy
scene = bpy.context.scene
bpy.app.handlers.render_stats.append(
    lambda *_: setattr(scene.render, "filepath", {str(tmp_path / "other_####")!r}))
"""
    outcome = render_host.run(blend, tmp_path / "out", changes)
    assert outcome.code == 0, outcome.output
    assert whole_file.is_whole(tmp_path / "other_0001.exr")


def test_the_next_render_removes_what_a_killed_one_left(blend, tmp_path):
    (left,) = render_host.run(blend, tmp_path / "out", KILLED).files
    outcome = render_host.run(blend, tmp_path / "out")
    assert outcome.code == 0, outcome.output
    assert [path.name for path in outcome.files] == ["frame_0001.exr"]
    assert f"removed '{left}'" in outcome.output


def test_a_frame_that_is_stopped_before_it_is_saved_is_no_error(scene, tmp_path, capfd):
    """And leaves no folder."""
    scene.render.filepath = str(tmp_path / "folder" / "frame_####")
    happens(scene, "render_init", "render_pre")
    written_frames.is_rendered()
    assert ".unfinished-" in scene.render.filepath
    happens(scene, "render_cancel")
    assert scene.render.filepath == str(tmp_path / "folder" / "frame_####")
    assert "Granita" not in "".join(capfd.readouterr())
    assert list(tmp_path.iterdir()) == []


def test_a_cancelled_part_leaves_the_frames_own_file_to_whoever_writes_it(
    scene, tmp_path, monkeypatch
):
    words = ["blender", "--", f"--granita-parts={tmp_path / 'parts'}", "--granita-part=1/2"]
    monkeypatch.setattr("sys.argv", words)
    scene.render.filepath = str(tmp_path / "frame_####")
    happens(scene, "render_init", "render_pre")
    of_part, of_frame = Path(scene.render.frame_path()), tmp_path / "frame_0001.png"
    assert of_part == tmp_path / "parts" / "part_1-of-2_0001.png"
    of_part.parent.mkdir()
    for path in (of_part, of_frame):
        path.write_bytes(b"\x89PNG\r\n\x1a\n begun")
    happens(scene, "render_cancel")
    assert scene.render.filepath == str(tmp_path / "frame_####")
    assert (of_part.exists(), of_frame.exists()) == (False, True)
