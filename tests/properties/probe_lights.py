# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps of each kind, plain and with nodes."""

import bpy
import scene_parts
import stage
import unwalked
from probe import Probe


def _lamp(kind, shape=None, nodes=False):
    def build(scene):
        stage.set_world(scene)
        stage.camera(scene)
        stage.add_floor(scene, z=-0.3)
        stage.add_cube(scene, size=0.6, material=stage.diffuse("Paint", (0.8, 0.5, 0.3)))
        made = scene_parts.closure("Shiny", "ShaderNodeBsdfGlossy", Roughness=0.5)
        scene_parts.add_square(scene, "Shiny", 0.8, (-0.8, -0.8, -0.2), made)
        light = bpy.data.lights.new("Lamp", kind)
        light.energy = 2.0 if kind == "SUN" else 80.0
        if shape:
            light.shape, light.size, light.size_y = shape, 0.8, 0.4
        if kind == "SPOT":
            light.spot_size = 0.8
        thing = scene_parts.add_object(scene, "Lamp", light, (0.6, 0.5, 2.2))
        thing.rotation_euler = (-0.25, 0.3, 0.2)
        thing.visible_camera = False
        roots = {"light": light, "object": thing, "scene": scene}
        if nodes:
            light.use_nodes = True
            roots["emission"] = next(n for n in light.node_tree.nodes if n.type == "EMISSION")
        return roots

    return build


def _second_collection(name):
    def deed(roots):
        linking = getattr(roots["object"], "light_linking", None)
        if linking is None:
            return False
        group = bpy.data.collections.new("Linked")
        group.objects.link(roots["scene"].objects["Cube"])
        setattr(linking, name, group)
        return True

    return deed


_LINKING = {
    "light linking": _second_collection("receiver_collection"),
    "shadow linking": _second_collection("blocker_collection"),
}
_OBJECT = unwalked.names("data")

PROBES = [
    Probe("point light", _lamp("POINT"), ("light", "object"), _LINKING, _OBJECT),
    Probe("sun", _lamp("SUN"), ("light",), _LINKING),
    Probe("spot light", _lamp("SPOT"), ("light",), _LINKING),
    Probe("area light, square", _lamp("AREA", "SQUARE"), ("light",), _LINKING),
    Probe("area light, ellipse", _lamp("AREA", "ELLIPSE"), ("light",)),
    Probe("point light with nodes", _lamp("POINT", nodes=True), ("light", "emission")),
]
