# SPDX-License-Identifier: GPL-3.0-or-later
"""Light and shadow linking: which objects a light lights, and which cast its shadows (from Blender 4.0 on).

Of a light, or a mesh that shines, a collection says of objects INCLUDE or EXCLUDE.  With any INCLUDE these objects alone
are meant, else all but the excluded.  Of an instance the word of what instances it counts, then the object's own, as
in Cycles.
"""

from dataclasses import dataclass
from typing import Optional

import numpy as np

from ..base.updates import originals

MOST_SETS = 64  # bits of a mask
ALL_SETS = 2**64 - 1


@dataclass
class LightLinks:
    """Sets of linked lights, by prototype; None = no light is linked."""

    # uint64 [prototypes], a bit a set whose light falls on it, and is shadowed by it:
    receives: Optional[np.ndarray] = None
    blocks: Optional[np.ndarray] = None
    # int32 [prototypes], the sets of its own light; -1 = everything:
    receiver_set: Optional[np.ndarray] = None
    blocker_set: Optional[np.ndarray] = None
    receives_in_volumes: int = ALL_SETS  # of the world, lit as what no collection has


def link_lights(lamps, scan, report):
    """LightLinks; tells the lights' records theirs.

    Args:
        lamps: of lamps.read_lamps; their records get `receiver_set` and `blocker_set`.
        scan: depsgraph.Visit.
        report: called with (datablock, message).
    """
    import bpy

    everything = originals() if "light_linking" in bpy.types.Object.bl_rna.properties else {}
    sets = {"receiver": {}, "blocker": {}}

    def numbers(address, label):
        """{what: number of a set} of an original Object."""
        linking = getattr(everything.get(address), "light_linking", None)
        found = {}
        for what, known in sets.items() if linking is not None else ():
            states = _states(getattr(linking, f"{what}_collection"))
            if not states:
                continue
            number = known.setdefault(frozenset(states.items()), len(known))
            if number < MOST_SETS:
                found[what] = number
            else:
                report(label, f"its {what} collection is not used: there are more than {MOST_SETS}")
        return found

    for thing, record in lamps:
        address = scan.prototypes[scan.prototype[thing]].address
        for what, number in numbers(address, f"light '{record['name']}'").items():
            record[f"{what}_set"] = number
    own = {what: np.full(len(scan.prototypes), -1, dtype=np.int32) for what in sets}
    for index, prototype in enumerate(scan.prototypes):
        if prototype.type != "LIGHT":
            for what, number in numbers(prototype.address, f"object '{prototype.name}'").items():
                own[what][index] = number
    receivers, blockers = ([dict(states) for states in known] for known in sets.values())
    return LightLinks(
        _masks(scan, receivers),
        _masks(scan, blockers),
        own["receiver"] if receivers else None,
        own["blocker"] if blockers else None,
        sum(1 << n for n, s in enumerate(receivers[:MOST_SETS]) if not _includes(s))
        if receivers
        else ALL_SETS,
    )


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


def _includes(states):
    return "INCLUDE" in states.values()


def _masks(scan, sets):
    if not sets:
        return None
    masks = np.zeros(len(scan.prototypes), dtype=np.uint64)
    for number, states in enumerate(sets[:MOST_SETS]):
        for index, prototype in enumerate(scan.prototypes):
            state = states.get(prototype.parent_address) or states.get(prototype.address)
            if state == "INCLUDE" or (state is None and not _includes(states)):
                masks[index] |= np.uint64(1) << np.uint64(number)
    return masks
