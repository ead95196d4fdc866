# SPDX-License-Identifier: GPL-3.0-or-later
"""What test scenes are made of: plain data calls, the same in every Blender."""

import sys
from pathlib import Path

import bpy

sys.path.append(str(Path(__file__).resolve().parents[2] / "demo"))
from keyframes import fcurves_of, make_linear  # noqa: E402, F401


def multilayer_exr(scene):
    """Float passes without compression, as exr.py reads them."""
    image = scene.render.image_settings
    if hasattr(image, "media_type"):  # Blender 5 asks for the medium first
        image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format = "OPEN_EXR_MULTILAYER"
    image.color_depth = "32"
    image.exr_codec = "NONE"
    if hasattr(image, "use_exr_interleave"):  # else Blender 5 writes a part a pass
        image.use_exr_interleave = True


def direct_light_of_both(scene, render, samples):
    """[Granita's, Cycles'] channels of the same picture without bounces, Cycles' of `samples` samples."""
    settings, cycles = scene.granita, scene.cycles
    settings.samples, settings.light_samples = 16, 64
    settings.pixel_filter, settings.filter_width = "BOX", 1.0
    cycles.samples = samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 0
    cycles.pixel_filter_type = "BOX"
    cycles.blur_glossy = cycles.sample_clamp_direct = cycles.light_sampling_threshold = 0.0
    made = []
    for engine in ("GRANITA", "CYCLES"):
        scene.render.engine = engine
        made.append(render(scene, engine))
    scene.render.engine = "GRANITA"
    return made


def add_object(scene, name, data, location=(0.0, 0.0, 0.0)):
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    scene.collection.objects.link(thing)
    return thing


def add_camera(scene, location=(0.0, 0.0, 5.0), ortho_scale=None):
    """Looks along -z of the world; orthographic where `ortho_scale` (metres) is given."""
    camera = bpy.data.cameras.new("Camera")
    if ortho_scale is not None:
        camera.type = "ORTHO"
        camera.ortho_scale = ortho_scale
    scene.camera = add_object(scene, "Camera", camera, location)
    return scene.camera


def set_world(scene, color):
    """A new world of one colour; by nodes, which the worlds of Blender 5 always have."""
    world = scene.world = bpy.data.worlds.new("World")
    if world.node_tree is None:
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)


def add_mesh(scene, name, vertices, faces, location=(0.0, 0.0, 0.0), material=None):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    if material is not None:
        mesh.materials.append(material)
    return add_object(scene, name, mesh, location)


def add_square(scene, name="Square", size=2.0, location=(0.0, 0.0, 0.0), material=None):
    """Faces +z."""
    h = size / 2
    corners = [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)]
    return add_mesh(scene, name, corners, [(0, 1, 2, 3)], location, material)


def add_collection(scene, name, things=()):
    """A collection of the scene that holds just these objects of it."""
    collection = bpy.data.collections.new(name)
    scene.collection.children.link(collection)
    for thing in things:
        collection.objects.link(thing)
        scene.collection.objects.unlink(thing)
    return collection


def add_subsurf(thing, levels=2):
    """A Subdivision modifier on smooth faces: of flat ones Blender's own facets are drawn."""
    mesh = thing.data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.update()
    modifier = thing.modifiers.new("Subsurf", "SUBSURF")
    modifier.levels = modifier.render_levels = levels
    return modifier


def cast_no_shadow(light):
    """In both engines: Cycles has a switch of its own before Blender 5."""
    light.use_shadow = False
    if hasattr(light.cycles, "cast_shadow"):
        light.cycles.cast_shadow = False


def node_material(name="Material"):
    """(material, nodes, links, its output), without other nodes."""
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    return material, tree.nodes, tree.links, tree.nodes.new("ShaderNodeOutputMaterial")


def closure(name, node_type, **inputs):
    """A material of one shader node; `inputs` by the names of its sockets."""
    material, nodes, links, output = node_material(name)
    shader = nodes.new(node_type)
    for socket, value in inputs.items():
        shader.inputs[socket].default_value = value
    links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def matte():
    """Lambert's, of 0.8: Cycles' for objects without a material before Blender 5."""
    return closure("Matte", "ShaderNodeBsdfDiffuse")


def emission(name, color, strength=1.0):
    """A material whose pixels are `color` (linear RGB) times `strength`."""
    return closure(name, "ShaderNodeEmission", Color=(*color, 1.0), Strength=strength)


def add_aov_output(material, name, color=(0.0, 0.0, 0.0), value=0.0):
    """Its name is the node's own before Blender 4."""
    node = material.node_tree.nodes.new("ShaderNodeOutputAOV")
    setattr(node, "aov_name" if hasattr(node, "aov_name") else "name", name)
    node.inputs["Color"].default_value = (*color, 1.0)
    node.inputs["Value"].default_value = value


def set_terminator_offset(thing, offset):
    """Geometry Offset: an object's own since Blender 4.3, of Cycles' add-on before."""
    name = "shadow_terminator_geometry_offset"
    setattr(thing if hasattr(thing, name) else thing.cycles, name, offset)
