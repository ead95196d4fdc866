# SPDX-License-Identifier: GPL-3.0-or-later
"""How a view's picture comes: coarse and at once, then as it is meant.

Samples cost little beside dicing and shading, so what the first picture saves is pixels: it is smaller, its
micropolygons as large in its own pixels, its lights asked by few rays and no sample shaded by itself.
"""

from dataclasses import dataclass

import numpy as np

from .live_picture import coarse_crop

LEAST_DIVISOR, MOST_DIVISOR = 2, 8
# Seconds that the first picture may take before the next is made of fewer pixels, or of more.
_SLOW, _FAST = 0.1, 0.025

_COARSE = {"samples": 4, "light_samples": 2}


@dataclass(frozen=True)
class Stage:
    divisor: int  # pixels of the view that one of its pixels is wide; 1 = as it is meant

    @property
    def is_last(self):
        return self.divisor == 1

    def snapshot(self, snapshot):
        """The snapshot of this stage; shares all that is large."""
        if self.is_last:
            return snapshot
        options, camera, divisor = dict(snapshot["options"]), dict(snapshot["camera"]), self.divisor
        for name, most in _COARSE.items():
            options[name] = min(options[name], most)
        options["refine_samples"], options["noise_threshold"] = False, 0.0
        options["width"] = -(-options["width"] // divisor)
        options["height"] = -(-options["height"] // divisor)
        crop = coarse_crop([int(pixel) for pixel in options["crop"]], divisor)
        options["crop"] = np.array(crop, dtype=np.int32)
        camera["scale"] = tuple(value / divisor for value in camera["scale"])
        camera["center"] = tuple(value / divisor for value in camera["center"])
        return {**snapshot, "options": options, "camera": camera}


def next_divisor(divisor, seconds, is_anew=True):
    """Of the next first picture, where this one took so long.  What was not made anew, but of what is kept of the
    picture before, tells nothing of one of another size, which is."""
    if seconds > _SLOW:
        return min(divisor * 2, MOST_DIVISOR)
    if seconds < _FAST and is_anew:
        return max(divisor // 2, LEAST_DIVISOR)
    return divisor
