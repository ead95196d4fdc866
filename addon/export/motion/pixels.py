# SPDX-License-Identifier: GPL-3.0-or-later
"""How many pixels of the frame a distance in the scene is, in the worst place."""

from functools import cached_property

import numpy as np

from ..base.transforms import inverse

_MOST_PROBES = 4096


def _reach(matrices, half):
    """No less than how far boxes reach from their centers, float64 [m]; matrices [m, 4, 4], half sizes [m, 3]."""
    return np.einsum("nj,nj->n", np.linalg.norm(matrices[:, :3, :3], axis=1), half)


class PixelScale:
    """Measures of differences of paths.

    Args:
        scene: frame_scene.FrameScene.
        cameras: {tick: float64 [4, 4] world from camera}.

    `views` holds their inverses.
    """

    def __init__(self, scene, cameras):
        self._scene = scene
        self._focal = max(scene.camera_record["scale"])
        self._perspective = scene.camera_record["kind"] == "PERSPECTIVE"
        self._near = scene.camera_record["clip"][0]
        self.views = {tick: inverse(matrix) for tick, matrix in cameras.items()}

    def places(self, things, path):
        """measure([m, 4, 4]) -> pixels [m] by which points of things go astray with their matrices.

        Args:
            things: int [m].
            path: {tick: float64 [m, 4, 4]}.
        """
        center, half = self._scene.bounds(things)
        scale = self._per_metre(things, path)

        def measure(difference):
            middle = np.linalg.norm(np.einsum("nij,nj->ni", difference, center)[:, :3], axis=1)
            return (middle + _reach(difference, half)) * scale

        return measure

    def points(self, geometry):
        """measure([V, 3]) -> pixels [1], in the instance that shows the geometry largest."""
        things = self._scene.things_of(geometry)
        matrices = self._scene.visit.matrices[things]
        scale = self._per_metre(things, dict.fromkeys(self.views, matrices))
        stretch = np.linalg.norm(matrices[:, :3, :3], axis=1).max(axis=1)
        most = float(np.max(scale * stretch, initial=0.0))

        def measure(difference):
            return np.sqrt(np.max((difference**2).sum(axis=1), initial=0.0, keepdims=True)) * most

        return measure

    def camera(self):
        """measure([1, 4, 4]) -> pixels [1]: of what stands still, and of what is infinitely far, with
        a world_from_camera that is wrong by so much.

        To first order a camera that is wrong by D sees a point P of its own space displaced by D P.
        """
        places, view = self._probes
        return self._astray(places @ view.T)

    def view(self):
        """The same with a camera_from_world that is wrong by so much."""
        return self._astray(self._probes[0])

    def lens(self, path):
        """measure([1, 2]) -> pixels [1] by which radii of circles of confusion go astray with the
        lens's radius R and focus distance F: they are R |1 / F - 1 / z|, orthographic R |z / F - 1|.

        Args:
            path: {tick: float64 [1, 2]}.
        """
        radius = max(lens[0, 0] for lens in path.values())
        focus = min(lens[0, 1] for lens in path.values())
        depth = self._before[1][:, 2]
        if self._perspective:
            per_radius = 1.0 / min(focus, np.min(depth, initial=np.inf))
            per_focus = radius / focus**2
        else:
            farthest = np.max(depth, initial=focus)
            per_radius, per_focus = farthest / focus, radius * farthest / focus**2
        return lambda difference: np.abs(difference) @ (
            self._focal * np.array([per_radius, per_focus])
        )

    def _astray(self, probes):
        def measure(difference):
            astray = np.linalg.norm(probes @ difference[0].T, axis=1)
            return np.max(astray, initial=0.0, keepdims=True) * self._focal

        return measure

    @cached_property
    def _before(self):
        """What lies before the camera: homogeneous places in the world and in camera space, float64 [p, 4],
        the radii around them [p], and the view of which."""
        scan = self._scene.visit
        things = np.arange(0, len(scan.prototype), max(len(scan.prototype) // _MOST_PROBES, 1))
        center, half = self._scene.bounds(things)
        view = next(iter(self.views.values()))
        places = np.einsum("njk,nk->nj", scan.matrices[things], center)
        seen = places @ view.T
        reach = _reach(scan.matrices[things], half)
        kept = np.isfinite(seen).all(axis=1) & np.isfinite(reach)
        if self._perspective:
            kept &= seen[:, 2] > self._near
        return places[kept], seen[kept], reach[kept], view

    @cached_property
    def _probes(self):
        """Those places, and the outermost ones of the frame in which there is something, at the least and the
        largest of their depths.  Perspective: scaled to lie 1 m before the camera, and infinitely far, where
        the world fills the frame.  And the view.
        """
        places, seen, reach, view = self._before
        depth = seen[:, 2] if self._perspective else np.ones(len(seen))
        far = (np.abs(seen[:, :2]) + reach[:, None]) / depth[:, None]
        edges = self._frame_edges()
        extent = np.minimum(np.max(far, axis=0, initial=0.0), edges)
        depths = [seen[:, 2].min(), seen[:, 2].max()] if len(seen) else []
        if self._perspective:
            places = places / depth[:, None]
            ends = [(extent, 1.0, 1.0 / d) for d in depths] + [(edges, 1.0, 0.0)]
        else:
            ends = [(extent, d, 1.0) for d in depths]
        signs = [np.array((x, y)) for x in (-1, 1) for y in (-1, 1)]
        corners = [(*(sign * reach), z, w) for reach, z, w in ends for sign in signs]
        return np.vstack([places, np.reshape(corners, (-1, 4)) @ inverse(view).T]), view

    def _frame_edges(self):
        """How far from the view axis the frame reaches, float64 (x, y); perspective: at 1 m."""
        frame, record = self._scene.viewpoint.frame, self._scene.camera_record
        center, scale = np.array(record["center"]), np.array(record["scale"])
        return np.maximum(np.abs(center), np.abs([frame.width, frame.height] - center)) / scale

    def _per_metre(self, things, path):
        """Pixels a metre, float64 [m]; 0 for what is behind the camera all the time."""
        if not self._perspective:
            return np.full(len(things), self._focal)
        center, half = self._scene.bounds(things)
        nearest, farthest = np.full(len(things), np.inf), np.full(len(things), -np.inf)
        for tick, matrices in path.items():
            axis = self.views[tick][2] @ matrices  # depth is linear in object space
            depth = np.einsum("nj,nj->n", axis, center)
            reach = np.einsum("nj,nj->n", np.abs(axis[:, :3]), half)
            nearest = np.minimum(nearest, depth - reach)
            farthest = np.maximum(farthest, depth + reach)
        return np.where(farthest > self._near, self._focal / np.maximum(nearest, self._near), 0.0)
