# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement by materials, against Cycles of the same Blender on a mesh as fine as its pixels."""

import math

import bpy
import numpy as np
import pytest
import scene_parts
from bounced_parts import light_stage, look_at_stage, render_bounced, worst_block
from node_comparison import Tree


def displace_by(material, method):
    owner = material if hasattr(material, "displacement_method") else material.cycles
    owner.displacement_method = method


def hills(scene, method, vector=False):
    """A smooth sheet of 2 m under a low sun, moved by a noise without detail."""
    # Cycles moves vertices, and has as many as pixels; normals are bent anywhere.
    is_bump = method == "BUMP"
    faces = 8 if is_bump else 160
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=faces, y_subdivisions=faces, size=2)
    sheet = bpy.context.object
    sheet.data.polygons.foreach_set("use_smooth", [True] * len(sheet.data.polygons))
    sheet.rotation_euler = (0.0, 0.0, 0.3) if is_bump else (0.2, -0.1, 0.3)
    sheet.scale = (1.0, 1.0, 1.5)
    tree = Tree(sheet)
    displace_by(tree.material, method)
    place = tree.add("ShaderNodeTexCoord")
    noise = tree.add("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 3.0, 0.0
    matte = tree.add("ShaderNodeBsdfDiffuse")
    kind = "ShaderNodeVectorDisplacement" if vector else "ShaderNodeDisplacement"
    displacement = tree.add(kind)
    displacement.inputs["Midlevel"].default_value = 0.5
    displacement.inputs["Scale"].default_value = 0.4
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    source = noise.outputs["Color" if vector else "Fac"]
    tree.links.new(source, displacement.inputs["Vector" if vector else "Height"])
    if vector:
        displacement.space = "OBJECT"
    tree.links.new(displacement.outputs[0], tree.output.inputs["Displacement"])
    tree.links.new(matte.outputs[0], tree.output.inputs["Surface"])
    camera = scene_parts.add_camera(scene, (0.0, 0.0, 4.0) if is_bump else (0.0, -3.0, 2.5))
    camera.rotation_euler = (0.0 if is_bump else math.radians(50.0), 0.0, 0.0)
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = math.pi, 0.0
    scene_parts.add_object(scene, "Sun", sun).rotation_euler = (0.3, 1.0, 0.0)
    scene_parts.set_world(scene, (0.0, 0.0, 0.0))
    scene.render.resolution_x, scene.render.resolution_y = 160, 120


def pictures(scene, render):
    return [
        next(c for name, c in channels.items() if name.endswith("Combined.G"))
        for channels in scene_parts.direct_light_of_both(scene, render, 32)
    ]


def test_a_vector_that_is_not_linked_displaces(scene, render):
    """Blender hides its value, Cycles reads it: it was taken for one that stands for something else."""
    hills(scene, "DISPLACEMENT", True)
    tree = bpy.context.object.active_material.node_tree
    node = next(n for n in tree.nodes if n.type == "VECTOR_DISPLACEMENT")
    tree.links.remove(node.inputs["Vector"].links[0])
    node.inputs["Vector"].default_value = (1.0, 0.2, 2.0, 1.0)
    granita, cycles = pictures(scene, render)
    # Moved by a fifth of the picture, a plain sheet: borders apart both are the same.
    assert np.abs(granita - cycles).mean() < 0.005
    node.inputs["Vector"].default_value = (0.5, 0.5, 0.5, 1.0)
    assert np.abs(pictures(scene, render)[1] - cycles).mean() > 0.05


def lit_ball(scene, segments, kind, space, source, target):
    """A ball of 1.1 m that a noise displaces, beside a square lamp under a grey sky: 128 x 96 pixels."""
    rings = segments // 2
    bpy.ops.mesh.primitive_uv_sphere_add(
        segments=segments, ring_count=rings, radius=1.1, location=(0, 0, 1)
    )
    bpy.ops.object.shade_smooth()
    tree = Tree(bpy.context.object)
    displace_by(tree.material, "DISPLACEMENT")
    noise = tree.add("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 2.0
    displacement = tree.add(kind)
    displacement.space = space
    displacement.inputs["Midlevel"].default_value = 0.5
    displacement.inputs["Scale"].default_value = 0.6
    tree.links.new(noise.outputs[source], displacement.inputs[target])
    tree.links.new(displacement.outputs[0], tree.output.inputs["Displacement"])
    matte = tree.add("ShaderNodeBsdfDiffuse")
    tree.links.new(matte.outputs[0], tree.output.inputs["Surface"])
    light_stage(scene, 400.0, 0.3)
    look_at_stage(scene, 3.0, 1.0)
    scene.render.resolution_percentage = 200
    return bpy.context.object


def check_ball(scene, render, worst):
    theirs, ours = (
        image.reshape(48, 2, 64, 2, 3).mean(axis=(1, 3))
        for image in render_bounced(scene, render, 192, limit=1)
    )
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.006)
    assert worst_block((theirs, ours)) < worst


def test_faces_of_a_pixel_do_not_shade_themselves(scene, render):
    """A displaced ball of faces that need no dicing, under bounces: rays that start beside a face's border started below
    the hollow ones, unlit specks that took 3 % of the light and a third of a block."""
    lit_ball(scene, 128, "ShaderNodeDisplacement", "OBJECT", "Fac", "Height")
    check_ball(scene, render, worst=0.06)


def test_tangents_are_as_smooth_as_a_cage(scene, render):
    """Displaced along them: at the far sides of a cage's faces, where slopes look back, they were mirrored: a quarter of a
    block."""
    ball = lit_ball(scene, 32, "ShaderNodeVectorDisplacement", "TANGENT", "Color", "Vector")
    ball.modifiers.new("Cage", "SUBSURF").render_levels = 3
    check_ball(scene, render, worst=0.08)


@pytest.mark.parametrize(
    ("method", "vector", "limit"),
    [
        ("DISPLACEMENT", False, 0.02),
        ("DISPLACEMENT", True, 0.02),
        ("BUMP", False, 0.03 if bpy.app.version >= (4, 5, 0) else 0.05),
    ],
)
def test_hills_are_those_of_cycles(scene, render, method, vector, limit):
    if method == "BUMP" and bpy.app.version < (4, 0, 0):
        pytest.skip(
            "Cycles 3.4 bends otherwise than 4.5 (means .203 and .195), and Granita as the later"
        )
    hills(scene, method, vector)
    granita, cycles = pictures(scene, render)
    # What differs are outlines and the borders of shadows, which either has to a vertex or a pixel; where normals are
    # bent, differences over a pixel, which either takes another way (.024 of the brightest in 4.5, .043 in 4.2, whose bumps have no width of
    # their own and take heights a whole pixel apart).
    assert np.sqrt(np.mean((granita - cycles) ** 2)) < limit * cycles.max()
    assert granita.mean() == pytest.approx(cycles.mean(), rel=0.01)


@pytest.mark.parametrize("method", ["DISPLACEMENT", "BOTH"])
@pytest.mark.parametrize("base", [None, "ORIGINAL", "DISPLACED"])
@pytest.mark.parametrize("strength", [1.0, 0.6])
def test_a_normal_map_bends_what_displacement_has_made(scene, render, method, base, strength):
    """A map that bends nothing shows the relief, as none does: it showed the normals of the mesh, a third of a block.  With
    Both, and in Blender 5, Cycles' maps bend the mesh's own."""
    lit_ball(scene, 128, "ShaderNodeDisplacement", "OBJECT", "Fac", "Height")
    material = bpy.context.object.active_material
    displace_by(material, method)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    bent = nodes.new("ShaderNodeNormalMap")
    if base and not hasattr(bent, "base"):
        pytest.skip("before Blender 5.1 there is no choice")
    if base:
        bent.base = base
    bent.inputs["Strength"].default_value = strength
    bent.inputs["Color"].default_value = (0.5, 0.5, 1.0, 1.0)
    matte = next(node for node in nodes if node.type == "BSDF_DIFFUSE")
    links.new(bent.outputs[0], matte.inputs["Normal"])
    check_ball(scene, render, worst=0.08)
