# SPDX-License-Identifier: GPL-3.0-or-later
"""What files hold that nobody means to draw: frames of one line, things at the end of the world, trees that go round."""

import bpy
import numpy as np
import pytest
import scene_parts as parts
from node_comparison import combined, render_both
from test_nodes_shaders import sun

COLOR = (0.25, 0.5, 0.75)


@pytest.mark.parametrize("size", [(1, 5000), (5000, 1), (16384, 4), (4, 16384)], ids=str)
def test_frames_of_a_line(scene, render, size):
    parts.add_camera(scene, ortho_scale=1.0)
    parts.add_square(scene, size=4.0, material=parts.emission("Glow", COLOR))
    # Blender's least resolution is 4, of which a quarter is rendered.
    scene.render.resolution_x, scene.render.resolution_y = (4 * side for side in size)
    scene.render.resolution_percentage = 25
    image = combined(render(scene), "RGBA")
    assert image.shape[:2] == size[::-1]
    np.testing.assert_allclose(image, np.broadcast_to((*COLOR, 1.0), image.shape), rtol=1e-6)


def _view(scene):
    """A hundred metres of a cube that leans, lit by a sun, with a camera that comes along."""
    sun(scene, (0.5, 0.4, 0.0))
    bpy.ops.mesh.primitive_cube_add(size=100.0)
    cube = bpy.context.object
    cube.rotation_euler = (0.3, 0.5, 0.2)
    matte = bpy.data.materials.new("Matte")
    cube.data.materials.append(matte)
    camera = parts.add_camera(scene, (0.0, 0.0, 500.0))
    camera.data.clip_end = 1e4
    scene.granita.samples = 64


def test_things_a_hundred_thousand_kilometres_away(scene, render):
    """Blender keeps places in single precision: 8 m of steps at 1e8 m, of which all here are multiples."""
    _view(scene)
    here = combined(render(scene, "here"), "RGBA")
    for name in ("Cube", "Camera"):
        scene.objects[name].location.x = scene.objects[name].location.y = 1e8
    there = combined(render(scene, "there"), "RGBA")
    assert here[..., 0].std() > 0.1
    # Places of the cube's surface in double precision, but matrices in single.
    assert np.abs(there - here).mean() < 2e-3


def test_faces_that_are_there_twice_are_there_once(scene, render):
    parts.add_camera(scene)
    glow = parts.emission("Glow", COLOR)
    corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    once = parts.add_mesh(scene, "Once", corners, [(0, 1, 2, 3)], material=glow)
    once.rotation_euler = (0.3, 0.2, 0.7)
    expected = combined(render(scene, "once"), "RGBA")
    twice = parts.add_mesh(scene, "Twice", 2 * corners, [(0, 1, 2, 3), (4, 5, 6, 7), (3, 2, 1, 0)])
    twice.data.materials.append(glow)
    twice.rotation_euler = once.rotation_euler
    bpy.data.objects.remove(once)
    np.testing.assert_array_equal(combined(render(scene, "twice"), "RGBA"), expected)


@pytest.mark.parametrize("scale", [(0, 1, 1), (1, 0, 1), (1e-6, 1e4, 1), (1, 1, 0)], ids=str)
def test_what_is_flattened_hides_no_other_pixel(scene, render, scale):
    """A ball of no volume behind what is seen, and a lamp of no size that lights nothing."""
    parts.add_camera(scene)
    parts.add_square(scene, material=parts.emission("Glow", COLOR)).rotation_euler = (0.3, 0.2, 0.7)
    matte = bpy.data.materials.new("Matte")
    parts.add_square(scene, size=20.0, location=(0, 0, -3), material=matte)
    expected = combined(render(scene, "without"), "RGBA")
    bpy.ops.mesh.primitive_uv_sphere_add(location=(0, 0, -4))
    ball = bpy.context.object
    ball.scale = scale
    lamp = parts.add_object(scene, "Lamp", bpy.data.lights.new("Lamp", "AREA"))
    lamp.parent = ball
    image = combined(render(scene, "with"), "RGBA")
    # The ball is behind the matte square, which an area lamp behind it cannot light.
    np.testing.assert_array_equal(image, expected)


def _without_an_output(tree):
    tree.nodes.remove(next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL"))


def _empty(tree):
    tree.nodes.clear()


def _goes_round(tree):
    """Two nodes that each feed the other; Blender marks the last link invalid, but keeps it."""
    emission = next(n for n in tree.nodes if n.type == "EMISSION")
    a, b = (tree.nodes.new("ShaderNodeMixRGB") for _ in range(2))
    tree.links.new(a.outputs[0], b.inputs[1])
    tree.links.new(b.outputs[0], a.inputs[1])
    tree.links.new(b.outputs[0], emission.inputs["Color"])


def _two_outputs(tree):
    other = tree.nodes.new("ShaderNodeOutputMaterial")
    other.is_active_output = True


@pytest.mark.parametrize("build", [_without_an_output, _empty, _goes_round, _two_outputs])
def test_trees_that_lead_nowhere_are_as_in_cycles(scene, render, build):
    parts.add_camera(scene)
    material = parts.emission("Glow", COLOR)
    parts.add_square(scene, size=20.0, material=material)
    build(material.node_tree)
    theirs, ours = render_both(scene, render)
    np.testing.assert_allclose(ours, theirs, atol=2e-3)
