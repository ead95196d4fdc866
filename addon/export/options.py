# SPDX-License-Identifier: GPL-3.0-or-later
"""Render settings -> the snapshot's options: Blender's own properties, then `scene.granita`."""

from dataclasses import dataclass

import numpy as np

from .camera import Frame
from .report import ExportError

SHUTTER_CURVE_SIZE = 257

# Read from the settings under the same name; (name, used where the settings lack it).
_SETTINGS = (
    ("samples", 64),
    ("sampling", "INDEPENDENT"),
    ("time_samples", 0),
    ("pixel_filter", "BLACKMAN_HARRIS"),
    ("filter_width", 1.5),
    ("dicing_rate", 1.0),
    ("shading_rate", 0.0),
    ("grid_size", 256),
    ("bucket_size", 64),
    ("opacity_threshold", 0.996),
    ("light_samples", 8),
    ("device", "AUTO"),
    ("executor", "AUTO"),
)


@dataclass(frozen=True)
class Shutter:
    """When the film sees light.

    `offsets` are the knots, in frames from Blender's frame, ascending and equidistant;
    `offsets[frame_knot]` is 0.  One knot means no motion.
    """

    offsets: tuple
    frame_knot: int
    frame_time: float


_FRAME_TIME = {"START": 0.0, "CENTER": 0.5, "END": 1.0}


def shutter(length, position, steps):
    """Args: length in frames; START, CENTER or END; most knots (rounded up to an odd number, so
    that Blender's frame is always one of them)."""
    time = _FRAME_TIME[position]
    if length <= 0.0 or steps < 2:
        return Shutter((0.0,), 0, time)
    knots = steps | 1
    frame_knot = round(time * (knots - 1))
    step = length / (knots - 1)
    return Shutter(tuple((i - frame_knot) * step for i in range(knots)), frame_knot, time)


def scene_shutter(scene, settings):
    """The shutter of a scene; without motion blur it has one knot."""
    render = scene.render
    # Blender 4.2 moved the position out of Cycles' settings.
    owner = render if hasattr(render, "motion_blur_position") else getattr(scene, "cycles", None)
    position = getattr(owner, "motion_blur_position", "CENTER")
    steps = getattr(settings, "motion_steps", 3) if render.use_motion_blur else 1
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


def scene_frame(render):
    """The full frame; Blender divides the percentage out in whole numbers."""
    percentage = render.resolution_percentage
    return Frame(
        max(render.resolution_x * percentage // 100, 1),
        max(render.resolution_y * percentage // 100, 1),
        render.pixel_aspect_x,
        render.pixel_aspect_y,
    )


def border(frame, min_x, min_y, max_x, max_y):
    """Pixels (x0, y0, x1, y1) of a border given in fractions of the frame.

    Blender multiplies in single precision and truncates; so must we, to agree on the size.
    """

    def pixel(fraction, size):
        return min(max(int(np.float32(fraction) * np.float32(size)), 0), size)

    return (
        pixel(min_x, frame.width),
        pixel(min_y, frame.height),
        pixel(max_x, frame.width),
        pixel(max_y, frame.height),
    )


def mixed_seed(seed, frame):
    """A seed that differs from frame to frame: two rounds of a 32-bit finalizer.

    31 bits, so that it is a whole number on every border that it crosses.
    """
    value = (seed * 0x9E3779B9 + frame * 0x85EBCA6B) & 0xFFFFFFFF
    for _ in range(2):
        value ^= value >> 16
        value = value * 0x7FEB352D & 0xFFFFFFFF
        value ^= value >> 15
        value = value * 0x846CA68B & 0xFFFFFFFF
    return (value ^ (value >> 16)) & 0x7FFFFFFF


def options_record(scene, view_layer, settings, frame, frame_time):
    """The snapshot's options.

    Args:
        scene: whose `render` settings count.
        view_layer: asked for a depth pass.
        settings: `scene.granita`, anything with some of its properties, or None.
        frame: Frame.
        frame_time: place of Blender's frame in the shutter, 0 to 1.

    Raises:
        ExportError: the border encloses no pixel.
    """
    render = scene.render
    crop = (0, 0, frame.width, frame.height)
    if render.use_border:
        crop = border(
            frame,
            render.border_min_x,
            render.border_min_y,
            render.border_max_x,
            render.border_max_y,
        )
        if crop[2] <= crop[0] or crop[3] <= crop[1]:
            raise ExportError(f"scene '{scene.name}'", "the render border encloses no pixel")
    seed = int(getattr(settings, "seed", 0)) & 0x7FFFFFFF
    if getattr(settings, "animate_seed", False):
        seed = mixed_seed(seed, scene.frame_current)
    threads = int(getattr(settings, "threads", 0) or 0)
    if threads == 0 and render.threads_mode == "FIXED":
        threads = render.threads
    record = {name: getattr(settings, name, fallback) for name, fallback in _SETTINGS}
    record.update(
        width=frame.width,
        height=frame.height,
        crop=np.array(crop, dtype=np.int32),
        frame=scene.frame_current,
        seed=seed,
        threads=threads,
        film_transparent=bool(render.film_transparent),
        depth_pass=bool(view_layer.use_pass_z),
        frame_time=frame_time,
        shutter_curve=shutter_curve(render),
    )
    return record
