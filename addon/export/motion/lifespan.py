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


@dataclass
class Runs:
    """Stretches of ticks during which things are there without a gap."""

    things: np.ndarray  # int [r]
    numbers: (
        np.ndarray
    )  # int [r], ascending: that of the thing, or a new one for all its runs but one
    first: np.ndarray  # int [r], index of the tick
    last: np.ndarray  # int [r]


def runs(things, seen, frame, stays, next_number):
    """All Runs.  A thing keeps its number for the one around the frame's tick, or for the nearest.

    Args:
        things: int [m], ascending.
        seen: bool [T, m], at least one a column.
        frame: index of the frame's tick.
        stays: bool [m]; what is there throughout, seen or not, has one run.
        next_number: of the first run that needs a new one.
    """
    edges = np.diff(np.pad(seen, ((1, 1), (0, 0))).astype(np.int8), axis=0).T
    column, first = np.nonzero(edges == 1)
    last = np.nonzero(edges == -1)[1] - 1
    order = np.lexsort((np.maximum(first - frame, frame - last).clip(0), column))
    column, first, last = column[order], first[order], last[order]
    again = np.zeros(len(column), dtype=bool)
    again[1:] = column[1:] == column[:-1]
    main, more = np.flatnonzero(~again), np.flatnonzero(again & ~stays[column])
    kept = np.append(main, more)
    numbers = np.append(things, next_number + np.arange(len(more)))
    return Runs(things[column[kept]], numbers, first[kept], last[kept])


def complete(path, ticks, first, last, velocity, goes_on):
    """Gives things a place where they are not: turned and scaled as when they were last seen, and going on
    along a straight line.

    Args:
        path: float64 [T, m, 4, 4], world from object; written where a tick lies outside of its run.
        ticks: ascending, of T.
        first, last: of Runs.
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
        first, last: of Runs.
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
