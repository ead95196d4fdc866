# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl+C on a farm: `render()` returns within .5 s wherever it is, and the frame is not saved."""

import os
import signal
import subprocess
import threading
import time

import bpy
import pytest
import render_host
import scene_parts as parts

# The latency that the artist is promised, beyond the one Blender call in flight.
PROMISED_SECONDS = 0.5

# Says when each stage is reached and when `render()` returns, on the clock of this machine.
WATCH = """
import time
import granita.engine, granita.final_render as final_render, granita.bridge as bridge
def say(word):
    print("WATCH", word, time.time(), flush=True)
engine = granita.engine.GranitaRenderEngine
render = engine.render
def watched(self, depsgraph):
    bridge.load()  # two hundred libraries, .3 s in one call that nothing interrupts
    say("export")
    render(self, depsgraph)
    say("returned")
engine.render = watched
run_job = final_render.FinalRender._render
def watched_job(self, snapshot):
    say("native")
    return run_job(self, snapshot)
final_render.FinalRender._render = watched_job
"""


def many_knots(scene):
    """An export of seconds in short Blender calls: 129 knots of some deforming meshes."""
    scene.render.use_motion_blur = True
    scene.granita.motion_steps = 129
    side = 50
    vertices = [(x / side, y / side, 0.0) for y in range(side) for x in range(side)]
    faces = [
        (i, i + 1, i + side + 1, i + side)
        for y in range(side - 1)
        for i in range(y * side, y * side + side - 1)
    ]
    for n in range(30):
        thing = parts.add_mesh(scene, f"Wave{n}", vertices, faces, (n % 10 - 5, n // 10 - 5, 0))
        wave = thing.modifiers.new("Wave", "WAVE")
        wave.height, wave.width = 0.3, 0.5
        # Asked for by the object itself: paths that fewer knots hold would get fewer.
        steps = thing.cycles if hasattr(thing, "cycles") else thing.granita
        steps.motion_steps = 7


def fine_dicing(scene):
    """Minutes of dicing: every pixel is some hundred micropolygons, hidden by one sample."""
    parts.add_square(scene, size=20.0, location=(0, 0, -1))
    scene.render.resolution_x = scene.render.resolution_y = 4096
    scene.granita.dicing_rate = 0.06
    scene.granita.samples = 1


def many_samples(scene):
    """Minutes of hiding: few micropolygons, many samples."""
    parts.add_square(scene, size=20.0, location=(0, 0, -1))
    scene.render.resolution_x = scene.render.resolution_y = 2048
    scene.granita.dicing_rate = 8.0
    scene.granita.samples = 4096


def interrupt(blend, out, stage, delay):
    """Renders `blend`, interrupts it `delay` seconds after `stage` began: seconds until `render()`
    returned, exit code and output."""
    process = subprocess.Popen(
        render_host.command(blend, out / "frame_####", WATCH),
        env=render_host.environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        stdin=subprocess.DEVNULL,
        text=True,
    )
    output, interrupted, returned = [], None, None
    try:
        for line in process.stdout:
            output.append(line)
            if line.startswith(f"WATCH {stage}"):
                time.sleep(delay)
                interrupted = time.time()
                os.kill(process.pid, signal.SIGINT)
            elif line.startswith("WATCH returned"):
                returned = float(line.split()[2])
        code = process.wait(60)
    finally:
        process.kill()
    text = "".join(output)
    assert interrupted is not None and returned is not None, text
    assert returned > interrupted, "the frame was finished before it could be interrupted: " + text
    return returned - interrupted, code, text


@pytest.mark.parametrize(
    "make, stage",
    [(many_knots, "export"), (fine_dicing, "native"), (many_samples, "native")],
)
@pytest.mark.parametrize("delay", [0.1, 1.0])
def test_interrupt(scene, tmp_path, make, stage, delay):
    parts.add_camera(scene, location=(0, 0, 12))
    parts.multilayer_exr(scene)
    make(scene)
    blend = tmp_path / "slow.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True)
    out = tmp_path / "out"
    # The best of three: another process may hold this machine's cores for longer than the promise.
    for _ in range(3):
        seconds, code, text = interrupt(blend, out, stage, delay)
        assert code == 1, text
        assert "Not freed memory" not in text, text
        assert not out.exists() or not list(out.iterdir())
        if seconds < PROMISED_SECONDS:
            break
    assert seconds < PROMISED_SECONDS, text


# Ctrl-C where what it raises is dropped: in a callback of a weak reference, and in a handler of Blender's between frames.
DROPPED = {
    "export": (
        """
import os, signal, weakref, granita.final_render as final_render
class Thing: pass
export = final_render.FinalRender._export
def interrupted(self):
    thing = Thing()
    reference = weakref.ref(thing, lambda _: os.kill(os.getpid(), signal.SIGINT))
    del thing
    return export(self)
final_render.FinalRender._export = interrupted
""",
        0,
    ),
    "between frames": (
        """
import bpy, os, signal
def interrupt(*_):
    os.kill(os.getpid(), signal.SIGINT)
    for _ in range(1000):
        pass
bpy.app.handlers.render_write.append(interrupt)
""",
        1,
    ),
}


@pytest.mark.parametrize("moment", DROPPED)
def test_an_interrupt_that_python_drops_ends_the_render_all_the_same(scene, tmp_path, moment):
    parts.add_camera(scene)
    parts.add_square(scene)
    parts.multilayer_exr(scene)
    blend = tmp_path / "frames.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True)
    prepare, saved = DROPPED[moment]
    outcome = render_host.run(blend, tmp_path / "out", prepare, last=3)
    assert outcome.code == 1, outcome.output
    assert len(outcome.files) == saved, outcome.output
    assert bpy.app.binary_path or "Error: interrupted" in outcome.output


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="Blender's own program has its own way")
def test_an_interrupt_is_of_one_render():
    from granita import interrupts

    interrupts._listen()
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
    signal.raise_signal(signal.SIGINT)  # a second one changes nothing
    assert interrupts.came()
    interrupts._leave()
    assert not interrupts.came()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


class _Rendering:
    """Stands for an engine that renders in a thread."""

    def __init__(self, thread):
        self.thread = thread


def test_the_add_ons_end_does_not_wait_for_the_render_that_it_comes_from():
    from granita import engine

    own = _Rendering(threading.get_ident())
    engine._rendering.add(own)
    began = time.monotonic()
    engine._end_renders()
    # Ten seconds otherwise: for itself.
    assert time.monotonic() - began < 5.0


def test_the_add_ons_end_waits_for_renders_of_other_threads():
    from granita import engine

    held = [_Rendering(-1)]
    engine._rendering.add(held[0])
    threading.Timer(0.3, held.clear).start()
    began = time.monotonic()
    engine._end_renders()
    assert 0.2 < time.monotonic() - began < 9.0
