# SPDX-License-Identifier: GPL-3.0-or-later
"""Denoising Data, and Blender's Denoise node set up behind the render layers."""

import bpy
import numpy as np
import pytest
import scene_parts

DENOISE = "CompositorNodeDenoise"


def channels_of(made, name):
    """The pass "Layer.NAME", [height, width, channels]."""
    found = sorted(key for key in made if f".{name}." in key)
    order = sorted(found, key=lambda key: "RGBAXYZ".index(key[-1]))
    return np.stack([made[key] for key in order], axis=-1)


@pytest.fixture
def room(scene):
    """A corner under a square that shines: noise of its light, and one texture's edge."""
    camera = scene_parts.add_camera(scene, (0.0, -6.0, 4.0))
    camera.rotation_euler = (0.95, 0.0, 0.0)
    for name, size, place, color in (
        ("Floor", 12.0, (0.0, 0.0, 0.0), (0.8, 0.6, 0.4)),
        ("Step", 2.0, (0.5, 0.0, 0.6), (0.2, 0.5, 0.9)),
    ):
        matte = scene_parts.closure(name, "ShaderNodeBsdfDiffuse", Color=(*color, 1.0))
        scene_parts.add_square(scene, name, size, place, matte)
    glow = scene_parts.emission("Glow", (8.0, 8.0, 8.0))
    lamp = scene_parts.add_square(scene, "Lamp", 8.0, (-2.0, 0.0, 2.0), glow)
    lamp.visible_camera = False
    scene.granita.light_samples = 1
    return scene


def set_up(scene):
    assert bpy.ops.scene.granita_denoise() == {"FINISHED"}
    if hasattr(scene, "compositing_node_group"):
        return scene.compositing_node_group
    return scene.node_tree


def denoised(tree):
    return [node for node in tree.nodes if node.bl_idname == DENOISE]


def test_denoising_data_are_colours_normal_and_depth(room, render):
    room.view_layers[0].cycles.denoising_store_passes = True
    room.view_layers[0].use_pass_normal = room.view_layers[0].use_pass_z = True
    made = render(room)
    albedo = channels_of(made, "Denoising Albedo")
    for color in ((0.8, 0.6, 0.4), (0.2, 0.5, 0.9)):
        assert (np.abs(albedo - color).max(axis=-1) < 1e-4).mean() > 0.03, color
    assert np.array_equal(channels_of(made, "Denoising Normal"), channels_of(made, "Normal"))
    depth = [values for key, values in made.items() if "Depth" in key]
    assert len(depth) == 2 and np.array_equal(*depth)


def test_the_node_stands_between_the_layers_and_what_took_them(room):
    tree = set_up(room)
    (node,) = denoised(tree)
    sources = {s.name: s.links[0].from_socket.name for s in node.inputs if s.is_linked}
    assert sources == {"Image": "Image", "Normal": "Denoising Normal", "Albedo": "Denoising Albedo"}
    assert [link.to_node.bl_idname for link in node.outputs["Image"].links]
    # Nothing is done twice.
    assert denoised(set_up(room)) == [node]


def test_a_node_that_is_there_gets_what_it_has_not(room):
    tree = set_up(room)
    (node,) = denoised(tree)
    node.mute = True
    for name in ("Normal", "Albedo"):
        tree.links.remove(node.inputs[name].links[0])
    room.view_layers[0].cycles.denoising_store_passes = False
    assert denoised(set_up(room)) == [node]
    assert not node.mute and all(node.inputs[name].is_linked for name in ("Normal", "Albedo"))
    assert room.view_layers[0].cycles.denoising_store_passes


def test_other_engines_have_their_own(room):
    room.render.engine = "CYCLES"
    assert not bpy.ops.scene.granita_denoise.poll()


def test_an_artists_own_nodes_take_the_denoised_image(room):
    tree = set_up(room)
    for node in denoised(tree):
        taken = [link.to_socket for link in node.outputs["Image"].links]
        layers = node.inputs["Image"].links[0].from_node
        tree.nodes.remove(node)
    blur = tree.nodes.new("CompositorNodeBlur")
    tree.links.new(layers.outputs["Image"], blur.inputs["Image"])
    for socket in taken:
        tree.links.new(blur.outputs["Image"], socket)
    set_up(room)
    assert blur.inputs["Image"].links[0].from_node.bl_idname == DENOISE
    assert all(socket.links[0].from_node == blur for socket in taken)


def test_what_is_composited_is_less_noisy(room, tmp_path):
    """One light sample against 256 of them."""
    set_up(room)
    room.granita.samples = 64
    image = room.render.image_settings
    image.file_format, image.color_depth = "OPEN_EXR", "32"

    def picture(name, samples, composites):
        room.granita.light_samples, room.render.use_compositing = samples, composites
        room.render.filepath = str(tmp_path / f"{name}.exr")
        bpy.ops.render.render(write_still=True)
        loaded = bpy.data.images.load(room.render.filepath)
        loaded.colorspace_settings.name = "Non-Color"
        pixels = np.empty(len(loaded.pixels), dtype=np.float32)
        loaded.pixels.foreach_get(pixels)
        return pixels.reshape(-1, 4)[:, :3]

    truth = picture("truth", 256, False)
    noisy, clean = picture("noisy", 1, False), picture("clean", 1, True)
    if np.array_equal(noisy, clean):
        pytest.skip("this Blender was built without Open Image Denoise")

    # The median: of a picture as small as this edges and borders are most of what the node errs.
    def error(pixels):
        return np.median(np.abs(pixels - truth).max(axis=-1))

    assert error(clean) < 0.8 * error(noisy)
