# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene at the knots of the shutter: where things are, and how meshes are deformed.

Blender's time is moved, so every reference into geometry dies at each step: things are found again
by their identity.  What a step did not touch (`depsgraph.updates`) is not read again.  The frame is
restored on every path.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from .camera import camera_matrix
from .depsgraph import visit
from .mesh import read_points, read_topology
from .report import poll
from .subdivision import cage_mesh, cages_only
from .transforms import is_finite


@dataclass
class Motion:
    """K knots of the shutter."""

    camera: np.ndarray  # float64 [K, 4, 4]
    matrices: np.ndarray  # float64 [K, things of the frame's visit, 4, 4]
    points: dict = field(default_factory=dict)  # geometry index -> float32 [K, V, 3]


class Clock:
    """Moves Blender's time.  Inside a render the engine does it; in a script, the scene."""

    def __init__(self, engine, scene):
        self._step = engine.frame_set if engine is not None else self._scene_step
        self._scene = scene
        # Read back after a step to a negative time, frame and subframe are no longer floor and
        # remainder: their sum is always right.
        self.start = scene.frame_current + scene.frame_subframe
        # A script's frame_set clears the list of updates before it returns.
        self.knows_updates = engine is not None

    def go(self, offset):
        """To `offset` frames after the start; `frame_set` wants a subframe in [0, 1)."""
        self._step(*split_time(self.start + offset))

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


def sample_motion(clock, shutter, depsgraph, camera, frame_visit, geometries, report, check_cancel):
    """Visits every knot but the frame's own.

    Args:
        clock: Clock, standing at the frame.
        shutter: options.Shutter with more than one knot.
        depsgraph: evaluated at the frame, and again on return.
        camera: original camera object.
        frame_visit: depsgraph.Visit at the frame.
        geometries: list of geometry.GeometrySource, in the order of the snapshot.
        report: called with (datablock, message).
        check_cancel: true when the user has cancelled.

    Returns:
        Motion.
    """
    sampler = _Sampler(shutter, depsgraph, camera, frame_visit, geometries, report, check_cancel)
    cages = {kind.source.as_pointer(): kind for kind in frame_visit.kinds if kind.cage is not None}
    with cages_only([(kind.source, kind.cage) for kind in cages.values()], depsgraph):
        try:
            for knot, offset in enumerate(shutter.offsets):
                if knot == shutter.frame_knot:
                    continue
                poll(check_cancel)
                clock.go(offset)
                sampler.sample(knot, clock.knows_updates)
        finally:
            clock.go(0.0)
    return sampler.result()


