# SPDX-License-Identifier: GPL-3.0-or-later
"""When instances exist that appear or vanish within the shutter, and where they would be otherwise.

Blender says at a few ticks of the shutter what is there.  Between two of them a particle knows its own
birth and death; anything else comes and goes half way.
"""

from dataclasses import dataclass

import numpy as np


@dataclass
class Life:
    """What a particle knows of itself."""

    birth: float  # frame
    death: float  # frame, the first without it
    velocity: np.ndarray  # float64 [3], metres a frame, in the world


def particle_life(owner, index, system):
    """Life of an instance that a particle makes, or None.

    Args:
        owner: evaluated Object that instances it.
        index, system: the first two of the instance's persistent id; for particles their index and that
            of their system.
    """
    systems = owner.particle_systems
    if not 0 <= system < len(systems) or not 0 <= index < len(systems[system].particles):
        return None  # a child of particles, or no particle at all
    particle = systems[system].particles[index]
    velocity = np.array(particle.velocity, dtype=np.float64) * systems[system].settings.timestep
    return Life(particle.birth_time, particle.die_time, velocity)


def runs(seen, frame):
    """Of each thing the ticks that it is seen at without a gap: around the frame's or, where it is not seen
    then, around the nearest.

    Args:
        seen: bool [T, m], at least one a column.
        frame: index of the frame's tick.

    Returns:
        (int [m] first, int [m] last).
    """
    count = len(seen)
    distance = np.where(seen, np.abs(np.arange(count) - frame)[:, None], count)
    first = distance.argmin(axis=0)
    last = first.copy()
    column = np.arange(seen.shape[1])
    for _ in range(count):
        first -= (first > 0) & seen[np.maximum(first - 1, 0), column]
        last += (last < count - 1) & seen[np.minimum(last + 1, count - 1), column]
    return first, last


def complete(path, ticks, first, last, velocity, goes_on):
    """Gives things a place where they are not: turned and scaled as when they were last seen, and going on
    along a straight line.

    Args:
        path: float64 [T, m, 4, 4], world from object; written where a tick lies outside of the run.
        ticks: ascending, of T.
        first, last: of `runs`.
        velocity: float64 [m, 3] a tick, of what is seen at one tick alone; others go as they were seen to.
        goes_on: bool [m]; false for what stays where it was.
    """
    column = np.arange(path.shape[1])
    ticks = np.asarray(ticks, dtype=np.float64)
    for end, inner in ((first, np.minimum(first + 1, last)), (last, np.maximum(last - 1, first))):
        way = path[end, column, :3, 3] - path[inner, column, :3, 3]
        time = ticks[end] - ticks[inner]
        slope = goes_on[:, None] * np.where(
            (time != 0)[:, None], way / np.where(time != 0, time, 1)[:, None], velocity
        )
        for i in range(len(ticks)):
            beyond = np.flatnonzero(i < first if end is first else i > last)
            path[i, beyond] = path[end[beyond], beyond]
            path[i, beyond, :3, 3] += slope[beyond] * (ticks[i] - ticks[end[beyond]])[:, None]


def lifespans(times, first, last, births, deaths):
    """float32 [m, 2]: each exists from the first time on and before the second one; 0 and 1 are the ends of
    the shutter.

    Args:
        times: float [T], shutter times of the ticks, ascending.
        first, last: of `runs`.
        births, deaths: float [m], shutter times; not a number = not known.
    """
    times = np.asarray(times, dtype=np.float64)
    most = len(times) - 1

    def between(before, after, own):
        low, high = times[before], times[after]
        # A particle's own time may be off by the rounding of single precision.
        near = (own >= low - 1e-5) & (own <= high + 1e-5)
        return np.where(near, np.clip(own, low, high), (low + high) / 2.0)

    found = np.empty((len(first), 2), dtype=np.float32)
    found[:, 0] = np.where(first > 0, between(np.maximum(first - 1, 0), first, births), 0.0)
    found[:, 1] = np.where(last < most, between(last, np.minimum(last + 1, most), deaths), 1.0)
    return found
