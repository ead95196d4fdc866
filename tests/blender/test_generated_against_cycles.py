# SPDX-License-Identifier: GPL-3.0-or-later
"""Generated coordinates stay on what deforms and follow the texture space: against Cycles."""

import math

import bpy
import numpy as np
import pytest
import scene_parts
from mesh_parts import CUBE, CUBE_FACES
from node_comparison import Tree, render_both


def add_cube(scene, smooth=False):
    cube = scene_parts.add_mesh(scene, "Cube", CUBE, CUBE_FACES)
    cube.data.polygons.foreach_set("use_smooth", [smooth] * 6)
    return cube


def pulled_corner(cube):
    """A shape key, at its full value, that moves a corner far out."""
    cube.shape_key_add(name="Basis")
    key = cube.shape_key_add(name="Pulled")
    key.data[7].co = (3, 2, 2)
    key.value = 1.0


def taper(cube):
    modifier = cube.modifiers.new("Taper", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.factor = "TAPER", 1.0


def shape_key(scene):
    cube = add_cube(scene)
    pulled_corner(cube)
    return cube


def deformed(scene):
    cube = add_cube(scene)
    taper(cube)
    return cube


def array(scene):
    cube = add_cube(scene)
    cube.modifiers.new("Array", "ARRAY")
    return cube


def texture_space(scene):
    cube = add_cube(scene)
    cube.data.use_auto_texspace = False
    cube.data.texspace_location, cube.data.texspace_size = (0.5, 0, 1), (2, 3, 1.5)
    return cube


def subdivided(cube):
    cube.modifiers.new("Subdivision", "SUBSURF").render_levels = 5
    return cube


def subdivided_shape_key(scene):
    cube = add_cube(scene, smooth=True)
    pulled_corner(cube)
    return subdivided(cube)


def subdivided_array_deformed(scene):
    cube = add_cube(scene, smooth=True)
    cube.modifiers.new("Array", "ARRAY")
    taper(cube)
    return subdivided(cube)


def subdivided_texture_space(scene):
    cube = texture_space(scene)
    cube.data.polygons.foreach_set("use_smooth", [True] * 6)
    return subdivided(cube)


def text(scene):
    curve = bpy.data.curves.new("Text", "FONT")
    curve.body, curve.extrude, curve.size = "Gran", 0.3, 2.0
    return scene_parts.add_object(scene, "Text", curve, (-2, -0.5, 0))


def bevelled_curve(scene):
    curve = bpy.data.curves.new("Ring", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.4
    spline = curve.splines.new("POLY")
    spline.points.add(7)
    for i, point in enumerate(spline.points):
        point.co = (math.cos(i * math.pi / 4), math.sin(i * math.pi / 4), 0.1 * i, 1)
    return scene_parts.add_object(scene, "Ring", curve)


@pytest.mark.parametrize(
    "build",
    [
        shape_key,
        deformed,
        array,
        texture_space,
        subdivided_shape_key,
        subdivided_array_deformed,
        subdivided_texture_space,
        text,
        bevelled_curve,
    ],
)
def test_generated(scene, render, build):
    scene_parts.add_camera(scene, (3, -5, 6)).rotation_euler = (0.7, 0.1, 0.5)
    tree = Tree(build(scene))
    tree.emit(tree.add("ShaderNodeTexCoord").outputs["Generated"])
    theirs, ours = render_both(scene, render, samples=64)
    covered = np.count_nonzero(theirs.any(axis=-1))
    assert covered > 0.05 * theirs[..., 0].size
    difference = abs(ours - theirs).sum(axis=(0, 1)) / covered
    print(f"{build.__name__}: mean difference {difference.round(4)}")
    # Both take 64 samples of the edges' pixels, a tenth of what is covered.
    assert difference.max() < 0.006
