# SPDX-License-Identifier: GPL-3.0-or-later
"""The lights of a frame: which ones, how strong over the shutter, where and when."""

import numpy as np

from .changes import originals
from .transforms import is_finite


def read_lamps(depsgraph, scan, things, report):
    """Records of the snapshot without their places, each lamp read once.

    Args:
        depsgraph: evaluated, at the frame.
        scan: depsgraph.Visit.
        things: of it, lights.  What is hidden at the frame, or deleted by a handler of another add-on, is left
            out.
        report: called with (datablock, message).

    Returns:
        [(thing, record)].
    """
    from .light import light_record

    everything = originals() if len(things) else {}
    records, found = {}, []
    for thing in things:
        kind = scan.kinds[scan.kind[thing]]
        owners = kind.owners(everything, depsgraph)
        if owners is None or kind.is_hidden_now(owners):
            continue
        if kind.address not in records:
            records[kind.address] = light_record(owners[0], None, report)
        found.append((thing, dict(records[kind.address])))
    return found


def energies(depsgraph):
    """{address of an original lamp: its energy at the depsgraph's time}, of the whole file: what is not
    placed at the frame may be instanced at another time of the shutter."""
    import bpy

    from .light import light_record

    def silent(_datablock, _message):
        """What there is to say is said of those that are placed."""

    if len(bpy.data.lights) == 0:
        return {}
    return {
        thing.as_pointer(): light_record(thing.evaluated_get(depsgraph), None, silent)["energy"]
        for thing in bpy.data.objects
        if thing.type == "LIGHT"
    }


def place_lamps(lamps, scan, motion, report):
    """The records with their places, and with what motion says of their strength and when they exist.

    Args:
        lamps: of `read_lamps`.
        scan: depsgraph.Visit.
        motion: motion.Motion.
        report: called with (datablock, message).
    """
    lives = dict(zip(*motion.lifespans))
    placed = []
    for thing, record in lamps:
        if not is_finite(scan.matrices[thing : thing + 1])[0]:
            report(f"light '{record['name']}'", "its transform is not finite: left out")
            continue
        record["world_from_light"], _ = motion.tracks.table(scan.matrices, np.array([thing]))
        address = scan.kinds[scan.kind[thing]].address
        if address in motion.energies:
            record["energy_knots"] = motion.energies[address]
        if thing in lives:
            record["lifespan"] = lives[thing]
        placed.append(record)
    return placed
