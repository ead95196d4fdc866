# SPDX-License-Identifier: GPL-3.0-or-later
"""Wireframe beside Cycles: both fill the same triangles."""

import math

import bpy
import pytest
import scene_parts
from bounced_parts import render_bounced
from node_comparison import Tree, render_both, rmse

# Triangles, squares, a concave polygon and one of six corners.
VERTICES = [
    (-1.8, -1.8, 0.0), (-0.2, -1.8, 0.0), (-0.2, -0.2, 0.0), (-1.8, -0.2, 0.0),
    (0.2, -1.8, 0.0), (1.8, -1.8, 0.0), (1.8, -0.2, 0.0),
    (-1.8, 0.2, 0.0), (-0.2, 0.2, 0.0), (-1.3, 0.7, 0.0), (-1.8, 1.8, 0.0),
    (0.5, 0.2, 0.0), (1.5, 0.2, 0.0), (1.8, 1.0, 0.0), (1.5, 1.8, 0.0), (0.5, 1.8, 0.0), (0.2, 1.0, 0.0),
]  # fmt: skip
FACES = [(0, 1, 2, 3), (4, 5, 6), (7, 8, 9, 10), (11, 12, 13, 14, 15, 16)]


def agree(scene, render, samples=64):
    """Ends of lines have the noise of the samples of both."""
    scene.render.resolution_x = scene.render.resolution_y = 48
    theirs, ours = render_both(scene, render, samples)
    assert theirs.std() > 0.1
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.01)
    assert rmse(theirs, ours) < 0.06 * theirs.std(), rmse(theirs, ours) / theirs.std()


def wired(thing, size, in_pixels=False):
    tree = Tree(thing)
    wire = tree.add("ShaderNodeWireframe", use_pixel_size=in_pixels)
    wire.inputs["Size"].default_value = size
    tree.emit(wire.outputs[0])


@pytest.mark.parametrize("turn", [0.0, 1.0])
@pytest.mark.parametrize("in_pixels", [False, True])
def test_polygons(scene, render, in_pixels, turn):
    thing = scene_parts.add_mesh(scene, "Faces", VERTICES, FACES)
    thing.scale = (1.0, 0.7, 1.0)
    thing.rotation_euler.x = turn
    wired(thing, 4.0 if in_pixels else 0.25, in_pixels)
    scene_parts.add_camera(scene, (0, 0, 6), ortho_scale=4.0)
    agree(scene, render)


@pytest.mark.parametrize("in_pixels", [False, True])
def test_in_perspective(scene, render, in_pixels):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=1.2)
    wired(bpy.context.object, 1.5 if in_pixels else 0.06, in_pixels)
    camera = scene_parts.add_camera(scene, (0, 0, 3.0))
    camera.data.type, camera.data.angle = "PERSP", math.radians(60)
    agree(scene, render)


@pytest.mark.parametrize("size", [0.0007, 0.005])
def test_on_faces_below_a_pixel(scene, render, size):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=360, y_subdivisions=360, size=6.0)
    bpy.context.object.rotation_euler.z = 0.4
    wired(bpy.context.object, size)
    scene_parts.add_camera(scene, ortho_scale=4.0)
    scene.render.resolution_x = scene.render.resolution_y = 48
    theirs, ours = render_both(scene, render, 64)
    # Cycles' 147,000 samples, of which at least 1 in 8 meets a line: 3 deviations.
    assert 0.05 < theirs.mean() < 0.9
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.02)


@pytest.mark.parametrize("levels, size", [(1, 0.15), (3, 0.06)])
def test_subdivision_surfaces_show_the_faces_of_their_level(scene, render, levels, size):
    bpy.ops.mesh.primitive_cube_add(size=2.4)
    thing = bpy.context.object
    bpy.ops.object.shade_smooth()
    modifier = thing.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = levels
    thing.rotation_euler = (0.4, 0.3, 0.0)
    wired(thing, size)
    scene_parts.add_camera(scene, ortho_scale=3.0)
    agree(scene, render)


def test_widths_in_pixels_in_a_mirror(scene, render):
    """A grid beside the picture, seen in a mirror that leans."""
    scene.render.resolution_x = scene.render.resolution_y = 96
    scene_parts.add_camera(scene, (0.0, 0.0, 5.0))
    mirror = scene_parts.closure("Mirror", "ShaderNodeBsdfGlossy", Roughness=0.0)
    leaning = scene_parts.add_square(scene, "Mirror", 3.0, (0.0, 0.0, 0.0), mirror)
    leaning.rotation_euler = (0.0, math.radians(45.0), 0.0)
    aside = dict(location=(5.0, 0.0, 0.0), rotation=(0.0, math.radians(-90.0), 0.0))
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=6, size=6.0, **aside)
    wired(bpy.context.object, 4.0, in_pixels=True)
    theirs, ours = (picture.mean() for picture in render_bounced(scene, render, 64))
    assert theirs > 0.2
    # Edges of lines are found to a sample of 16.
    assert ours == pytest.approx(theirs, rel=0.03)
