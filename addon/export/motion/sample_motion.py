# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves within the shutter, with as many knots as its path wants.

Blender's time is moved, so every reference into geometry dies at each step: things are found again
by their identity (shutter_steps.py).  Time is stepped only where paths bend (motion_path.py).  The frame is restored
on every way out.
"""

from dataclasses import dataclass, field

import numpy as np

from ..base.report import poll
from ..base.updates import originals
from ..geometry.subdivision import cages_only
from ..scene.simulations import unbaked_rigid_bodies
from .animated_visibility import shown_throughout
from .appearing_instances import AppearingInstances
from .instance_velocity import InstanceVelocities
from .motion_path import (
    MAX_BEND_PIXELS,
    Tracks,
    bends_still,
    body_motions,
    finer_level,
    keep_fewest,
    no_tracks,
    shared_segments,
)
from .pixels import PixelScale
from .shutter_steps import ShutterSteps


@dataclass
class Motion:
    """Everything with the knots that it needs."""

    camera: np.ndarray  # float64 [K, 4, 4]
    lens: np.ndarray | None = None  # float64 [K, 2] radius and focus distance, metres; None: still
    tracks: Tracks = field(default_factory=no_tracks)
    points: dict = field(default_factory=dict)  # geometry index -> float32 [K, V, 3]
    energies: dict = field(default_factory=dict)  # address of an original lamp -> float32 [K]
    lifespans: tuple = ((), ())  # of ShutterSteps.lifespans


def sample_motion(clock, shutter, fps, scene, report, check_cancel):
    """Visits as many times of the shutter as the paths want, at most `shutter.segments` and one.

    The scene's visit has more things afterwards, where some appear within the shutter (appearing_instances.py), or
    come more than once: then there is one for every time.

    Args:
        clock: shutter.Clock, standing at the frame.
        shutter: shutter.Shutter with segments.
        fps: frames a second.
        scene: frame_scene.FrameScene.
        report: called with (datablock, message).
        check_cancel: true when the user has cancelled.

    Returns:
        Motion.
    """
    _report_unbaked(scene, report)
    wanted = _wanted_segments(scene)
    ticks = max(shutter.segments, wanted)
    appearing = AppearingInstances(report)
    frame_tick = round(shutter.frame_time * ticks)
    tick_frames = shutter.length / ticks
    velocities = InstanceVelocities(tick_frames / fps, report)
    steps = ShutterSteps(
        scene, frame_tick, tick_frames, report, check_cancel, appearing, velocities
    )

    def read(level_ticks):
        for tick in level_ticks:
            if tick not in steps.ticks:
                poll(check_cancel)
                clock.go(shutter.offset(tick, ticks))
                steps.read(tick, clock.knows_updates)

    with shown_throughout(scene), cages_only(scene.cages(), scene.depsgraph):
        try:
            level = _first_level(ticks)
            read(range(0, ticks + 1, ticks // level))
            finer = finer_level(level, ticks)
            while finer and (level < wanted or _bends(scene, steps, ticks // level, check_cancel)):
                read(range(0, ticks + 1, ticks // finer))
                level, finer = finer, finer_level(finer, ticks)
        finally:
            clock.go(0.0)
    motion = _result(scene, steps, ticks, level, check_cancel)
    motion.lifespans = steps.lifespans(clock.start)
    scene.come_again(steps.come_again())
    return motion


def _report_unbaked(scene, report):
    entries = {entry for prototype in scene.visit.prototypes for entry in prototype.unbaked}
    for name, simulation in sorted(entries):
        report(
            f"object '{name}'", f"its simulation '{simulation}' is not baked: its blur may be wrong"
        )
    if unbaked_rigid_bodies(scene.depsgraph.scene):
        name = scene.depsgraph.scene.name
        report(f"scene '{name}'", "its rigid bodies are not baked: their blur may be wrong")


def _wanted_segments(scene):
    """What objects ask for themselves; the scene's limit yields to it."""
    prototypes = scene.visit.prototypes
    return max(
        [scene.viewpoint.fewest_segments, *(prototype.fewest_segments for prototype in prototypes)]
    )


def _first_level(ticks):
    """Two levels at once: at three times an S, a stop half way or a turn by whole rotations may look
    straight, or still; at five they do not."""
    level = finer_level(1, ticks)
    return finer_level(level, ticks) or level


