# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys of animated things, the same in every Blender."""


def fcurves_of(thing):
    """Of its action, which has layers since Blender 4.4 and nothing else since 5."""
    action = thing.animation_data.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    return action.layers[0].strips[0].channelbag(thing.animation_data.action_slot).fcurves


def make_linear(thing):
    """Its keys, from one to the next."""
    for curve in fcurves_of(thing):
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
