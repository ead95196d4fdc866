# SPDX-License-Identifier: GPL-3.0-or-later
"""The ways in which an animation's render is stopped, for cancels.py.

Each is a function of (file, folder for frames, seconds from the first frame to the stop) that returns the exit code of
what was started.
"""

import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import frames

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
FRAMES = 60
BLENDER = ["blender", "--factory-startup", "--addons", "granita"]
OPENJD = frames.CACHE.parent / "farm" / "bin" / "openjd"  # ./dev test --farm installs it
PATIENCE = 120.0


def start(words, **more):
    streams = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    return subprocess.Popen([str(word) for word in words], **streams, **more)


def render(blend, out, *which):
    """A Blender in background that renders `which` frames."""
    return start([*BLENDER, "-b", blend, "-E", "GRANITA", "-o", out / "frame_####", *which])


def _ends_by(process, stop, out, later):
    """The exit code of a process that gets the signal `later` seconds after its first frame."""
    began = time.monotonic()
    while not any(out.glob("frame_*")) and time.monotonic() - began < PATIENCE:
        time.sleep(0.02)
    time.sleep(later)
    process.send_signal(stop)
    return process.wait(PATIENCE)


def _by_signal(stop):
    return lambda blend, out, later: _ends_by(render(blend, out, "-a"), stop, out, later)


def _by_escape(blend, out, later):
    """In a window, by the key."""
    words = [*BLENDER, blend, "-o", out / "frame_####", "--python", HERE / "escaped_render.py"]
    screen = ["xvfb-run", "-a", "-s", "-screen 0 800x600x24"]
    environment = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}
    return start([*screen, *words, "--", later], env=environment).wait(PATIENCE)


def _by_farm(blend, out, later):
    """A task of Open Job Description that its runner cancels."""
    program = blend.with_name("blender")
    program.write_text(f'#!/bin/sh\nexec {" ".join(BLENDER)} "$@"\n')
    program.chmod(0o755)
    words = [OPENJD, "run", ROOT / "farm/openjd/granita_frames/template.yaml"]
    values = {"SceneFile": blend, "Blender": program, "OutputFolder": out, "Frames": f"1-{FRAMES}"}
    for name, value in values.items():
        words += ["-p", f"{name}={value}"]
    return _ends_by(start(words, start_new_session=True), signal.SIGINT, out, later)


# Name: (function, the exit code that is right).
WAYS = {
    "Esc": (
        _by_escape,
        1,
    ),  # Blender is quit after it, and ends with 1 where its last job was stopped
    "SIGINT": (_by_signal(signal.SIGINT), 1),
    "SIGTERM": (_by_signal(signal.SIGTERM), -signal.SIGTERM),
    "SIGKILL": (_by_signal(signal.SIGKILL), -signal.SIGKILL),
    "openjd": (_by_farm, 1),
}


def ways_here():
    """Names of those that this machine has what they need for."""
    needs = {"Esc": shutil.which("xvfb-run"), "openjd": OPENJD.exists()}
    return [name for name in WAYS if needs.get(name, True)]