def _paths(scene, steps):
    """(key, path, checks) of the camera, its lens, places, deformations, the strength of lights.

    `path` is what is exported, {tick: array [m, ...]}.  `checks` are [(path, measure in pixels)] of what
    has to be straight.  Native code draws straight lines in camera space between the knots of camera
    and thing together, and interpolates each of the two where only the other has a knot.  So both
    have to hold by themselves, the camera as a view as well, and places as they are seen.
    """
    scale = PixelScale(scene, steps.cameras)
    cameras = {tick: steps.cameras[tick][None] for tick in sorted(steps.cameras)}
    at_frame = steps.cameras[steps.frame_tick]
    moves = scene.viewpoint.blurs and any((camera != at_frame).any() for camera in cameras.values())
    if moves:
        views = {tick: scale.views[tick][None] for tick in cameras}
        yield "CAMERA", cameras, [(cameras, scale.camera()), (views, scale.view())]
    lenses = {tick: steps.lenses[tick][None] for tick in sorted(steps.lenses)}
    if scene.viewpoint.blurs and any(
        (lens != lenses[steps.frame_tick]).any() for lens in lenses.values()
    ):
        yield "LENS", lenses, [(lenses, scale.lens(lenses))]
    numbers, things, places = steps.places()
    if len(numbers):
        measure = scale.places(things, places)
        checks = [(places, measure)]
        if moves:
            checks.append(({t: scale.views[t] @ m for t, m in places.items()}, measure))
        yield numbers, places, checks
    for index, path in steps.points().items():
        yield index, path, [(path, scale.points(index))]
    for address, path in steps.energies().items():
        yield ("ENERGY", address), path, [(path, _share_of(path))]


def _rigid_groups(visit, numbers, path):
    """What moves as one, parts of a thing that may touch: children of one topmost parent, be it an instance of their
    collection, as far as they do not move about by themselves.  Particles and what nodes scatter are alone, and so is
    what comes again.

    Args:
        visit: of the frame.
        numbers: int [m], of Runs: those below the visit's length are its things.
        path: {tick: float64 [m, 4, 4]}.

    Returns:
        int [m].
    """
    everything = originals()

    def root(prototype):
        top = everything.get(prototype.parent_address or prototype.address)
        if top is None or (prototype.parent_address and top.instance_type != "COLLECTION"):
            return 0
        while top.parent is not None:
            top = top.parent
        return top.as_pointer()

    groups = -1 - np.asarray(numbers, dtype=np.int64)
    known = np.flatnonzero(numbers < len(visit.prototype))
    prototypes, which = np.unique(visit.prototype[numbers[known]], return_inverse=True)
    roots = np.array([root(visit.prototypes[p]) for p in prototypes], dtype=np.int64)[which]
    groups[known] = np.where(roots != 0, roots, groups[known])
    bodies = np.column_stack([groups, body_motions(path)])
    return np.unique(bodies, axis=0, return_inverse=True)[1].reshape(-1)


def _share_of(path):
    """measure([1]) of energies, for the same bound: a 256th of the largest is as bad as a 32nd of a
    pixel."""
    largest = max(abs(float(energy[0])) for energy in path.values())
    return lambda difference: np.abs(difference) / largest * 256.0 * MAX_BEND_PIXELS


def _bends(scene, steps, stride, check_cancel):
    for _, _, checks in _paths(scene, steps):
        poll(check_cancel)
        if any(bends_still(path, stride, measure) for path, measure in checks):
            return True
    return False


def _result(scene, steps, ticks, level, check_cancel):
    motion = Motion(scene.camera_record["world_from_camera"])
    stride = ticks // level
    for key, path, checks in _paths(scene, steps):
        poll(check_cancel)
        segments = np.lcm.reduce([keep_fewest(p, ticks, level, measure) for p, measure in checks])
        if isinstance(key, np.ndarray):
            knots = np.stack([path[tick] for tick in range(0, ticks + 1, stride)])
            if (segments != segments[0]).any():
                segments = shared_segments(segments, _rigid_groups(scene.visit, key, path))
            motion.tracks = Tracks(key, knots, segments)
            continue
        knots = np.stack([path[t] for t in range(0, ticks + 1, ticks // int(segments[0]))])
        if isinstance(key, str):
            setattr(motion, key.lower(), knots[:, 0])
        elif isinstance(key, tuple):
            motion.energies[key[1]] = knots[:, 0].astype(np.float32)
        else:
            motion.points[key] = knots
    return motion
