# SPDX-License-Identifier: GPL-3.0-or-later
"""Where things go on the picture while the shutter is open, drawn over it: how much of a blur is whose."""

import numpy as np

from .carried_motion import path_at

TIMES = 9  # of the shutter, from its opening to its closing
_MOST_THINGS = 2000  # the first ones of a scene: more are a carpet
_LEAST_PIXELS = 1.0
_COLOR = (1.0, 0.6, 0.1, 1.0)


def motion_paths(snapshot):
    """float64 [n, TIMES, 2], pixels of the snapshot's frame: the ways of the middles of things that cross a pixel.

    What the camera's own motion makes of what stands still is in them.
    """
    times = np.linspace(0.0, 1.0, TIMES)
    camera, instances = snapshot["camera"], snapshot["instances"]
    knots = instances["knots"][:_MOST_THINGS]
    ends = np.cumsum(knots)
    middles = [_middles(geometry, times) for geometry in snapshot["geometries"]]
    found = []
    # Its inverse goes straight (camera_at).
    eye = path_at(np.linalg.inv(camera["world_from_camera"]), times)
    for geometry, count, end in zip(instances["geometry"], knots, ends):
        places = path_at(instances["world_from_object"][end - count : end], times)
        found.append((eye @ places @ middles[geometry])[..., :3, 0])
    if not found:
        return np.zeros((0, TIMES, 2))
    seen = np.array(found)
    depth = seen[..., 2:] if camera["kind"] == "PERSPECTIVE" else np.ones_like(seen[..., 2:])
    with np.errstate(divide="ignore", invalid="ignore"):
        pixels = seen[..., :2] / depth * np.array(camera["scale"]) + np.array(camera["center"])
    before = (seen[..., 2] > camera["clip"][0]).all(axis=1)
    moves = np.ptp(pixels, axis=1).max(axis=1) > _LEAST_PIXELS
    return pixels[before & moves]


def _middles(geometry, times):
    """float64 [TIMES, 4, 1]: the middle of its bounds at each time, object space."""
    points = geometry["points"]
    middle = np.ones((len(points), 4, 1))
    if points.shape[1]:
        middle[:, :3, 0] = (points.min(axis=1) + points.max(axis=1)) / 2.0
    return path_at(middle, times)


class DrawnPaths:
    """Those of a view's picture.  Made between two events, for the same reason as its pixels (live_picture.py)."""

    def __init__(self):
        self.wanted = False
        self._snapshot = self._sight = None  # whose they are
        self._lines = self._ends = ()  # float32 [n, 2 or 3], region pixels

    def are_of(self, snapshot, sight):
        """Whether they can be drawn over that picture; no matter where they are not wanted."""
        return not self.wanted or (self._snapshot is snapshot and self._sight is sight)

    def prepare(self, snapshot, sight):
        if self.are_of(snapshot, sight):
            self._snapshot = snapshot if self.wanted else None  # else nothing is kept for them
            return
        self._snapshot, self._sight = snapshot, sight
        places = motion_paths(snapshot) * sight.pixel + np.array(sight.place)
        self._lines = _corners(np.stack([places[:, :-1], places[:, 1:]], axis=2).reshape(-1, 2))
        self._ends = _corners(places[:, -1])  # where things are when the shutter closes

    def draw(self):
        """Inside `view_draw` alone."""
        if not self.wanted or len(self._ends) == 0:
            return
        import bpy
        import gpu
        from gpu_extras.batch import batch_for_shader

        shader = gpu.shader.from_builtin(
            "UNIFORM_COLOR" if bpy.app.version >= (4, 0, 0) else "2D_UNIFORM_COLOR"
        )
        shader.bind()
        shader.uniform_float("color", _COLOR)
        batch_for_shader(shader, "LINES", {"pos": self._lines}).draw(shader)
        gpu.state.point_size_set(5.0)
        batch_for_shader(shader, "POINTS", {"pos": self._ends}).draw(shader)


def _corners(places):
    import bpy

    if bpy.app.version >= (4, 0, 0):
        places = np.hstack([places, np.zeros((len(places), 1))])
    return places.astype(np.float32)
