# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadows on and of subdivided surfaces, against Cycles of the same Blender without bounces."""

import math

import bpy
import numpy as np
import scene_parts


def add_sun(scene, tilt):
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = math.pi, 0.0
    scene_parts.add_object(scene, "Sun", sun).rotation_euler = (0.0, tilt, 0.0)


def subdivide(thing, levels):
    modifier = thing.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = levels


def smooth(mesh):
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))


def dark_parts(scene, render, samples):
    """[Granita's, Cycles'] shares of the picture that lie in shadow."""
    shares = []
    for channels in scene_parts.direct_light_of_both(scene, render, samples):
        picture = next(c for name, c in channels.items() if name.endswith("Combined.G"))
        shares.append(float(np.mean(picture < 0.5 * np.median(picture))))
    return shares


def test_something_small_on_a_large_cage_keeps_its_contact_shadow(scene, render):
    """Hills of 100 m in cage faces of 10 m, and on them a cube of 10 cm, a sixth of the picture's width.

    Rays that started as high as the worst chord of a face lost the third of the shadow that is next to the cube.
    """
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=10, y_subdivisions=10, size=100)
    hills = bpy.context.object
    for vertex in hills.data.vertices:
        vertex.co.z = 2.0 * math.sin(0.2 * vertex.co.x) * math.cos(0.17 * vertex.co.y)
    smooth(hills.data)
    subdivide(hills, 6)
    evaluated = hills.evaluated_get(bpy.context.evaluated_depsgraph_get())
    bpy.context.view_layer.update()
    hit, place, _, _ = evaluated.ray_cast((4.1, 8.3, 50.0), (0.0, 0.0, -1.0))
    assert hit
    bpy.ops.mesh.primitive_cube_add(size=0.1, location=(*place[:2], place[2] + 0.045))
    camera = scene_parts.add_camera(scene, (place[0], place[1], place[2] + 3.0))
    camera.data.lens, camera.data.clip_start = 180.0, 0.01
    add_sun(scene, math.radians(50.0))
    scene_parts.set_world(scene, (0.0, 0.0, 0.0))
    scene.render.resolution_x, scene.render.resolution_y = 120, 80
    granita, cycles = dark_parts(scene, render, 32)
    assert cycles > 0.02
    # A pixel of 5 mm is 1 / 24 of the shadow's length; both pictures have whole pixels.
    assert abs(granita / cycles - 1.0) < 0.08


def test_transparency_is_looked_up_where_the_limit_is(scene, render):
    """A subdivided cube, opaque where Object x > .5: of its limit less is than of its cage."""
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(0.0, 0.0, 2.0))
    cube = bpy.context.object
    smooth(cube.data)
    subdivide(cube, 5)
    cube.visible_camera = False
    cube.data.materials.append(opaque_beyond(0.5))
    scene_parts.add_square(scene, "Floor", 8.0)
    scene_parts.add_camera(scene, (0.0, 0.0, 9.0), ortho_scale=4.0)
    add_sun(scene, 0.0)
    scene_parts.set_world(scene, (0.0, 0.0, 0.0))
    granita, cycles = dark_parts(scene, render, 16)
    assert 0.02 < cycles < 0.2
    # The shadow's border is 90 of 3072 pixels, each one or the other.
    assert abs(granita - cycles) < 0.01


def opaque_beyond(x):
    """Opaque where the object's own x is larger, transparent elsewhere."""
    material, nodes, links, output = scene_parts.node_material("Part")
    place = nodes.new("ShaderNodeTexCoord")
    parts = nodes.new("ShaderNodeSeparateXYZ")
    beyond = nodes.new("ShaderNodeMath")
    beyond.operation = "GREATER_THAN"
    beyond.inputs[1].default_value = x
    mix = nodes.new("ShaderNodeMixShader")
    links.new(place.outputs["Object"], parts.inputs[0])
    links.new(parts.outputs["X"], beyond.inputs[0])
    links.new(beyond.outputs[0], mix.inputs["Fac"])
    clear, opaque = (nodes.new(f"ShaderNodeBsdf{name}") for name in ("Transparent", "Diffuse"))
    links.new(clear.outputs[0], mix.inputs[1])
    links.new(opaque.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], output.inputs["Surface"])
    return material
