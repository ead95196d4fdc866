# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene, render settings, view layer, passes, world, cameras."""

import bpy
import scene_parts
import stage
import unwalked
from probe import Probe


def _stage(scene, blur=False):
    """A glowing cushion, a lit cube that moves and casts a shadow on a floor, a bright world behind."""
    stage.set_world(scene, (0.3, 0.2, 0.5), 0.4)
    stage.camera(scene)
    floor = scene_parts.add_square(
        scene, "Floor", 2.2, (0, 0, -0.4), stage.diffuse("Floor", (0.6, 0.5, 0.4))
    )
    cube = stage.add_cube(scene, material=stage.diffuse("Paint", (0.8, 0.4, 0.2)))
    glow = stage.surface(scene, "Glow", 4, 0.7, material=stage.glowing("Glow"))
    glow.location = (-0.7, 0.7, 0.2)
    ball = stage.surface(scene, "Extra", 3, 0.5, material=stage.diffuse("Extra", (0.2, 0.8, 0.3)))
    ball.location = (0.8, -0.8, 0.4)
    part = scene_parts.add_collection(scene, "Part", [ball])
    stage.add_sun(scene)
    stage.move(cube)
    if blur:
        scene.render.use_motion_blur = True
    scene.frame_set(1)
    layer = scene.view_layers[0]
    return {
        "scene": scene,
        "view_layer": layer,
        "layer_collection": layer.layer_collection.children[part.name],
        "part": part,
        "world": scene.world,
        "floor": floor,
        "cube": cube,
    }


def _with_override(scene):
    roots = _stage(scene)
    stage.diffuse("Alternative", (0.1, 0.1, 0.9))
    other = bpy.data.worlds.new("Alternative")
    other.use_nodes = True
    other.node_tree.nodes["Background"].inputs["Color"].default_value = (0, 1, 0, 1)
    return roots


def _passes(scene):
    roots = _stage(scene)
    layer = roots["view_layer"]
    for rna in layer.bl_rna.properties:
        if rna.identifier.startswith("use_pass_") and rna.identifier[9:] in _PASSES:
            setattr(layer, rna.identifier, True)
    scene.world.mist_settings.start, scene.world.mist_settings.depth = 3.0, 2.0
    roots["cube"].pass_index = 3
    layer.aovs.add().name = "Mask"
    scene_parts.add_aov_output(roots["cube"].data.materials[0], "Mask", (0.2, 0.4, 0.6), 0.5)
    layer.lightgroups.add(name="Key")
    scene.objects["Sun"].lightgroup = "Key"
    roots["mist"] = scene.world.mist_settings
    return roots


_PASSES = {
    "combined",
    "z",
    "mist",
    "position",
    "normal",
    "vector",
    "uv",
    "object_index",
    "material_index",
    "diffuse_direct",
    "diffuse_color",
    "glossy_direct",
    "glossy_color",
    "transmission_direct",
    "transmission_color",
    "emit",
    "environment",
    "shadow",
}


def _world(scene):
    """A cube on a floor in a coloured sky; the floor is glossy."""
    world = stage.set_world(scene, (0.6, 0.4, 0.9), 0.5)
    stage.camera(scene)
    stage.add_floor(scene, stage.diffuse("Floor", (0.6, 0.5, 0.4))).scale = (0.4, 0.4, 1)
    shiny = scene_parts.closure("Shiny", "ShaderNodeBsdfGlossy", Roughness=0.4)
    stage.add_cube(scene, material=shiny)
    scene.view_layers[0].use_pass_mist = True
    world.mist_settings.start, world.mist_settings.depth = 3.0, 2.0
    return {"world": world, "background": world.node_tree.nodes["Background"]}


def _camera(kind):
    def build(scene):
        stage.set_world(scene, (0.1, 0.1, 0.1))
        thing = stage.camera(scene)
        data = thing.data
        glow = stage.surface(scene, "Glow", 6, 2.2, material=stage.glowing("Glow"))
        near = scene_parts.add_square(
            scene, "Near", 0.5, (0.5, 0.4, 1.2), scene_parts.emission("Near", (0.9, 0.2, 0.1))
        )
        if kind == "ORTHO":
            data.type, data.ortho_scale = "ORTHO", 2.6
        if kind == "DOF":
            data.dof.use_dof = True
            data.dof.focus_distance, data.dof.aperture_fstop = 4.0, 0.2
        stage.move(near, 0.1)
        scene.frame_set(1)
        return {"camera": data, "object": thing, "glow": glow, "near": near, "scene": scene}

    return build


def _is_empty(roots):
    empty = scene_parts.add_object(roots["scene"], "Eye", None, (0, 0, 3))
    roots["scene"].camera = empty


_SCENES = unwalked.names("engine", "scenes")

PROBES = [
    Probe("scene", _stage, ("scene", "render"), left_out=_SCENES),
    Probe("blurred scene", lambda s: _stage(s, True), ("scene",), left_out=_SCENES),
    Probe(
        "view layer",
        _with_override,
        ("view_layer", "layer_collection", "part"),
        left_out=unwalked.names("layers"),
    ),
    Probe("passes", _passes, ("view_layer", "mist"), left_out=unwalked.names("layers")),
    Probe("world", _world, ("world", "background")),
    Probe(
        "camera, perspective", _camera("PERSP"), ("camera", "object"), {"is an empty": _is_empty}
    ),
    Probe("camera, orthographic", _camera("ORTHO"), ("camera",)),
    Probe("camera, depth of field", _camera("DOF"), ("camera",)),
]
