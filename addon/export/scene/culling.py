# SPDX-License-Identifier: GPL-3.0-or-later
"""Things that Simplify leaves out, as Cycles does: where their boxes lie outside of the frame, or far from the camera."""

import numpy as np

from ..base.updates import originals


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
    """From one place of the camera."""

    def __init__(self, scene, camera, frame):
        """
        Args:
            scene: original.
            camera: record of camera.camera_record.
            frame: camera.Frame.
        """
        self._asked = culling_asked(scene)
        self._margin = scene.cycles.camera_cull_margin
        self._distance = scene.cycles.distance_cull_margin
        self._camera, self._size = camera, np.array([frame.width, frame.height])

    def left_out(self, scan):
        """bool [n] of a depsgraph.Visit."""
        left_out = np.zeros(len(scan.prototype), dtype=bool)
        everything = originals()
        order = np.argsort(scan.prototype, kind="stable")
        ends = np.searchsorted(scan.prototype[order], np.arange(len(scan.prototypes) + 1))
        for number, prototype in enumerate(scan.prototypes):
            # Asked each time: Blender names no change of it.  Handlers may delete things.
            owner = everything.get(prototype.address)
            if owner is None or prototype.culling_box is None:
                continue
            by_frame = self._asked[0] and owner.cycles.use_camera_cull
            by_distance = self._asked[1] and owner.cycles.use_distance_cull
            if not (by_frame or by_distance):
                continue
            things = order[ends[number] : ends[number + 1]]
            corners = prototype.culling_box @ scan.matrices[things].transpose(0, 2, 1)
            # What may go by both goes by both alone.
            gone = np.ones(len(things), dtype=bool)
            if by_frame:
                gone &= self._is_outside(corners)
            if by_distance:
                gone &= self._is_far(corners[..., :3])
            left_out[things] = gone
        return left_out

    def _is_outside(self, corners):
        """bool [m] of [m, 8, 4]: the frame is from 0 to 1, and depth from 0 at the near clip."""
        place, camera = self._camera["world_from_camera"][0], self._camera
        x, y, z = np.moveaxis((corners @ np.linalg.inv(place).T)[..., :3], -1, 0)
        near, far = camera["clip"]
        is_perspective = camera["kind"] == "PERSPECTIVE"
        with np.errstate(divide="ignore", invalid="ignore"):
            along = np.stack([x, y], axis=-1) / (z[..., None] if is_perspective else 1.0)
            at = (along * camera["scale"] + camera["center"]) / self._size
            depth = (z - near) * ((far if is_perspective else 1.0) / (far - near))
            behind = depth < 0.0
            at = np.where(behind[..., None], 1.0 - at, at)
            margin = self._margin
            beside = (at.min(axis=1) >= 1.0 + margin) | (at.max(axis=1) <= -margin)
        return (depth < -margin).all(axis=1) | beside.any(axis=-1)

    def _is_far(self, corners):
        """bool [m] of [m, 8, 3]: from the nearest point of the boxes around them."""
        eye = self._camera["world_from_camera"][0][:3, 3]
        nearest = np.clip(eye, corners.min(axis=1), corners.max(axis=1))
        return ((nearest - eye) ** 2).sum(axis=-1) > self._distance**2
