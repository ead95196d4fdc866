# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown at the frame is shown for the whole shutter, moving.

Blender does not evaluate what is hidden in renders: at the times at which an animation hides an object it stays where
it was seen last.  So the animation of the visibility rests while time is stepped.  It rests in the copies that the
depsgraph evaluates, which belong to the render alone; `foreach_set` is used because it runs no update callback.
"""

from contextlib import contextmanager

import numpy as np

from ..base.updates import originals

_PATH = "hide_render"


@contextmanager
def shown_throughout(scene):
    """While time is stepped: nothing hides what the frame shows.

    Args:
        scene: frame_scene.FrameScene.
    """
    shown = set()
    for prototype in scene.visit.prototypes:
        shown |= {prototype.address, prototype.parent_address} - prototype.hidden
    resting = []
    try:
        for address, thing in originals().items():
            if address not in shown or thing.animation_data is None:
                continue
            for number, curves in enumerate(_curves(thing.evaluated_get(scene.depsgraph))):
                curve = curves.find(_PATH)
                if curve is None or curve.mute:
                    continue
                flags = np.zeros(len(curves), dtype=np.bool_)
                curves.foreach_get("mute", flags)
                resting.append((address, number, flags.copy()))
                flags[[i for i, other in enumerate(curves) if other.data_path == _PATH]] = True
                curves.foreach_set("mute", flags)
        yield
    finally:
        # Found anew: a handler of another add-on may have deleted or replaced them meanwhile.
        everything = originals() if resting else {}
        for address, number, flags in resting:
            if address in everything:
                found = _curves(everything[address].evaluated_get(scene.depsgraph))
                if number < len(found) and len(found[number]) == len(flags):
                    found[number].foreach_set("mute", flags)


def _curves(evaluated):
    """The collections of F-curves that move an evaluated Object: its action's, those of its strips, its drivers'."""
    data = evaluated.animation_data
    if data is None:
        return []
    actions = [(data.action, getattr(data, "action_slot", None))]
    for track in data.nla_tracks:
        actions += [(strip.action, getattr(strip, "action_slot", None)) for strip in track.strips]
    return [*(c for action, slot in actions for c in _curves_of(action, slot)), data.drivers]


def _curves_of(action, slot):
    if action is None:
        return []
    if not hasattr(action, "layers"):  # Blender 4.4 brought them
        return [action.fcurves]
    if slot is None:
        return []
    bags = [strip.channelbag(slot) for layer in action.layers for strip in layer.strips]
    return [bag.fcurves for bag in bags if bag is not None]
