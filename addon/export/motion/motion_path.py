# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths over the shutter: how far they bend, and how few knots say them.

Between knots everything moves on straight lines in camera space (docs/architecture.md).  A path is
read at ticks, whole numbers; a chord spans `stride` ticks.  What is measured is the distance between
a tick that was read and the chord over it, in pixels.
"""

from dataclasses import dataclass

import numpy as np

# The largest distance in pixels by which a path may leave its chords.  A moving edge is then drawn
# with an error of at most a 32nd of the pixel's range a pixel of way: below the noise of 256 samples.
MAX_BEND_PIXELS = 1.0 / 32.0
# By which motions of one body may differ: of single precision in places as far out as the scene goes there is less.
_SAME_MOTION = 1e-4


def chord(path, tick, stride):
    """Where the chords of `stride` ticks are at a tick.

    Args:
        path: {tick: array}; holds the ends of the chord.
    """
    first = tick // stride * stride
    if tick == first:
        return path[tick]
    part = (tick - first) / stride
    return path[first] * (1.0 - part) + path[first + stride] * part


def bend(path, stride, measure):
    """Largest measure, over all ticks that were read, from the chords of `stride` ticks.

    Args:
        path: {tick: array [m, ...]}.
        measure: of a difference [m, ...]: pixels [m].

    Returns:
        float [m], or 0 where every tick is a knot.
    """
    worst = 0.0
    for tick, value in path.items():
        if tick % stride:
            worst = np.maximum(worst, measure(value - chord(path, tick, stride)))
    return worst


def coarser_levels(segments):
    """Numbers of segments whose knots are among those of `segments`, descending."""
    return [s for s in range(segments - 1, 0, -1) if segments % s == 0]


def finer_level(level, most):
    """The next number of segments that has all the knots of `level` and divides `most`, or None."""
    return next((s for s in range(2 * level, most + 1, level) if most % s == 0), None)


def bends_still(path, stride, measure):
    """Whether chords of `stride` ticks, which are the finest that were read, are not enough.

    Chords of twice the stride tell it: a smooth path's distance from its chords falls with the
    square of their length.
    """
    return bool(np.max(bend(path, 2 * stride, measure), initial=0.0) / 4.0 > MAX_BEND_PIXELS)


def keep_fewest(path, ticks, level, measure):
    """For each of m paths the smallest number of segments that holds it.

    Args:
        path: {tick: array [m, ...]}, read at all knots of `level` at least.
        ticks: in the whole shutter.
        level: segments that were read.
        measure: as of `bend`; its result has one entry a path.

    Returns:
        int array, each a divisor of `level`.
    """
    segments = None
    for s in coarser_levels(level):
        fits = bend(path, ticks // s, measure) <= MAX_BEND_PIXELS
        segments = np.full(np.shape(fits), level) if segments is None else segments
        segments[fits] = s
    return segments


def body_motions(path):
    """Whole numbers, the same for all parts of one body: what takes them from the first tick to the last.

    Args:
        path: {tick: float64 [m, 4, 4]}, affine.

    Returns:
        int64 [m, 12].
    """
    first, last = path[min(path)], path[max(path)]
    x, y, z = (first[:, :3, column] for column in range(3))
    inverse = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=1)
    with np.errstate(all="ignore"):  # of what has no volume
        inverse /= np.einsum("ni,ni->n", x, inverse[:, 0])[:, None, None]
        turn = last[:, :3, :3] @ inverse
        shift = last[:, :3, 3] - np.einsum("nij,nj->ni", turn, first[:, :3, 3])
        shift /= 1.0 + np.abs(first[:, :3, 3]).max(initial=0.0)
        steps = np.rint(np.concatenate([turn.reshape(-1, 9), shift], axis=1) / _SAME_MOTION)
    steps[~(np.abs(steps) < 1e15)] = 0.0
    return steps.astype(np.int64)


def shared_segments(segments, groups):
    """As many for each thing as all of its group need: by chords of their own, walls of a house that turns would come
    apart, and let light in.

    Args:
        segments: int [m], each a divisor of one number.
        groups: int [m].

    Returns:
        int [m].
    """
    order = np.argsort(groups, kind="stable")
    first = np.flatnonzero(np.diff(groups[order], prepend=groups[order[0]] - 1))
    shared = np.empty_like(segments)
    counts = np.diff(first, append=len(groups))
    shared[order] = np.repeat(np.lcm.reduceat(segments[order], first), counts)
    return shared


@dataclass
class Tracks:
    """Places of the m things that move, at equidistant knots."""

    things: np.ndarray  # int [m], ascending
    matrices: np.ndarray  # float64 [K, m, 4, 4]
    segments: np.ndarray  # int [m], of the path that is kept; each divides K - 1

    def table(self, at_frame, chosen):
        """All matrices of chosen things in one table, thing after thing; what stands has one.

        Args:
            at_frame: float64 [n, 4, 4], of all things.
            chosen: int [c], which of the n.

        Returns:
            (float64 [sum of knots, 4, 4], int32 [c] knots).
        """
        segments = np.zeros(len(at_frame), dtype=np.int32)
        segments[self.things] = self.segments
        row = np.zeros(len(at_frame), dtype=int)
        row[self.things] = np.arange(len(self.things))
        kept = segments[chosen]
        knots = kept + 1
        first = np.cumsum(knots) - knots
        table = at_frame[np.repeat(chosen, knots)]
        most = len(self.matrices) - 1
        for s in np.unique(kept[kept > 0]):
            these = kept == s
            rows = row[chosen[these]]
            for knot in range(s + 1):
                table[first[these] + knot] = self.matrices[knot * (most // s), rows]
        return table, knots


def no_tracks():
    """Nothing moves."""
    return Tracks(np.zeros(0, dtype=int), np.zeros((1, 0, 4, 4)), np.zeros(0, dtype=int))
