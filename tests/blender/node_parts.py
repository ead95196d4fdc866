# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry nodes for test scenes."""

import bpy
import scene_parts


def with_nodes(thing, build, name="Nodes"):
    """Gives an object a node group that `build(nodes, links, input socket)` makes; it returns the
    geometry's socket."""
    group = bpy.data.node_groups.new(name, "GeometryNodeTree")
    if hasattr(group, "interface"):
        for in_out in ("INPUT", "OUTPUT"):
            group.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    else:
        group.inputs.new("NodeSocketGeometry", "Geometry")
        group.outputs.new("NodeSocketGeometry", "Geometry")
    start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    group.links.new(build(group.nodes, group.links, start.outputs[0]), end.inputs[0])
    thing.modifiers.new(name, "NODES").node_group = group
    return thing


def store_attribute(thing, name, kind, domain, vector):
    """Has nodes give all points, faces, ... of an object an attribute."""

    def build(nodes, links, geometry):
        store = nodes.new("GeometryNodeStoreNamedAttribute")
        store.data_type, store.domain = kind, domain
        store.inputs["Name"].default_value = name
        for socket in store.inputs:
            if socket.name == "Value" and socket.type == "VECTOR":
                socket.default_value = vector
        links.new(geometry, store.inputs["Geometry"])
        return store.outputs[0]

    return with_nodes(thing, build, "Store")


def instances_on_line(scene, part, count, host="Host"):
    """A line of points, 3 metres apart, with an instance of an object on each; the object is taken out of the
    scene.

    Returns:
        (the node group, its node with the input "Count").
    """

    def build(nodes, links, _geometry):
        info = nodes.new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = part
        info.inputs["As Instance"].default_value = True
        place = nodes.new("GeometryNodeInstanceOnPoints")
        links.new(_line(nodes, count).outputs["Mesh"], place.inputs["Points"])
        links.new(info.outputs["Geometry"], place.inputs["Instance"])
        return place.outputs["Instances"]

    thing = with_nodes(scene_parts.add_square(scene, host), build)
    hidden_collection(scene, part)
    return _group_and_line(thing)


def line_of_points(thing, count=3):
    """Makes an object consist of points in a line, 3 metres apart; returns the same."""

    def build(nodes, _links, _geometry):
        return _line(nodes, count).outputs["Mesh"]

    return _group_and_line(with_nodes(thing, build))


def _line(nodes, count):
    line = nodes.new("GeometryNodeMeshLine")
    line.name = "Line"
    line.inputs["Count"].default_value = count
    line.inputs["Offset"].default_value = (3, 0, 0)
    return line


def _group_and_line(thing):
    group = thing.modifiers["Nodes"].node_group
    return group, group.nodes["Line"]


def hidden_collection(scene, thing):
    """A collection that is in no scene, holding just this object."""
    collection = bpy.data.collections.new("Part")
    collection.objects.link(thing)
    if thing.name in scene.collection.objects:
        scene.collection.objects.unlink(thing)
    return collection
