# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes for test scenes."""

import bpy
import scene_parts


def instances_on_line(scene, part, count, host="Host"):
    """A line of points, 3 metres apart, with an instance of an object on each; the object is taken out of the
    scene.

    Returns:
        (the node group, its node with the input "Count").
    """
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    line = tree.nodes.new("GeometryNodeMeshLine")
    line.inputs["Count"].default_value = count
    line.inputs["Offset"].default_value = (3, 0, 0)
    info = tree.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = part
    info.inputs["As Instance"].default_value = True
    place = tree.nodes.new("GeometryNodeInstanceOnPoints")
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(line.outputs["Mesh"], place.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], place.inputs["Instance"])
    tree.links.new(place.outputs["Instances"], output.inputs[0])
    scene_parts.add_square(scene, host).modifiers.new("Nodes", "NODES").node_group = tree
    hidden_collection(scene, part)
    return tree, line


def hidden_collection(scene, thing):
    """A collection that is in no scene, holding just this object."""
    collection = bpy.data.collections.new("Part")
    collection.objects.link(thing)
    if thing.name in scene.collection.objects:
        scene.collection.objects.unlink(thing)
    return collection
