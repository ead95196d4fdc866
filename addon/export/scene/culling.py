# SPDX-License-Identifier: GPL-3.0-or-later
"""Things that Simplify leaves out, as Cycles does: where their boxes lie outside of the frame, or far from the camera."""

import numpy as np

from ..base.transforms import inverse
from ..base.updates import originals

# Things whose corners are looked at together.
_AT_ONCE = 1 << 16


def culling_asked(scene):
    """(by the frame, by distance): what a Scene leaves out things by that let it.  The original one is asked: Blender
    does not carry a change of it to the one that it keeps evaluated."""
    settings = getattr(scene, "cycles", None)
    if settings is None or not scene.render.use_simplify:
        return False, False
    far = settings.use_distance_cull and settings.distance_cull_margin > 0.0
    return settings.use_camera_cull, far


def culling_box(thing):
    """Corners of an evaluated Object's box in its own space, homogeneous: float64 [8, 4]."""
    corners = np.ones((8, 4))
    corners[:, :3] = thing.bound_box
    return corners


class Culling:
    """From where the camera stands at the frame."""

    def __init__(self, scene, camera, frame):
        """
        Args:
            scene: original.
            camera: record of camera.camera_record; no panorama, of which Cycles leaves out nothing.
            frame: camera.Frame.
        """
        self._asked = culling_asked(scene)
        self._margin = scene.cycles.camera_cull_margin
        self._distance = scene.cycles.distance_cull_margin
        self._camera_from_world = inverse(camera["world_from_camera"][0])
        self._eye = camera["world_from_camera"][0][:3, 3].copy()
        self._is_perspective = camera["kind"] == "PERSPECTIVE"
        self._scale, self._center = np.array(camera["scale"]), np.array(camera["center"])
        self._size, self._clip = np.array([frame.width, frame.height]), camera["clip"]

    def left_out(self, scan):
        """bool [n] of a depsgraph.Visit."""
        prototypes = scan.prototypes
        boxes, lets = np.zeros((len(prototypes), 8, 4)), np.zeros((len(prototypes), 2), dtype=bool)
        everything = originals()
        for number, prototype in enumerate(prototypes):
            # Asked each time: Blender names no change of it.  Handlers may delete things.
            owner = everything.get(prototype.address)
            if owner is not None and prototype.culling_box is not None:
                boxes[number] = prototype.culling_box
                lets[number] = owner.cycles.use_camera_cull, owner.cycles.use_distance_cull
        lets &= self._asked
        left_out = np.zeros(len(scan.prototype), dtype=bool)
        some = np.flatnonzero(lets.any(axis=1)[scan.prototype])
        for begin in range(0, len(some), _AT_ONCE):
            things = some[begin : begin + _AT_ONCE]
            which = scan.prototype[things]
            corners = boxes[which] @ scan.matrices[things].transpose(0, 2, 1)
            # What may go by both goes by both alone.
            by_frame = self._is_outside(corners) | ~lets[which, 0]
            by_distance = self._is_far(corners[..., :3]) | ~lets[which, 1]
            left_out[things] = by_frame & by_distance
        return left_out

    def _is_outside(self, corners):
        """bool [m] of [m, 8, 4]: the frame is from 0 to 1, and depth from 0 at the near clip."""
        x, y, z = np.moveaxis((corners @ self._camera_from_world.T)[..., :3], -1, 0)
        near, far = self._clip
        with np.errstate(divide="ignore", invalid="ignore"):
            along = np.stack([x, y], axis=-1) / (z[..., None] if self._is_perspective else 1.0)
            at = (along * self._scale + self._center) / self._size
            depth = (z - near) * ((far if self._is_perspective else 1.0) / (far - near))
            at = np.where((depth < 0.0)[..., None], 1.0 - at, at)
            beside = (at.min(axis=1) >= 1.0 + self._margin) | (at.max(axis=1) <= -self._margin)
        return (depth < -self._margin).all(axis=1) | beside.any(axis=-1)

    def _is_far(self, corners):
        """bool [m] of [m, 8, 3]: from the nearest point of the boxes around them."""
        nearest = np.clip(self._eye, corners.min(axis=1), corners.max(axis=1))
        return ((nearest - self._eye) ** 2).sum(axis=-1) > self._distance**2
