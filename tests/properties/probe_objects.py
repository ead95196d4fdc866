# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects, what instances them, and materials."""

import bpy
import scene_parts
import stage
import unwalked
from probe import Probe

_OBJECTS = unwalked.names("objects", "data")


def _surroundings(scene, world=(0.2, 0.15, 0.3)):
    stage.set_world(scene, world, 0.5)
    stage.camera(scene)
    floor = stage.add_floor(scene)
    floor.scale = (0.5, 0.5, 1.0)
    stage.add_sun(scene)
    return floor


def _info(name="Info"):
    """Diffuse, its colour from Object Info: colour, indices, random."""
    made, nodes, _links, _output = tree = scene_parts.node_material(name)
    info = nodes.new("ShaderNodeObjectInfo").outputs
    stage.show_sum(tree, info["Color"], info["Object Index"])
    return made


def _object(scene):
    _surroundings(scene)
    cube = stage.add_cube(scene, material=_info())
    scene_parts.add_object(scene, "Other", None, (0.5, 0, 0))
    return {"object": cube, "scene": scene}


def _moving_object(scene):
    roots = _object(scene)
    stage.move(roots["object"], 0.8)
    scene.render.use_motion_blur = True
    scene.frame_set(1)
    return roots


def _material(scene):
    _surroundings(scene)
    made = _info("Paint")
    stage.add_cube(scene, material=made)
    stage.diffuse("Other", (0.1, 0.8, 0.1))
    return {"material": made}


def _plain_material(scene):
    _surroundings(scene)
    made = bpy.data.materials.new("Plain")
    if made.use_nodes:
        made.use_nodes = False
    stage.add_cube(scene, material=made)
    return {"material": made}


def _collection_instance(scene):
    _surroundings(scene)
    cube = stage.add_cube(scene, size=0.5, material=_info())
    part = bpy.data.collections.new("Part")
    part.objects.link(cube)
    scene.collection.objects.unlink(cube)
    place = scene_parts.add_object(scene, "Place", None, (0.2, 0.1, 0.0))
    place.instance_type, place.instance_collection = "COLLECTION", part
    return {"object": place, "part": part, "inside": cube}


def _instancer(kind):
    def build(scene):
        _surroundings(scene)
        cube = stage.add_cube(scene, size=0.3, location=(0, 0, 0), material=_instanced())
        parent = scene_parts.add_square(
            scene, "Parent", 1.2, (0.1, 0.1, 0.4), stage.diffuse("Parent", (0.3, 0.5, 0.9))
        )
        stage.finish_mesh(parent.data)
        cube.parent, parent.instance_type = parent, kind
        return {"object": parent, "inside": cube}

    return build


def _instanced():
    """Diffuse by Texture Coordinate > From Instancer."""
    made, nodes, _links, _output = tree = scene_parts.node_material("Instanced")
    coordinate, info = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeObjectInfo")
    coordinate.name = "Coordinate"
    stage.show_sum(tree, coordinate.outputs["UV"], info.outputs["Color"])
    return made


def _from_instancer(roots):
    material = roots["inside"].data.materials[0]
    material.node_tree.nodes["Coordinate"].from_instancer = True


def _generated_from_instancer(roots):
    _from_instancer(roots)
    tree = roots["inside"].data.materials[0].node_tree
    tree.links.new(
        tree.nodes["Coordinate"].outputs["Generated"], tree.nodes["Vector Math"].inputs[0]
    )


_FROM_INSTANCER = {
    "UV from the instancer": _from_instancer,
    "Generated from the instancer": _generated_from_instancer,
}


def _add(kind):
    """An object of a type is put into the scene."""

    def deed(roots):
        scene = roots["scene"]
        make = _MAKERS.get(kind)
        thing = make(scene) if make else None
        return thing is not None

    return deed


def _volume(scene):
    return scene_parts.add_object(scene, "Volume", bpy.data.volumes.new("Volume"), (0, 0, 0.5))


def _text(scene):
    curve = bpy.data.curves.new("Text", "FONT")
    curve.body = "Ag"
    return scene_parts.add_object(scene, "Text", curve, (-0.5, 0, 0.8))


def _metaball(scene):
    ball = bpy.data.metaballs.new("Ball")
    ball.elements.new().radius = 0.8
    return scene_parts.add_object(scene, "Ball", ball, (0, 0, 0.8))


_MAKERS = {"volume": _volume, "text": _text, "metaball": _metaball}


def _edit_mode(roots):
    bpy.context.view_layer.objects.active = roots["object"]
    bpy.ops.object.mode_set(mode="EDIT")


_DEEDS = {**{f"a {kind} is added": _add(kind) for kind in _MAKERS}, "is edited": _edit_mode}

PROBES = [
    Probe("object", _object, ("object",), _DEEDS, _OBJECTS),
    Probe("moving object", _moving_object, ("object",), {}, _OBJECTS),
    Probe("material", _material, ("material",)),
    Probe("material without nodes", _plain_material, ("material",)),
    Probe("collection instance", _collection_instance, ("object", "part", "inside"), {}, _OBJECTS),
    Probe(
        "instances on vertices",
        _instancer("VERTS"),
        ("object", "inside"),
        _FROM_INSTANCER,
        _OBJECTS,
    ),
    Probe(
        "instances on faces",
        _instancer("FACES"),
        ("object", "inside"),
        _FROM_INSTANCER,
        _OBJECTS,
    ),
]
