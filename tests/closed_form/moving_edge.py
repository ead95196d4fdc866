# SPDX-License-Identifier: GPL-3.0-or-later
"""An edge that moves right under a box filter of one pixel, in closed form (case 10 of docs/hard_cases.md)."""

import numpy as np
import snapshots as s


def ramp(e):
    """Integral of the unit box's edge response: 0, e^2/2, e - 1/2."""
    return np.where(e < 0, 0, np.where(e > 1, e - 0.5, 0.5 * e * e))


def add_moving_edge(snapshot, width, speed):
    """Covers what is left of 12.3 pixels, and `speed` more when the shutter closes.

    Returns the alpha of a row of `width` pixels: (G(e0 + v) - G(e0)) / v with e0 = edge minus the pixel's left side
    at t = 0.
    """
    edge = 12.3
    s.quad(
        snapshot,
        s.rectangle(-200, -50, edge, 70),
        s.emission(snapshot),
        transforms=[s.translation(0), s.translation(speed)],
    )
    e0 = edge - np.arange(width)
    return (ramp(e0 + speed) - ramp(e0)) / speed
