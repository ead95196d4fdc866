# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as a node graph (docs/scene_snapshot.md)."""

from .inlined_tree import inlined
from .nodes import FlatGraph


def world_of(scene, view_layer):
    """The World of a view layer, or None.  From Blender 4.2 on it may have its own."""
    return getattr(view_layer, "world_override", None) or scene.world


# The types of rays that a World can be hidden from.
RAY_TYPES = ("camera", "diffuse", "glossy", "transmission", "scatter")


def ray_visibility(world):
    """{"visible_camera": bool, ...}: to which rays a World shows itself.  Cycles' add-on brings the switches."""
    visibility = getattr(world, "cycles_visibility", None)
    seen = {f"visible_{name}": bool(getattr(visibility, name, True)) for name in RAY_TYPES}
    return {**seen, "visible_volume": seen.pop("visible_scatter")}


def export_world(scene, view_layer, report, images=None):
    """The snapshot's `world`.

    Args:
        scene: evaluated Scene.
        view_layer: evaluated ViewLayer.
        report: called with (datablock, message).
        images: list of image records to which those of the world are added.

    Returns:
        dict; black where the scene has no world, or the view layer no sky.
    """
    world = world_of(scene, view_layer)
    record = {"nodes": [], "surface": None, "displacement": None}
    record["lights_scene"] = world is not None and bool(view_layer.use_sky)
    if not record["lights_scene"]:
        return {**record, "name": ""}
    record["name"] = world.name_full
    owner = f"world '{world.name_full}'"
    record.update(ray_visibility(world))
    cycles = getattr(world, "cycles", None)
    # What Cycles does not sample its limit does not end: it is met by rays alone.
    is_sampled = getattr(cycles, "sampling_method", "AUTOMATIC") != "NONE"
    record["most_bounces"] = getattr(cycles, "max_bounces", 1024) if is_sampled else 1024
    if not world.use_nodes or world.node_tree is None:
        node = {
            "type": "ShaderNodeBackground",
            "name": "Color",
            "inputs": {"Color": (*world.color, 1.0), "Strength": 1.0},
            "properties": {},
        }
        return {**record, "nodes": [node], "surface": (0, "Background")}
    shown = {}
    read = inlined(world)
    graph = FlatGraph(read.node_tree, owner, shown, report)
    record["surface"] = graph.add_output("Surface")
    record["volume"] = graph.add_output("Volume")
    if images is not None:
        known = {image["name"] for image in images}
        images.extend(image for image in shown.values() if image["name"] not in known)
    return {**record, "nodes": graph.nodes}
