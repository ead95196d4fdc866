# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as a node graph (docs/scene_snapshot.md)."""

from .nodes import FlatGraph


def export_world(scene, view_layer, report, images=None):
    """The snapshot's `world`.

    Args:
        scene: evaluated Scene.
        view_layer: evaluated ViewLayer; with its sky off, Cycles drops the world's light as well.
        report: called with (datablock, message).
        images: list of image records to which those of the world are added.

    Returns:
        dict; black where the scene has no world.
    """
    world = scene.world
    record = {"nodes": [], "surface": None, "displacement": None}
    record["lights_scene"] = bool(view_layer.use_sky)
    if world is None:
        return {**record, "name": ""}
    record["name"] = world.name_full
    if not world.use_nodes or world.node_tree is None:
        node = {
            "type": "ShaderNodeBackground",
            "name": "Color",
            "inputs": {"Color": (*world.color, 1.0), "Strength": 1.0},
            "properties": {},
        }
        return {**record, "nodes": [node], "surface": (0, "Background")}
    owner = f"world '{world.name_full}'"
    shown = {}
    graph = FlatGraph(world.node_tree, owner, shown, report)
    output = world.node_tree.get_output_node("CYCLES")
    if output is not None:
        record["surface"] = graph.add(output.inputs["Surface"])
        if output.inputs["Volume"].is_linked:
            report(owner, "its volume is not rendered")
    if images is not None:
        known = {image["name"] for image in images}
        images.extend(image for image in shown.values() if image["name"] not in known)
    return {**record, "nodes": graph.nodes}
