# SPDX-License-Identifier: GPL-3.0-or-later
"""Render settings -> the snapshot's options: Blender's own properties, then `scene.granita`."""

import math
from dataclasses import replace

import numpy as np

from ..base.report import ExportError
from .camera import Frame
from .light_paths import light_paths
from .shutter import rolling_shutter, shutter_curve

MOST_SAMPLES = 4096  # as of scene.granita.samples
_MOST_LIGHT_SAMPLES = 65536
_LIT_BY_THEIR_OWN = 64  # samples, up to which Light Samples are meant as they are

# Read from the settings under the same name; (name, used where the settings lack it).
_SETTINGS = (
    ("samples", 64),
    ("noise_threshold", 0.0),
    ("min_samples", 16),
    ("sampling", "INDEPENDENT"),
    ("time_samples", 0),
    ("pixel_filter", "BLACKMAN_HARRIS"),
    ("filter_width", 1.5),
    ("dicing_rate", 1.0),
    ("shading_rate", 0.0),
    ("motion_factor", 1.0),
    ("focus_factor", 1.0),
    ("grid_size", 256),
    ("bucket_size", 64),
    ("z_batch_size", 26),
    ("opacity_threshold", 0.996),
    ("light_samples", 16),
    ("shading_threshold", 0.06),
    ("device", "AUTO"),
    ("executor", "AUTO"),
)


def scene_frame(render):
    """The full frame; Blender divides the percentage out in whole numbers."""
    percentage = render.resolution_percentage
    return Frame(
        max(render.resolution_x * percentage // 100, 1),
        max(render.resolution_y * percentage // 100, 1),
        render.pixel_aspect_x,
        render.pixel_aspect_y,
    )


def rendered_frame(engine, render):
    """The full frame as the render under way began it: a handler may have set another resolution since, which is
    that of the next frame.

    Args:
        engine: RenderEngine; None in scripts.
        render: RenderSettings.
    """
    frame = scene_frame(render)
    if engine is None or not engine.resolution_x:
        return frame
    return replace(frame, width=engine.resolution_x, height=engine.resolution_y)


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


def _samples(scene, view_layer, samples):
    """Samples a pixel: a view layer may have a number of its own (0: it has none).  Cycles' setting for
    these numbers counts where its add-on is enabled."""
    own = min(view_layer.samples, MOST_SAMPLES)
    use = getattr(getattr(scene, "cycles", None), "use_layer_samples", "USE")
    if own == 0 or use == "IGNORE":
        return samples
    return min(own, samples) if use == "BOUNDED" else own


def light_samples(own, samples, noise_threshold):
    """Of a shading point, where the setting is `own`: more Samples than 64 take as many times more, or the noise of
    light would be what all of them share.  Where a Noise Threshold ends them Samples are a bound, and tell nothing."""
    if noise_threshold > 0.0:
        return own
    doublings = math.floor(math.log2(samples / _LIT_BY_THEIR_OWN))
    return min(own * 2 ** max(doublings, 0), _MOST_LIGHT_SAMPLES)


def render_border(render, frame):
    """Pixels (x0, y0, x1, y1) of the frame that a scene's border encloses; without one, all."""
    if not render.use_border:
        return (0, 0, frame.width, frame.height)
    return border(
        frame,
        render.border_min_x,
        render.border_min_y,
        render.border_max_x,
        render.border_max_y,
    )


def scene_crop(scene, frame):
    """Pixels of the frame that a final render makes: (x0, y0, x1, y1).

    Raises:
        ExportError: the border encloses no pixel.
    """
    crop = render_border(scene.render, frame)
    if crop[2] <= crop[0] or crop[3] <= crop[1]:
        raise ExportError(f"scene '{scene.name}'", "the render border encloses no pixel")
    return crop


def options_record(scene, view_layer, settings, frame, crop, frame_time, in_view=False, world=None):
    """The snapshot's options.

    Args:
        scene: whose `render` settings count.
        view_layer: asked for its samples, its motion blur and a depth pass.
        settings: `scene.granita`, anything with some of its properties, or None.
        frame: Frame.
        crop: pixels of it that are made, (x0, y0, x1, y1).
        frame_time: place of Blender's frame in the shutter, 0 to 1.
        in_view: for a 3D view.
        world: as of light_paths.
    """
    render = scene.render
    seed = int(getattr(settings, "seed", 0)) & 0x7FFFFFFF
    if getattr(settings, "animate_seed", False):
        seed = mixed_seed(seed, scene.frame_current)
    threads = int(getattr(settings, "threads", 0) or 0)
    if threads == 0 and render.threads_mode == "FIXED":
        threads = render.threads
    record = {name: getattr(settings, name, fallback) for name, fallback in _SETTINGS}
    record["samples"] = _samples(scene, view_layer, record["samples"])
    record["light_samples"] = light_samples(
        record["light_samples"], record["samples"], record["noise_threshold"]
    )
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
        rolling_shutter=rolling_shutter(scene, view_layer),
        **light_paths(scene, settings, in_view, world),
    )
    return record
