# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen of whole scenes, against Cycles.

Only coverage (alpha) is compared, in blocks of 8 by 8 pixels.  Both renderers take 64 samples a
pixel; where every pixel of a block is half covered, a block's mean is off by .5 / 64 = .008, the
difference of two by .011, if samples were independent (stratified ones do better).
"""

import numpy as np
from motion_parts import open_shutter

SAMPLES = 64
BLOCK = 8
LIMIT = 0.011


def coverage(scene, render, engine):
    """float32 [blocks up, blocks across]: mean alpha."""
    scene.render.engine = engine
    passes = render(scene, engine)
    alpha = next(values for key, values in passes.items() if key.endswith("Combined.A"))
    height, width = alpha.shape
    return alpha.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK).mean(axis=(1, 3))


def blurred(scene):
    """The scene at frame 10, its shutter a frame about it."""
    scene.render.film_transparent = True
    return open_shutter(scene, 1.0)


def expect_coverage_of_cycles(scene, render, least=0.02):
    """`least`: of the frame that is covered."""
    # Cycles places knots at 2^steps + 1 times; as many are ours.
    for thing in scene.objects:
        thing.cycles.motion_steps = 3
    scene.granita.motion_steps = 9
    scene.granita.samples = SAMPLES
    scene.granita.pixel_filter, scene.granita.filter_width = "BOX", 1.0
    scene.cycles.samples = SAMPLES
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1.0
    ours, theirs = coverage(scene, render, "GRANITA"), coverage(scene, render, "CYCLES")
    assert least < ours.mean() < 0.98
    difference = ours - theirs
    assert np.sqrt((difference**2).mean()) < LIMIT, difference.round(3)
    assert abs(difference).max() < 4 * LIMIT, difference.round(3)
