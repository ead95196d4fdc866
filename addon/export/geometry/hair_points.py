# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of particle hair, one a call (.4 microseconds): there is no faster way through Blender's interface."""

from dataclasses import dataclass
from functools import cached_property
from itertools import chain, product

import numpy as np

from ..base.transforms import from_matrix, inverse, volume
from .elements import Elements
from .hair_width import hair_radii, widths

# Children come out a little different wherever their emitter stands: of 13,608 on a head that turns, one
# in a hundred by 2^-19 to 2^-11 of the head's size.  Fewer than one in twenty, none farther than this:
_NOISE, _MOST_NOISE, _NOISY = 2.0**-16, 2.0**-10, 0.05
# About as many hairs are asked, evenly, each for its tip and for one point more, from hair to hair the next:
# whatever bends hair bends many and shows at most tips, but children that meet there may bend in between.
_ASKED = 1024


@dataclass(frozen=True)
class HairPoints(Elements):
    """Hair that goes along with its emitter is read once: some tell whether it does."""

    points: np.ndarray  # float32 [V, 3] at the frame
    widths: tuple  # hair_width.widths at the frame
    swells: bool  # these may be others at other times
    name: str  # of the particle system
    mode: str  # of the depsgraph

    def points_again(self, thing, data):
        return self.points if self._goes_along(thing) else super().points_again(thing, data)

    def with_radii(self, points, thing):
        """float32 [V, 3] at another time, or [V, 4] where radii are not the frame's then.

        They are settings, whose changes no update of the depsgraph names as one of geometry.
        """
        system = thing.particle_systems.get(self.name)
        if system is None or widths(system.settings) == self.widths:
            return points
        radii = hair_radii(system.settings, points.reshape(len(self.sizes), -1, 3))
        return np.hstack([points, radii.reshape(-1, 1)])

    def _goes_along(self, thing):
        system = thing.particle_systems.get(self.name)
        if system is None or len(self.sizes) == 0:
            return False
        first, last = particle_range(system, self.mode)
        steps = step_count(system.settings, self.mode)
        if (self.sizes != steps).any() or last - first != len(self.sizes):
            return False
        pairs, at_frame = self._asked
        now = _world(system, thing, first, pairs, len(pairs))
        place = from_matrix(thing.matrix_world)
        here = at_frame @ place[:3, :3].T
        off = np.linalg.norm(now - place[:3, 3] - here, axis=1)
        off[~now.any(axis=1)] = 0.0  # what ends early
        off = off.reshape(-1, 2).max(axis=1)
        # Blender's own coordinates are of the world, in single precision.
        rounding = 2.0**-20 * np.abs(now).max()
        size = np.abs(here).max()
        # Written so that what is not a number does not go along.
        return (
            np.count_nonzero(~(off <= _NOISE * size + rounding)) <= _NOISY * len(off)
            and (off <= _MOST_NOISE * size + rounding).all()
        )

    @cached_property
    def _asked(self):
        """What is asked: ([(hair, its point)], float32 [2 n, 3] where these are at the frame)."""
        count, steps = len(self.sizes), int(self.sizes[0])
        hairs = np.arange(0, count, max(1, count // _ASKED))
        others = np.arange(len(hairs)) % (steps - 1)
        points = np.stack([np.full(len(hairs), steps - 1), others], axis=1).ravel()
        hairs = np.repeat(hairs, 2)
        at_frame = self.points.reshape(-1, steps, 3)[hairs, points]
        return list(zip(hairs.tolist(), points.tolist())), at_frame


def particle_range(system, mode):
    """(first particle, one past the last): children replace their parents."""
    parents, children = len(system.particles), len(system.child_particles)
    if mode != "RENDER":
        children = children * system.settings.display_percentage // 100
    if system.settings.child_type == "NONE" or children == 0:
        return 0, parents
    return parents, parents + children


def step_count(settings, mode):
    """Points of every hair."""
    steps = (1 << (settings.render_step if mode == "RENDER" else settings.display_step)) + 1
    return steps + (settings.kink_extra_steps if settings.kink == "SPIRAL" else 0)


def read_hair_points(thing, _data, name, mode):
    """(float32 [V, 3] in the object's space, int32 [hairs] sizes) of an evaluated Object's system."""
    system = thing.particle_systems.get(name)
    if system is None:
        return np.zeros((0, 3), dtype=np.float32), np.zeros(0, dtype=np.int32)
    first, last = particle_range(system, mode)
    steps = step_count(system.settings, mode)
    every = product(range(last - first), range(steps))
    hairs = _world(system, thing, first, every, (last - first) * steps).reshape(-1, steps, 3)
    # What ends early goes on in the world's origin: it stays where it was.
    for step in range(1, steps):
        ended = (hairs[:, step] == 0.0).all(axis=1)
        hairs[ended, step] = hairs[ended, step - 1]
    points = _from_world(hairs.reshape(-1, 3), thing).astype(np.float32)
    return points, np.full(last - first, steps, dtype=np.int32)


def _world(system, thing, first, points, count):
    """float64 [count, 3] of pairs (hair, step), the first hair being that particle."""
    co_hair = system.co_hair
    found = (co_hair(thing, particle_no=first + hair, step=step) for hair, step in points)
    return flat_floats(found, 3 * count).reshape(-1, 3)


def flat_floats(vectors, count):
    """float64 [count] of Blender's vectors, one after the other.

    Python takes them apart: as rows of an array, which NumPy reads, each costs 1.3 microseconds more.
    """
    return np.fromiter(chain.from_iterable(vectors), np.float64, count)


def _from_world(points, thing):
    """float64 [n, 3] in the object's space, where it has a volume."""
    matrix = from_matrix(thing.matrix_world)
    if volume(matrix) == 0.0:
        return points
    from_world = inverse(matrix)
    return points @ from_world[:3, :3].T + from_world[:3, 3]
