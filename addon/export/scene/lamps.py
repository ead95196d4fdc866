# SPDX-License-Identifier: GPL-3.0-or-later
"""The lights of a frame: which ones, how strong over the shutter, where and when."""

import numpy as np

from ..base.transforms import is_finite
from ..base.updates import originals


def read_lamps(depsgraph, scan, things, images, report):
    """Records of the snapshot without their places, each lamp read once.

    Args:
        depsgraph: evaluated, at the frame.
        scan: depsgraph.Visit.
        things: of it, lights.  What is hidden at the frame, or deleted by a handler of another add-on, is left
            out.
        images: {name: record}; those that lights' nodes show are added.
        report: called with (datablock, message).

    Returns:
        [(thing, record)].
    """
    from ..shading.layer_values import set_layer_values
    from ..shading.light import light_record

    everything = originals(depsgraph) if len(things) else {}
    records, found = {}, []
    for thing in things:
        prototype = scan.prototypes[scan.prototype[thing]]
        owners = prototype.owners(everything, depsgraph)
        if owners is None or prototype.is_hidden_now(owners):
            continue
        if prototype.address not in records:
            record = light_record(owners[0], None, report, images)
            if "nodes" in record:
                set_layer_values([record], depsgraph.scene_eval, depsgraph.view_layer_eval)
            records[prototype.address] = record
        found.append((thing, dict(records[prototype.address])))
    return found


def lamp_graphs(lamps, scan):
    """{address of an original lamp: whether its record has nodes} of what read_lamps has read."""
    return {
        scan.prototypes[scan.prototype[thing]].address: "nodes" in record for thing, record in lamps
    }


def energies(depsgraph, graphs):
    """{address of an original lamp: its energy at the depsgraph's time}, of the whole file: what is not
    placed at the frame may be instanced at another time of the shutter.

    Args:
        depsgraph: evaluated.
        graphs: of lamp_graphs; lamps that are not in it are added.
    """
    import bpy

    from ..shading.light import light_energy

    if len(bpy.data.lights) == 0:
        return {}
    found = {}
    for thing in bpy.data.objects:
        if thing.type == "LIGHT":
            address = thing.as_pointer()
            lamp = thing.evaluated_get(depsgraph)
            found[address], graphs[address] = light_energy(lamp, graphs.get(address))
    return found


def place_lamps(lamps, scan, motion, report):
    """The records with their places, and with what motion says of their strength and when they exist.

    Args:
        lamps: of `read_lamps`.
        scan: depsgraph.Visit.
        motion: motion.Motion.
        report: called with (datablock, message).

    Returns:
        [(thing, record)] of those that can shine.
    """
    lives = dict(zip(*motion.lifespans))
    placed = []
    for thing, record in lamps:
        if not is_finite(scan.matrices[thing : thing + 1])[0]:
            report(f"light '{record['name']}'", "its transform is not finite: left out")
            continue
        record["world_from_light"], _ = motion.tracks.table(scan.matrices, np.array([thing]))
        address = scan.prototypes[scan.prototype[thing]].address
        if address in motion.energies:
            record["energy_knots"] = motion.energies[address]
        broken = [name for name, value in record.items() if not _is_finite(value)]
        if broken:
            what = ", ".join(broken)
            report(f"light '{record['name']}'", f"is left out: not a finite number ({what})")
            continue
        if thing in lives:
            record["lifespan"] = lives[thing]
        placed.append((thing, record))
    return placed


def _is_finite(value):
    """Whether all the numbers are that a value of a record holds."""
    values = np.asarray(value)
    return values.dtype.kind not in "fiu" or bool(np.isfinite(values).all())