class _Sampler:
    def __init__(self, shutter, depsgraph, camera, frame_visit, geometries, report, check_cancel):
        knots = len(shutter.offsets)
        self._shutter = shutter
        self._depsgraph = depsgraph
        self._camera = camera
        self._visit = frame_visit
        self._geometries = geometries
        self._report = report
        self._check_cancel = check_cancel
        self._changed = set()
        self._rigid = set()
        self._order = np.argsort(frame_visit.identity)
        self._cameras = [None] * knots
        self._cameras[shutter.frame_knot] = camera_matrix(camera, depsgraph)
        self._matrices = np.empty((knots, *frame_visit.matrices.shape))
        self._present = np.zeros((knots, len(frame_visit.kind)), dtype=bool)
        self._matrices[shutter.frame_knot] = frame_visit.matrices
        self._present[shutter.frame_knot] = True
        self._still = still_kinds(frame_visit.kinds)
        self._points = {}
        self._last = shutter.frame_knot

    def sample(self, knot, knows_updates):
        """Reads the scene, which stands at the knot's time."""
        if knows_updates:
            if not moved(self._depsgraph):
                # As it was at the last time that was visited, the frame's at first.
                self._repeat(knot)
                return
            self._changed |= changed_geometry(self._depsgraph)
        self._last = knot
        self._cameras[knot] = camera_matrix(self._camera, self._depsgraph)
        now = visit(self._depsgraph, _silent, self._check_cancel, self._visit.cages)
        here, there = match(self._visit.identity, self._order, now.identity)
        usable = is_finite(now.matrices[there])
        here, there = here[usable], there[usable]
        self._matrices[knot, here] = now.matrices[there]
        self._present[knot, here] = True
        place = np.full(len(self._visit.kind), -1)
        place[here] = there
        for index, source in enumerate(self._geometries):
            poll(self._check_cancel)
            thing = place[source.example]
            if thing < 0 or index in self._rigid or not source.deforms:
                continue
            if knows_updates and not self._changed & source.pointers:
                continue
            self._read_points(knot, index, source, now.kinds[now.kind[thing]])

    def _repeat(self, knot):
        self._cameras[knot] = self._cameras[self._last]
        self._matrices[knot] = self._matrices[self._last]
        self._present[knot] = self._present[self._last]
        for points in self._points.values():
            points[knot] = points[self._last]

    def _read_points(self, knot, index, source, kind):
        if (kind.cage is None) != (source.cage is None):
            points = None
        elif kind.cage is None:
            points = _matching_points(kind.data, source.topology)
        else:
            with cage_mesh(kind.source, kind.cage, self._depsgraph) as mesh:
                points = _matching_points(mesh, source.topology)
        if points is None:
            self._rigid.add(index)
            self._points.pop(index, None)
            self._report(
                source.geometry.name,
                "its topology changes within the shutter: rendered without deformation blur",
            )
            return
        at_frame = source.geometry.points[0]
        broken = ~(np.isfinite(points).all(axis=1))
        points[broken] = at_frame[broken]
        if index not in self._points:
            self._points[index] = [None] * len(self._shutter.offsets)
        self._points[index][knot] = points

    def result(self):
        frame_knot = self._shutter.frame_knot
        for order in hold_order(len(self._cameras), frame_knot):
            knot, nearer = order
            if self._cameras[knot] is None:
                self._cameras[knot] = self._cameras[nearer]
            absent = ~self._present[knot]
            self._matrices[knot, absent] = self._matrices[nearer, absent]
        self._matrices[:, self._still[self._visit.kind]] = self._visit.matrices[
            self._still[self._visit.kind]
        ]
        if not blurs(self._camera):
            self._cameras = [self._cameras[frame_knot]] * len(self._cameras)
        motion = Motion(np.array(self._cameras), self._matrices)
        for index, knots in self._points.items():
            at_frame = self._geometries[index].geometry.points[0]
            knots[frame_knot] = at_frame
            for knot, nearer in hold_order(len(knots), frame_knot):
                if knots[knot] is None:
                    knots[knot] = knots[nearer]
            if any(not np.array_equal(points, at_frame) for points in knots):
                motion.points[index] = np.stack(knots)
        return motion


def moved(depsgraph):
    """Whether the last step touched any place or geometry."""
    return any(
        update.is_updated_transform or update.is_updated_geometry for update in depsgraph.updates
    )


def changed_geometry(depsgraph):
    """Addresses of the original datablocks whose geometry the last step touched."""
    return {
        update.id.original.as_pointer()
        for update in depsgraph.updates
        if update.is_updated_geometry
    }


def blurs(thing):
    """Whether an object has motion blur at all; a switch of Cycles', where it is enabled."""
    return getattr(getattr(thing, "cycles", None), "use_motion_blur", True)


def still_kinds(kinds):
    """bool [kinds]: objects whose motion blur is switched off, by themselves or their instancer."""
    return np.array(
        [
            not blurs(kind.source) or (kind.parent is not None and not blurs(kind.parent))
            for kind in kinds
        ],
        dtype=bool,
    )


def match(identity, order, now):
    """Pairs of equal identities.

    Args:
        identity: uint64 [n], unique.
        order: argsort of it.
        now: uint64 [m], unique.

    Returns:
        (int [p] indices in `identity`, int [p] indices in `now`).
    """
    if len(identity) == 0 or len(now) == 0:
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
    place = np.minimum(np.searchsorted(identity, now, sorter=order), len(identity) - 1)
    here = order[place]
    there = np.flatnonzero(identity[here] == now)
    return here[there], there


def hold_order(knots, frame_knot):
    """(knot, its neighbour towards the frame) pairs, from the frame outwards."""
    later = [(k, k - 1) for k in range(frame_knot + 1, knots)]
    return later + [(k, k + 1) for k in range(frame_knot - 1, -1, -1)]


def _matching_points(mesh, topology):
    """float32 [V, 3], or None where the mesh is not the frame's any more."""
    if len(mesh.vertices) != topology.vertex_count or len(mesh.loops) != len(topology.corner_verts):
        return None
    return read_points(mesh) if read_topology(mesh).matches(topology) else None


def _silent(_datablock, _message):
    """What a walk has to say was said at the frame."""
