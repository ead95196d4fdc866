# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of moving edges against closed forms.

An orthographic camera sees a pixel a metre, the filter is one pixel's box.  Errors are held against
the "Owen" column of docs/sampling_error.md for an edge that crosses 20 pixels with 256 samples (RMSE
.0035): 1.3 times that, and 4 times for a single pixel.

No fixtures, for the reason in motion_parts.
"""

import numpy as np
import scene_parts
from motion_parts import set_position

RMSE, WORST = 1.3 * 0.0035, 4 * 0.0035
WIDTH, HEIGHT = 32, 16


def film_of_pixels(scene):
    """Pixel (i, j) spans the metres i to i + 1, j to j + 1; the shutter is one frame after frame 10."""
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.film_transparent = True
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 1.0
    set_position(scene, "START")
    scene.granita.samples = 256
    scene.granita.pixel_filter, scene.granita.filter_width = "BOX", 1.0
    scene_parts.add_camera(scene, (WIDTH / 2, HEIGHT / 2, 50.0), ortho_scale=WIDTH)
    scene.frame_set(10)
    return scene


def alpha(render, scene):
    return render(scene)["ViewLayer.Combined.A"]


def wall(scene, right, name="Wall"):
    """Covers all that is left of x = `right`."""
    corners = [(-200, -100, 0), (0, -100, 0), (0, 100, 0), (-200, 100, 0)]
    return scene_parts.add_mesh(scene, name, corners, [(0, 1, 2, 3)], (right, 0, 0))


def half_plane(scene):
    """Covers all that is above the middle of the film, around which it turns."""
    corners = [(-60, 0, 0), (60, 0, 0), (60, 60, 0), (-60, 60, 0)]
    middle = (WIDTH / 2, HEIGHT / 2, 0)
    return scene_parts.add_mesh(scene, "Half", corners, [(0, 1, 2, 3)], middle)


def left_of(edge, pixels):
    """Share of each pixel that is left of an edge."""
    return np.clip(edge - pixels, 0.0, 1.0)


def over_time(share_at, times):
    """Mean over the shutter, by the midpoint rule."""
    return np.mean([share_at(t) for t in times], axis=0)


def moving_disc(center, radius, way):
    """A disc moves right: it covers a place for the share of its way that the place's chord of it is."""
    fine = 16
    x = (np.arange(WIDTH * fine) + 0.5) / fine - center[0]
    y = (np.arange(HEIGHT * fine) + 0.5) / fine - center[1]
    half = np.sqrt(np.maximum(radius**2 - y**2, 0.0))[:, None]
    covered = np.minimum(x + half, way) - np.maximum(x - half, 0.0)
    share = np.clip(covered, 0.0, None) / way
    return share.reshape(HEIGHT, fine, WIDTH, fine).mean(axis=(1, 3))


MIDPOINTS = (np.arange(4096) + 0.5) / 4096


def hold(image, expected, crossings=1):
    """`crossings`: how often an edge passes a pixel; each adds its own noise."""
    error = image - expected
    blurred = (expected > 1e-9) & (expected < 1 - 1e-9)
    assert blurred.any()
    assert np.sqrt(np.mean(error[blurred] ** 2)) <= RMSE * np.sqrt(crossings)
    assert np.abs(error).max() <= WORST * np.sqrt(crossings)
