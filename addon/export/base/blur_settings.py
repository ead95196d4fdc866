# SPDX-License-Identifier: GPL-3.0-or-later
"""What an object says about its own motion blur: Cycles' settings where its add-on is enabled, else
Granita's, which have the same names and meaning."""


def _settings(thing):
    return getattr(thing, "cycles", None) or getattr(thing, "granita", None)


def blurs(thing):
    """Whether an object has motion blur at all."""
    return getattr(_settings(thing), "use_motion_blur", True)


def deforms(thing):
    """Whether the deformation of an object is blurred."""
    return blurs(thing) and getattr(_settings(thing), "use_deform_motion", True)


def fewest_segments(thing):
    """Segments at which an object's path is read at least: 2 to the power of its motion steps."""
    return 2 ** min(max(getattr(_settings(thing), "motion_steps", 1), 0), 7) if blurs(thing) else 1
