# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of each source, and how nodes show them."""

import os
import tempfile

import bpy
import numpy as np
import scene_parts
import stage
import unwalked
from probe import Probe

_FOLDER = tempfile.mkdtemp(prefix="granita-images-")


def _file(format_name, depth, extension, seed=1):
    """A file of 8 by 8 texels in a format that Blender writes."""
    path = os.path.join(_FOLDER, f"picture{seed}{extension}")
    if not os.path.exists(path):
        image = bpy.data.images.new("Written", 8, 8, alpha=True, float_buffer=depth == "32")
        pixels = np.random.default_rng(seed).uniform(0.1, 0.9, (8, 8, 4)).astype(np.float32)
        pixels[..., 3] = np.where(pixels[..., 3] < 0.4, 0.5, 1.0)
        image.pixels.foreach_set(pixels.ravel())
        image.filepath_raw, image.file_format = path, format_name
        image.save()
        bpy.data.images.remove(image)
    return path


def _shown(scene, image, kind="ShaderNodeTexImage"):
    stage.set_world(scene)
    stage.top_camera(scene)
    made, nodes, links, output = scene_parts.node_material()
    stage.surface(scene, material=made)
    texture, emit = nodes.new(kind), nodes.new("ShaderNodeEmission")
    texture.image = image
    texture.interpolation = "Closest"
    links.new(texture.outputs["Color"], emit.inputs["Color"])
    links.new(
        texture.outputs["Alpha"] if "Alpha" in texture.outputs else texture.outputs[0],
        emit.inputs["Strength"],
    )
    links.new(emit.outputs[0], output.inputs["Surface"])
    return {"image": image, "node": texture, "scene": scene}


def _png(scene):
    return _shown(scene, bpy.data.images.load(_file("PNG", "8", ".png")))


def _exr(scene):
    return _shown(scene, bpy.data.images.load(_file("OPEN_EXR", "32", ".exr")))


def _generated(scene):
    image = bpy.data.images.new("Generated", 16, 16)
    image.generated_type = "COLOR_GRID"
    return _shown(scene, image)


def _sequence(scene):
    for frame, seed in ((1, 11), (2, 12), (3, 13)):
        path = os.path.join(_FOLDER, f"frame_{frame:04}.png")
        if not os.path.exists(path):
            os.rename(_file("PNG", "8", ".png", seed), path)
    image = bpy.data.images.load(os.path.join(_FOLDER, "frame_0001.png"))
    image.source = "SEQUENCE"
    roots = _shown(scene, image)
    user = roots["node"].image_user
    user.frame_duration, user.use_auto_refresh = 3, True
    scene.frame_set(1)
    return roots


def _environment(scene):
    world = stage.set_world(scene)
    # Cycles' table of 8 by 8 texels has a thousand rows by itself.
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 64
    scene.camera = None
    stage.camera(scene, lens=15)
    nodes, links = world.node_tree.nodes, world.node_tree.links
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(_file("PNG", "8", ".png"))
    links.new(texture.outputs["Color"], nodes["Background"].inputs["Color"])
    return {"image": texture.image, "node": texture, "scene": scene}


_IMAGES = unwalked.names("images")

PROBES = [
    Probe("image, PNG", _png, ("image", "node"), {}, _IMAGES),
    Probe("image, OpenEXR", _exr, ("image",), {}, _IMAGES),
    Probe("image, generated", _generated, ("image",), {}, _IMAGES),
    Probe("image, sequence", _sequence, ("image", "node"), {}, _IMAGES),
    Probe("image, environment", _environment, ("image", "node"), {}, _IMAGES),
]
