# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen of whole scenes, against Cycles (cycles_coverage): lenses, cages, instances, motion."""

import math

import bpy
import pytest
import scene_parts
from cycles_coverage import blurred, expect_coverage_of_cycles
from motion_parts import drive, shape_key


def shifted_narrow_pixels(scene):
    camera = scene_parts.add_camera(scene, (1, -6, 2))
    camera.rotation_euler = (1.3, 0.2, 0.1)
    camera.data.shift_x, camera.data.shift_y = 0.1, -0.05
    camera.data.sensor_fit = "VERTICAL"
    scene.render.pixel_aspect_y = 1.5
    bpy.ops.mesh.primitive_monkey_add(size=2)


def orthographic(scene):
    camera = scene_parts.add_camera(scene, (0, 0, 9), ortho_scale=3.5)
    camera.rotation_euler.z = 0.4
    bpy.ops.mesh.primitive_torus_add()


def out_of_focus(scene):
    camera = scene_parts.add_camera(scene, (0, 0, 6))
    camera.data.dof.use_dof = True
    camera.data.dof.aperture_fstop = 0.05
    camera.data.dof.aperture_blades = 5
    camera.data.dof.aperture_rotation = 0.3
    camera.data.dof.aperture_ratio = 1.5
    camera.data.dof.focus_object = scene_parts.add_object(scene, "Focus", None, (0, 0, 1))
    for i in range(3):
        scene_parts.add_square(scene, f"Square{i}", 1.0, (2 * i - 2, 0, 2 * i - 3))


def creased_cage(scene):
    scene_parts.add_camera(scene, (4, -4, 3)).rotation_euler = (1.0, 0, math.pi / 4)
    bpy.ops.mesh.primitive_cube_add(size=2.5)
    cube = bpy.context.object
    modifier = scene_parts.add_subsurf(cube, 5)
    modifier.quality = 7  # at 3, Blender rounds creases off that are still sharp after three levels
    if "crease" in bpy.types.MeshEdge.bl_rna.properties:
        cube.data.edges.foreach_set("crease", [0.75] * 4 + [0.0] * 8)
    else:
        creases = cube.data.attributes.new("crease_edge", "FLOAT", "EDGE")
        creases.data.foreach_set("value", [0.75] * 4 + [0.0] * 8)


def turning_parent(scene):
    scene_parts.add_camera(scene, (0, 0, 8))
    hub = scene_parts.add_object(scene, "Hub", None)
    drive(hub, "rotation_euler", "frame", 2)
    for i in range(3):
        blade = scene_parts.add_square(scene, f"Blade{i}", 1.0)
        blade.parent, blade.location = hub, (2.0 * math.cos(2.1 * i), 2.0 * math.sin(2.1 * i), 0)


def moving_camera(scene):
    camera = scene_parts.add_camera(scene, (0, 0, 8))
    drive(camera, "location", "frame - 10", 0)
    drive(camera, "rotation_euler", "(frame - 10) / 4", 2)
    bpy.ops.mesh.primitive_monkey_add(size=3)


def deforming_cage(scene):
    scene_parts.add_camera(scene, (0, -8, 0)).rotation_euler.x = math.pi / 2
    bpy.ops.mesh.primitive_cube_add(size=2)
    cube = bpy.context.object
    drive(shape_key(cube, lift=2.0), "value", "(frame - 9) / 2")
    scene_parts.add_subsurf(cube, 4)


def moving_instances(scene):
    scene_parts.add_camera(scene, (0, 0, 12))
    square = scene_parts.add_square(scene, "Square", 0.8)
    part = bpy.data.collections.new("Part")
    part.objects.link(square)
    scene.collection.objects.unlink(square)
    for i in range(5):
        place = scene_parts.add_object(scene, f"Place{i}", None, (0, 1.5 * i - 3, 0))
        place.instance_type, place.instance_collection = "COLLECTION", part
        drive(place, "location", f"(frame - 10) * {i}", 0)


def held_out(scene):
    scene_parts.add_camera(scene, (0, 0, 8))
    scene_parts.add_square(scene, "Behind", 4.0)
    scene_parts.add_square(scene, "Unseen", 1.0, (2.5, 0, 0)).visible_camera = False
    hole = scene_parts.add_square(scene, "Hole", 1.0, (0.3, 0.2, 2))
    held = bpy.data.collections.new("Held")
    scene.collection.children.link(held)
    held.objects.link(hole)
    scene.collection.objects.unlink(hole)
    bpy.context.view_layer.layer_collection.children["Held"].holdout = True


@pytest.mark.parametrize(
    "build",
    [
        shifted_narrow_pixels,
        orthographic,
        out_of_focus,
        creased_cage,
        turning_parent,
        moving_camera,
        deforming_cage,
        moving_instances,
        held_out,
    ],
)
def test_coverage_is_that_of_cycles(scene, render, build):
    blurred(scene)
    build(scene)
    expect_coverage_of_cycles(scene, render)
