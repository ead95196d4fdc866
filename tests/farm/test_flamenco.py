# SPDX-License-Identifier: GPL-3.0-or-later
"""The Flamenco job type in Node: the tasks it makes, and that Blender takes their arguments."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

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

pytestmark = pytest.mark.skipif(shutil.which("node") is None, reason="Node is not installed")


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
    assert command["parameters"]["blendfile"] == SETTINGS["blendfile"]
    return command["parameters"]["args"]


def after(words, option):
    return words[words.index(option) + 1]


def test_whole_frames_in_chunks():
    tasks = compiled(chunk_size=3)["tasks"]
    assert [task["name"] for task in tasks] == ["render-1-3", "render-7"]
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
