# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of passes, and what uses it: registration and the hand-over of tiles."""

from collections import namedtuple

import numpy as np

# `wanted`: the view layer's property that asks for the pass (None: always there).
# `tile`: the attribute of a native tile that holds it, f32 [h, w, channels] or [h, w].
Pass = namedtuple("Pass", "name channels channel_ids kind wanted tile")

PASSES = (
    Pass("Combined", 4, "RGBA", "COLOR", None, "combined"),
    Pass("Depth", 1, "Z", "VALUE", "use_pass_z", "depth"),
)

# Blender's depth where there is no surface.
NO_SURFACE_DEPTH = 1e10


def wanted(view_layer):
    return [p for p in PASSES if p.wanted is None or getattr(view_layer, p.wanted)]


def register(engine, scene, view_layer):
    """Every pass is registered, standard ones too: else the result holds Combined alone."""
    for p in wanted(view_layer):
        engine.register_pass(scene, view_layer, p.name, p.channels, p.channel_ids, p.kind)


def deliver(engine, tile, passes, layer, origin):
    """Copies one native tile into Blender's render result.

    `origin`: the crop's lower-left pixel in the frame, which is (0, 0) of the result.  The result
    is closed on every path (an open one crashes the saving of float files).
    """
    height, width = tile.combined.shape[:2]
    result = engine.begin_result(tile.x - origin[0], tile.y - origin[1], width, height, layer=layer)
    complete = False
    try:
        if (result.resolution_x, result.resolution_y) != (width, height):
            raise ValueError(
                f"tile ({tile.x}, {tile.y}) of {width} x {height} pixels does not fit the result: "
                f"{result.resolution_x} x {result.resolution_y} pixels are left"
            )
        render_passes = result.layers[0].passes
        for p in passes:
            pixels = getattr(tile, p.tile)
            if p.name == "Depth":
                pixels = np.where(np.isfinite(pixels), pixels, NO_SURFACE_DEPTH)
            _put(render_passes[p.name], pixels, width * height, p.channels)
        complete = True
    finally:
        engine.end_result(result, cancel=not complete)


def _put(render_pass, pixels, count, channels):
    """Up to Blender 4.0 `rect` has the shape (pixels, channels), later it is flat.

    It must be contiguous float32: other types leave the fast path, which on 3.4 does not check
    its size.
    """
    flat = np.ascontiguousarray(pixels, dtype=np.float32).reshape(-1)
    if flat.size != count * channels:
        raise ValueError(f"pass {render_pass.name}: {flat.size} values for {count} pixels")
    try:
        render_pass.rect.foreach_set(flat)
    except TypeError:
        render_pass.rect.foreach_set(flat.reshape(count, channels))
