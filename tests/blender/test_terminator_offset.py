# SPDX-License-Identifier: GPL-3.0-or-later
"""Where light ends on coarse smooth faces beside Cycles in the same Blender: with things that hide a near lamp, in mirrors, and
where light leaves that was scattered below.  Suns alone: test_polygons_against_cycles.py."""

import math

import bpy
import pytest
import scene_parts
from bounced_parts import light_stage, look_at_stage, render_bounced, surface, worst_block


def cube(scene, shader, color=(0.8, 0.8, 0.8), **inputs):
    """Smooth and of six faces, in front of a dim world, a square lamp on its right."""
    bpy.ops.mesh.primitive_cube_add(size=1.5, location=(0.0, 0.0, 1.0), rotation=(0.0, 0.0, 0.5))
    bpy.ops.object.shade_smooth()
    surface(bpy.context.object, shader, color, **inputs)
    light_stage(scene, 500.0, 0.1)


def check(scene, render, limit, worst, mean=0.005):
    theirs, ours = render_bounced(scene, render, 512, limit=limit)
    assert ours.mean() == pytest.approx(theirs.mean(), rel=mean)
    assert worst_block((theirs, ours)) < worst


def test_what_hides_a_near_lamp(scene, render):
    """From above a face the lamp is seen past another side of the wall, a third of a metre along it: 23 % of a block."""
    cube(scene, "ShaderNodeBsdfDiffuse")
    wall = scene_parts.add_square(scene, "Wall", 6.0, (0.0, -2.4, 1.0))
    wall.rotation_euler = (math.pi / 2, 0.0, 0.0)
    surface(wall, "ShaderNodeBsdfDiffuse", (0.0, 0.0, 0.0))
    wall.visible_camera = False
    look_at_stage(scene, 1.5, 1.0)
    check(scene, render, limit=0, worst=0.05)


def test_what_a_sky_lights(scene, render):
    """By a disc like the sun's: Cycles' samples of a world start there too."""
    cube(scene, "ShaderNodeBsdfDiffuse")
    bpy.data.objects.remove(scene.objects["Lamp"])
    tree = scene.world.node_tree
    places = tree.nodes.new("ShaderNodeTexCoord")
    along = tree.nodes.new("ShaderNodeVectorMath")
    along.operation, along.inputs[1].default_value = "DOT_PRODUCT", (0.46, -0.46, 0.76)
    disc = tree.nodes.new("ShaderNodeMapRange")
    disc.interpolation_type = "SMOOTHSTEP"
    for name, value in (("From Min", 0.99), ("From Max", 0.999), ("To Max", 200.0)):
        disc.inputs[name].default_value = value
    disc.inputs["To Min"].default_value = 0.5
    tree.links.new(places.outputs["Generated"], along.inputs[0])
    tree.links.new(along.outputs["Value"], disc.inputs["Value"])
    tree.links.new(disc.outputs[0], tree.nodes["Background"].inputs["Strength"])
    look_at_stage(scene, 1.5, 1.0)
    check(scene, render, limit=0, worst=0.05, mean=0.01)


def test_a_mirror_shows_no_faces(scene, render):
    """64 % of a block."""
    cube(scene, "ShaderNodeBsdfDiffuse")
    show_in_mirror(scene, scene.objects["Cube"])
    check(scene, render, limit=1, worst=0.08)


def test_a_mirror_shows_normals_that_uneven_scale_bends(scene, render):
    """Of corners, between which they are blended, as where the camera sees them: 23 % of a block."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.9, location=(0.0, 0.0, 1.0))
    bpy.ops.object.shade_smooth()
    thing = bpy.context.object
    thing.scale = (0.4, 1.3, 0.8)
    surface(thing, "ShaderNodeBsdfDiffuse", (0.8, 0.8, 0.8))
    light_stage(scene, 500.0, 0.1)
    show_in_mirror(scene, thing)
    check(scene, render, limit=1, worst=0.08)


def show_in_mirror(scene, thing):
    mirror = scene_parts.add_square(scene, "Mirror", 6.0, (0.0, -2.4, 1.0))
    mirror.rotation_euler = (math.pi / 2, 0.0, 0.0)
    surface(mirror, "ShaderNodeBsdfGlossy", (1.0, 1.0, 1.0), Roughness=0.0)
    mirror.visible_diffuse = mirror.visible_shadow = False
    thing.visible_camera = False
    look_at_stage(scene, 1.5, 1.5)
    scene.camera.location.y, scene.camera.rotation_euler.z = 1.0, math.pi


def test_what_lets_light_through_is_lit_as_its_smooth_side_says(scene, render):
    """A closed body lets a lamp through where its smooth normals turn from it: from inside, where it is dark, though the
    face itself is turned to the lamp: nearly three times as bright where such a face fills the picture."""
    cube(scene, "ShaderNodeBsdfTranslucent")
    look_at_stage(scene, 3.0, 0.8)
    # It is black but for a world behind it: at its edges single samples bring .0015.
    check(scene, render, limit=0, worst=0.2)


def test_light_that_leaves_shows_no_faces(scene, render):
    """72 % of a block."""
    # Since 5.2 the radius is the mean free path.
    scale = 1.0 if bpy.app.version < (5, 2) else 0.25 / math.pi
    cube(scene, "ShaderNodeSubsurfaceScattering", Scale=scale, Radius=(0.2, 0.2, 0.2))
    look_at_stage(scene, 3.0, 0.8)
    check(scene, render, limit=4, worst=0.06, mean=0.015)


@pytest.mark.parametrize("behind", [0.002, 0.05, 0.2])
def test_bumps_let_no_light_through(scene, render, behind):
    """A smooth wall whose displacement is a bump, before a sun that its normals see and it does not: the wall of a hangar
    was lit from outside, a third of the sun's light where that grazed it."""
    wall = scene_parts.add_square(scene, "Wall", 6.0)
    wall.data.polygons[0].use_smooth = True
    material, nodes, links, output = scene_parts.node_material()
    wall.data.materials.append(material)
    noise, bump = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeDisplacement")
    for source, target in (
        (nodes.new("ShaderNodeBsdfDiffuse").outputs[0], output.inputs["Surface"]),
        (noise.outputs[0], bump.inputs["Height"]),
        (bump.outputs[0], output.inputs["Displacement"]),
    ):
        links.new(source, target)
    sun = scene_parts.add_object(scene, "Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle = 10.0, 0.0
    scene_parts.add_camera(scene, ortho_scale=2.0)

    def lit_from(height):
        sun.rotation_euler = (0.0, math.pi / 2 - math.asin(height), 0.0)
        for passes in scene_parts.direct_light_of_both(scene, render, 16):
            yield next(v for k, v in passes.items() if k.endswith("Combined.G"))

    assert all(green.max() < 1e-3 for green in lit_from(-behind))
    assert all(green.mean() > 0.1 for green in lit_from(0.2))  # from before it
