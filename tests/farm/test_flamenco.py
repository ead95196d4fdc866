# SPDX-License-Identifier: GPL-3.0-or-later
"""The Flamenco job type in Node: the tasks it makes, and that Blender renders by their arguments."""

import json
import subprocess
from pathlib import Path

import exr
import numpy as np

HERE = Path(__file__).parent
JOB_TYPE = HERE.parents[1] / "farm/flamenco/granita.js"
SETTINGS = {
    "frames": "1-3, 7",
    "chunk_size": 1,
    "parts": 1,
    "device": "cpu",
    "render_output_path": "/render/shot/######",
    "blendfile": "/scenes/shot.blend",
    "format": "OPEN_EXR",
}


def node(**changes):
    job = json.dumps({"name": "shot", "settings": SETTINGS | changes})
    return subprocess.run(
        ["node", HERE / "flamenco_manager.js", JOB_TYPE, job], capture_output=True, text=True
    )


def compiled(**changes):
    done = node(**changes)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def arguments(task):
    (command,) = task["commands"]
    assert command["name"] == "blender-render"
    return command["parameters"]["args"]


def after(words, option):
    return words[words.index(option) + 1]


def test_whole_frames_in_chunks():
    tasks = compiled(chunk_size=3)["tasks"]
    assert [task["name"] for task in tasks] == ["render-1-3", "render-7"]
    assert tasks[0]["commands"][0]["parameters"]["blendfile"] == "/scenes/shot.blend"
    words = arguments(tasks[0])
    assert after(words, "--render-frame") == "1..3"
    assert after(words, "--engine") == "GRANITA"
    assert after(words, "--render-output") == "/render/shot/######"
    assert after(words, "--render-format") == "OPEN_EXR"
    assert words[words.index("--") :] == ["--", "--granita-device", "cpu"]


def test_each_frame_is_joined_when_its_own_parts_are_there():
    tasks = compiled(frames="5-6", parts=3)["tasks"]
    assert len(tasks) == 2 * (3 + 1)
    for frame in ("5", "6"):
        names = [f"part-{frame}-{k}-of-3" for k in (1, 2, 3)]
        parts = [task for task in tasks if task["name"] in names]
        assert [after(arguments(t), "--granita-part") for t in parts] == ["1/3", "2/3", "3/3"]
        (merge,) = (task for task in tasks if task["name"] == f"merge-{frame}")
        assert merge["dependencies"] == names
        assert after(arguments(merge), "--granita-merge") == "3"
        assert after(arguments(merge), "--render-frame") == frame


def test_movies_are_refused():
    done = node(format="FFMPEG")
    assert done.returncode != 0 and "choose an image format instead of FFMPEG" in done.stderr


def test_the_form_shows_what_an_artist_sets():
    settings = compiled()["type"]["settings"]
    shown = {s["key"] for s in settings if s.get("visible", "visible") in ("visible", "submission")}
    assert {"frames", "chunk_size", "parts", "device", "render_output_root"} <= shown
    keys = [s["key"] for s in settings]
    assert len(keys) == len(set(keys)) and set(SETTINGS) <= set(keys)
    for setting in settings:
        assert setting["type"] in ("string", "int32", "bool", "float")
        # What the form does not show has to come from the file or a default.
        assert setting["key"] in shown or "eval" in setting or "default" in setting


def perform(task, blender):
    """Runs a task as a Worker does, its variables as the Manager's configuration has them at first.

    https://flamenco.blender.org/usage/variables/blender/
    """
    (command,) = task["commands"]
    words = command["parameters"]
    assert words["exe"] == "{blender}" and words["exeArgs"] == "{blenderArgs}"
    done = subprocess.run(
        [blender, "-b", "-y", *words["argsBefore"], words["blendfile"], *words["args"]],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_blender_renders_chunks_and_parts_alike_by_the_arguments(blender, scene, tmp_path):
    common = {"frames": "1-2, 3", "blendfile": str(scene), "format": "OPEN_EXR_MULTILAYER"}
    for task in compiled(chunk_size=2, render_output_path=f"{tmp_path}/whole/####", **common)[
        "tasks"
    ]:
        perform(task, blender)
    done = set()
    for task in compiled(parts=2, render_output_path=f"{tmp_path}/joined/####", **common)["tasks"]:
        assert done.issuperset(task["dependencies"])
        perform(task, blender)
        done.add(task["name"])
    for name in ("0001.exr", "0002.exr", "0003.exr"):
        expected = exr.read(tmp_path / "whole" / name)
        for channel, plane in exr.read(tmp_path / "joined" / name).items():
            np.testing.assert_array_equal(plane, expected[channel])
    # The square moves from frame to frame.
    first, last = (exr.read(tmp_path / "joined" / f"000{n}.exr") for n in (1, 3))
    assert any((first[channel] != last[channel]).any() for channel in first)
