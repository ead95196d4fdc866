# SPDX-License-Identifier: GPL-3.0-or-later
"""When the film sees light, and how Blender's time gets there."""

import math
from dataclasses import dataclass

import numpy as np

SHUTTER_CURVE_SIZE = 257

_FRAME_TIME = {"START": 0.0, "CENTER": 0.5, "END": 1.0}


@dataclass(frozen=True)
class Shutter:
    """The interval that is open, in frames, and where Blender's frame lies in it.

    Times within it are ticks: whole numbers from 0 to `segments`, the most segments of a path.
    """

    length: float  # frames
    frame_time: float  # of Blender's frame: 0, 1/2 or 1
    segments: int  # even; 0 = no motion

    @property
    def frame_tick(self):
        """Blender's frame is always a tick."""
        return round(self.frame_time * self.segments)

    def offset(self, tick, segments=None):
        """Frames from Blender's frame to a tick of `segments` (this shutter's own by default)."""
        return (tick / (segments or self.segments or 1) - self.frame_time) * self.length


def shutter(length, position, steps):
    """Args: length in frames; START, CENTER or END; most knots (rounded up to an odd number, so
    that Blender's frame is always one of them)."""
    if length <= 0.0 or steps < 2:
        return Shutter(length, _FRAME_TIME[position], 0)
    return Shutter(length, _FRAME_TIME[position], (steps | 1) - 1)


def is_blurred(scene, view_layer):
    """Whether scene and view layer both want motion blur."""
    return scene.render.use_motion_blur and view_layer.use_motion_blur


def scene_shutter(scene, view_layer, settings):
    """The shutter of a view layer; without motion blur it has no segments."""
    render = scene.render
    # Blender 4.2 moved the position out of Cycles' settings.
    owner = render if hasattr(render, "motion_blur_position") else getattr(scene, "cycles", None)
    position = getattr(owner, "motion_blur_position", "CENTER")
    steps = getattr(settings, "motion_steps", 17) if is_blurred(scene, view_layer) else 1
    return shutter(render.motion_blur_shutter, position, steps)


def shutter_curve(render):
    """float32 [257], how far the shutter is open over its interval; empty where that is constant."""
    mapping = render.motion_blur_shutter_curve
    mapping.initialize()
    curve = mapping.curves[0]
    times = np.linspace(0.0, 1.0, SHUTTER_CURVE_SIZE)
    opening = np.array([mapping.evaluate(curve, t) for t in times], dtype=np.float32)
    opening = np.maximum(opening, 0.0)
    is_box = np.ptp(opening) < 1e-6
    return np.zeros(0, dtype=np.float32) if is_box else opening


def rolling_shutter(scene, view_layer):
    """Duration of a rolling shutter's row, a fraction of the shutter; -1 = all rows at once.

    Cycles' property: Blender itself has none.
    """
    cycles = getattr(scene, "cycles", None)
    if not is_blurred(scene, view_layer):
        return -1.0
    if getattr(cycles, "rolling_shutter_type", "NONE") != "TOP":
        return -1.0
    return float(cycles.rolling_shutter_duration)


class Clock:
    """Moves Blender's time.  Inside a render the engine does it; in a script, the scene."""

    def __init__(self, engine, scene):
        self._step = engine.frame_set if engine is not None else self._scene_step
        self._scene = scene
        self.after = lambda: None  # called after every step
        # Read back after a step to a negative time, frame and subframe are no longer floor and
        # remainder: their sum is always right.
        self.start = scene.frame_current + scene.frame_subframe
        # A script's frame_set clears the list of updates before it returns.
        self.knows_updates = engine is not None

    def go(self, offset):
        """To `offset` frames after the start; `frame_set` wants a subframe in [0, 1)."""
        self._step(*split_time(self.start + offset))
        self.after()

    def _scene_step(self, frame, subframe):
        self._scene.frame_set(frame, subframe=subframe)


def split_time(time):
    """(whole frame, subframe in [0, 1)), also where time is negative."""
    frame = math.floor(time)
    subframe = time - frame
    # float32 inside Blender: a remainder that rounds to 1 would be clamped.
    if np.float32(subframe) >= 1.0:
        return frame + 1, 0.0
    return frame, subframe
