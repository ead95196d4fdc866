# SPDX-License-Identifier: GPL-3.0-or-later
"""How wide particle hair is."""

import numpy as np


def widths(settings):
    """What of ParticleSettings radii are made of: equal where they are."""
    names = "radius_scale", "root_radius", "tip_radius", "shape", "use_close_tip"
    return tuple(getattr(settings, name) for name in names)


def hair_radii(settings, hairs):
    """float32 [n, steps], metres; Cycles' shape over the length.  Blender's root and tip are diameters.

    Args:
        hairs: float32 [n, steps, 3].
    """
    lengths = np.linalg.norm(np.diff(hairs, axis=1), axis=2)
    along = np.zeros(hairs.shape[:2])
    np.cumsum(lengths, axis=1, out=along[:, 1:])
    whole = along[:, -1:]
    rest = 1.0 - np.divide(along, whole, out=np.zeros_like(along), where=whole > 0.0)
    shape = settings.shape
    if shape < 0.0:
        rest = rest ** (1.0 + shape)
    elif shape > 0.0:
        rest = rest ** (1.0 / max(1.0 - shape, 1e-6))
    root, tip = (
        0.5 * settings.radius_scale * d for d in (settings.root_radius, settings.tip_radius)
    )
    radius = rest * (root - tip) + tip
    if settings.use_close_tip:
        radius[:, -1] = 0.0
    return radius.astype(np.float32)
