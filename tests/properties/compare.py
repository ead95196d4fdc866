# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a picture has changed, and whether two engines' pictures have changed alike.

Pictures are compared in blocks of 4 by 4 pixels, so that what is left of the noise of edges (16 samples a
pixel) is that of 256 samples, and as x / (1 + |x|), so that a depth of 1e10 and a lamp of 1e3 count as much
as what is beside them.  A change counts that is larger than what other seeds make of the unchanged picture.
"""

import numpy as np

BLOCK = 4
# Half a step of 16-bit floats at .5, which textures may pass through.
ROUNDING = 2.5e-4
# Pictures of other seeds are the measure of noise: three of them, and a change must exceed the largest of
# their differences by half of it, which three of a Gauss's distribution do not in 1 of 100 cases.
SEEDS = (0, 1, 2)
MARGIN = 1.5
# Part of a change by which the other engine's may differ: direct light and filters agree within .05.
ALIKE = 0.25


def signature(passes):
    """Comparable numbers of a picture.

    Args:
        passes: {channel: float32 [h, w]}.

    Returns:
        {channel: float64 [blocks]}; NaN is a number of its own.
    """
    return {name.split(".", 1)[1]: _blocks(values) for name, values in passes.items()}


def _blocks(values):
    values = np.nan_to_num(values.astype(np.float64), nan=-1e9, posinf=1e12, neginf=-1e12)
    values = values / (1.0 + np.abs(values))
    height, width = (size - size % BLOCK for size in values.shape)
    if height == 0 or width == 0:
        return values.ravel()
    cut = values[:height, :width].reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK)
    return cut.mean(axis=(1, 3)).ravel()


def shape(picture):
    return {name: len(values) for name, values in picture.items()}


def distance(a, b):
    """Root mean square of the difference of the channel that differs most; 2 where channels or sizes differ."""
    if shape(a) != shape(b):
        return 2.0
    return max(float(np.sqrt(np.mean((a[name] - b[name]) ** 2))) for name in a)


def noise(pictures):
    """The largest distance between pictures that differ in their seed alone."""
    return max(distance(a, b) for i, a in enumerate(pictures) for b in pictures[:i])


def changed(before, after, seeds):
    """Whether a picture is another one; `seeds`: noise of the picture before."""
    return distance(before, after) > MARGIN * seeds + ROUNDING


def mismatch(before, after, other_before, other_after):
    """How much of the larger of two changes the other one lacks: 0 = alike, 1 = nothing in common.

    Channels that only one engine has from the start are left out: the unchanged picture tells of them.
    """
    if new_channels(before, after) != new_channels(other_before, other_after):
        return 1.0
    if shape(before) != shape(after):
        # New channels are compared with each other, and so is a picture of another size.
        names = [name for name in after if shape(before).get(name) != len(after[name])]
        names = [name for name in names if name in other_after]
        ours, theirs = (_joined(picture, names) for picture in (after, other_after))
        if len(ours) != len(theirs):
            return 1.0
    else:
        names = [name for name in after if name in other_after]
        ours = _joined(after, names) - _joined(before, names)
        theirs = _joined(other_after, names) - _joined(other_before, names)
    size = max(np.linalg.norm(ours), np.linalg.norm(theirs))
    return float(np.linalg.norm(ours - theirs) / size) if size else 0.0


def new_channels(before, after):
    """(channels that came, channels that went)."""
    return after.keys() - before.keys(), before.keys() - after.keys()


def _joined(picture, names):
    return np.concatenate([np.zeros(0), *(picture[name] for name in names)])
