# SPDX-License-Identifier: GPL-3.0-or-later
"""Light and shadow linking: which objects a light lights, and which cast its shadows (from Blender 4.0 on).

A light's collection says of objects INCLUDE or EXCLUDE.  With any INCLUDE these objects alone are meant, else all but
the excluded.  Of an instance the word of what instances it counts, then the object's own, as in Cycles.
"""

import numpy as np

from ..base.updates import originals

MOST_SETS = 64  # bits of a mask


def link_lights(lamps, scan, report):
    """Finds the sets of linked lights and tells the lights' records theirs.

    Args:
        lamps: of lamps.read_lamps; their records get `receiver_set` and `blocker_set`.
        scan: depsgraph.Visit.
        report: called with (datablock, message).

    Returns:
        (uint64 [prototypes] or None, uint64 [prototypes] or None): of which sets' light each is lit, and of
        which it casts shadows, a bit a set; None where that is all.
    """
    everything = originals() if lamps else {}
    found = {"receiver": {}, "blocker": {}}
    for thing, record in lamps:
        lamp = everything.get(scan.prototypes[scan.prototype[thing]].address)
        linking = getattr(lamp, "light_linking", None)
        if linking is None:
            continue
        for what, sets in found.items():
            states = _states(getattr(linking, f"{what}_collection"))
            if not states:
                continue
            number = sets.setdefault(frozenset(states.items()), len(sets))
            if number < MOST_SETS:
                record[f"{what}_set"] = number
            else:
                report(
                    f"light '{record['name']}'",
                    f"its {what} collection is not used: there are more than {MOST_SETS}",
                )
    return tuple(_masks(scan, [dict(states) for states in sets]) for sets in found.values())


def _states(collection):
    """{address of an original Object: INCLUDE or EXCLUDE}; what is said later wins, and of a child's objects
    the child's state counts."""
    states = {}
    if collection is None:
        return states
    for child, entry in zip(collection.children, collection.collection_children):
        for thing in child.all_objects:
            states[thing.as_pointer()] = entry.light_linking.link_state
    for thing, entry in zip(collection.objects, collection.collection_objects):
        states[thing.as_pointer()] = entry.light_linking.link_state
    return states


def _masks(scan, sets):
    if not sets:
        return None
    masks = np.zeros(len(scan.prototypes), dtype=np.uint64)
    for number, states in enumerate(sets[:MOST_SETS]):
        includes = "INCLUDE" in states.values()
        for index, prototype in enumerate(scan.prototypes):
            state = states.get(prototype.parent_address) or states.get(prototype.address)
            if state == "INCLUDE" or (state is None and not includes):
                masks[index] |= np.uint64(1) << np.uint64(number)
    return masks
