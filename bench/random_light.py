# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps and worlds by chance.  Runs inside Blender."""

import bpy
from mathutils import Vector
from random_materials import Graph
from random_patterns import color, image


def nodes_of(owner):
    """The tree of a lamp or world, and the node that sends."""
    owner.use_nodes = True
    kinds = ("EMISSION", "BACKGROUND")
    return owner.node_tree, next(n for n in owner.node_tree.nodes if n.type in kinds)


def dress(data, random):
    """Nodes of a lamp: colours by place, or a strength that falls off otherwise."""
    tree, sends = nodes_of(data)
    graph = Graph(tree, random)
    if random.random() < 0.5:
        falloff = graph.node("ShaderNodeLightFalloff")
        graph.set(falloff, Strength=1.0, Smooth=float(random.uniform(0, 1)))
        tree.links.new(falloff.outputs[random.integers(2)], sends.inputs["Strength"])
        if not falloff.outputs[0].is_linked:
            data.energy *= 0.1  # linear: it grows with distance
    else:
        node = graph.node("ShaderNodeTexChecker")
        graph.set(node, Scale=4.0, Color1=color(random), Color2=color(random))
        place = graph.node("ShaderNodeTexCoord").outputs["Normal"]
        tree.links.new(place, node.inputs["Vector"])
        tree.links.new(node.outputs[0], sends.inputs["Color"])


def lamps(random):
    """Those of Cycles do not move while the shutter is open: none is keyed."""
    made = []
    for _ in range(random.integers(1, 5)):
        kind = random.choice(("POINT", "SUN", "SPOT", "AREA"))
        away = Vector(random.normal(0, 1, 3))
        away.z = abs(away.z) + 0.5
        away.normalize()
        turned = away.to_track_quat("Z", "Y").to_euler()
        bpy.ops.object.light_add(type=kind, location=6 * away, rotation=turned)
        item, data = bpy.context.object, bpy.context.object.data
        data.energy = random.uniform(0.5, 3) if kind == "SUN" else random.uniform(150, 900)
        data.color = color(random, 1.0)[:3]
        if kind == "AREA":
            shapes = ("SQUARE", "DISK", "RECTANGLE", "ELLIPSE")
            data.shape, data.size = random.choice(shapes), random.uniform(0.2, 3)
            data.size_y = random.uniform(0.2, 3)
            if random.random() < 0.2:
                data.spread = random.uniform(0.3, 3)
        elif kind == "SUN":
            data.angle = random.uniform(0, 0.3)
        else:
            data.shadow_soft_size = random.uniform(0, 0.8)
        if kind == "SPOT":
            data.spot_size, data.spot_blend = random.uniform(0.3, 1.5), random.uniform(0, 1)
        if random.random() < 0.15:
            dress(data, random)
        if random.random() < 0.1:
            data.cycles.cast_shadow = False
            if hasattr(data, "use_shadow"):
                data.use_shadow = False
        made.append(item)
    return made


def surroundings(tree, random):
    """An output of colours around the scene."""
    kind = random.choice(("ShaderNodeTexSky", "ShaderNodeTexEnvironment", "ShaderNodeTexGradient"))
    node = tree.nodes.new(kind)
    if kind == "ShaderNodeTexSky":
        if "NISHITA" in node.bl_rna.properties["sky_type"].enum_items:
            node.sky_type = "NISHITA"
        node.sun_elevation, node.sun_rotation = random.uniform(0.1, 1.3), random.uniform(0, 6)
        node.sun_disc = bool(random.random() < 0.5)
        return node.outputs[0], random.uniform(0.02, 0.1)
    if kind == "ShaderNodeTexEnvironment":
        node.image = image(random)
    place = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = random.uniform(-3, 3, 3)
    tree.links.new(place, mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    return node.outputs[0], random.uniform(0.2, 0.8)


def world(scene, random):
    tree, sends = nodes_of(scene.world)
    sends.inputs["Color"].default_value = color(random)
    sends.inputs["Strength"].default_value = random.uniform(0, 0.8)
    if random.random() < 0.4:
        around, strength = surroundings(tree, random)
        tree.links.new(around, sends.inputs["Color"])
        sends.inputs["Strength"].default_value = strength
    if random.random() < 0.05:
        fog = tree.nodes.new("ShaderNodeVolumeScatter")
        fog.inputs["Density"].default_value = random.uniform(0.005, 0.05)
        output = next(n for n in tree.nodes if n.type == "OUTPUT_WORLD")
        tree.links.new(fog.outputs[0], output.inputs["Volume"])


def link_light(item, things, random):
    """A lamp lights some things only, or some cast no shadow in its light (Blender 4)."""
    if not hasattr(item, "light_linking"):
        return
    chosen = bpy.data.collections.new(f"{item.name} reaches")
    for one in things:
        if random.random() < 0.6:
            chosen.objects.link(one)
    if random.random() < 0.5:
        item.light_linking.receiver_collection = chosen
    else:
        item.light_linking.blocker_collection = chosen
