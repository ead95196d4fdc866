# SPDX-License-Identifier: GPL-3.0-or-later
"""Where everything is one frame before and one frame after: what the pass Vector is made of.

As in Cycles, whole frames are meant, whatever the shutter.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..geometry.subdivision import cages_only
from ..geometry.velocity import points_by_velocity
from ..scene.shutter import Shutter
from .instance_velocity import InstanceVelocities
from .shutter_steps import ShutterSteps

_TWO_FRAMES = Shutter(length=2.0, frame_time=0.5, segments=2)
_ENDS = (0, 2)


@dataclass
class AdjacentFrames:
    camera: np.ndarray  # float64 [2, 4, 4], world from camera
    things: np.ndarray  # int [m], those of the scan that move
    matrices: np.ndarray  # float64 [2, m, 4, 4]
    points: dict  # geometry index -> float32 [2, V, 3]
    again: np.ndarray  # int [c], of FrameScene

    def instances(self, instances, scan, chosen):
        """snapshot.Instances with where they are then."""
        both = np.repeat(scan.matrices[None], 2, axis=0)
        both[:, self.things] = self.matrices
        both[:, len(scan.prototype) - len(self.again) :] = both[:, self.again]
        both = both[:, chosen].swapaxes(0, 1)
        return replace(instances, adjacent=np.ascontiguousarray(both).reshape(-1, 4, 4))


def _silent(_datablock, _message):
    """What there is to say was said of the shutter."""


def read_adjacent_frames(clock, scene, fps, report, check_cancel):
    """What is adjacent to the frame at which the clock stands, and stands again afterwards.

    Args:
        clock: shutter.Clock.
        scene: frame_scene.FrameScene.
        fps: frames a second.
        report: called with (datablock, message).
        check_cancel: true when the user has cancelled.
    """
    steps = ShutterSteps(
        scene,
        _TWO_FRAMES.frame_tick,
        1.0,
        report,
        check_cancel,
        velocities=InstanceVelocities(1.0 / fps, _silent),
        rigid="its topology changes between frames: Vector holds its place's motion alone",
    )
    with cages_only(scene.cages(), scene.depsgraph):
        try:
            for tick in _ENDS:
                clock.go(_TWO_FRAMES.offset(tick))
                steps.read(tick, clock.knows_updates)
        finally:
            clock.go(0.0)
    things, _, places = steps.places()  # at three times, one of them the frame's, all have one run
    points = {
        index: np.stack([path[tick] for tick in _ENDS]) for index, path in steps.points().items()
    }
    points.update(points_by_velocity(scene.sources, _TWO_FRAMES, fps))
    return AdjacentFrames(
        camera=np.stack([steps.cameras[tick] for tick in _ENDS]),
        things=things,
        matrices=np.stack([places[tick] for tick in _ENDS]),
        points=points,
        again=scene.again,
    )
