# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen of whole scenes, against Cycles: lenses, cages, instances, motion.

Only coverage (alpha) is compared, in blocks of 8 by 8 pixels.  Both renderers take 64 samples a
pixel; where every pixel of a block is half covered, a block's mean is off by .5 / 64 = .008, the
difference of two by .011, if samples were independent (stratified ones do better).
"""

import math

import bpy
import numpy as np
import pytest
import scene_parts
from motion_parts import drive, set_position, shape_key

SAMPLES = 64
BLOCK = 8
LIMIT = 0.011


def coverage(scene, render, engine):
    """float32 [blocks up, blocks across]: mean alpha."""
    scene.render.engine = engine
    passes = render(scene, engine)
    alpha = next(values for key, values in passes.items() if key.endswith("Combined.A"))
    height, width = alpha.shape
    return alpha.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK).mean(axis=(1, 3))


def monkey(size):
    """In triangles: a quad that is not flat is a curved patch here, two triangles in Cycles."""
    bpy.ops.mesh.primitive_monkey_add(size=size)
    bpy.context.object.modifiers.new("Triangulate", "TRIANGULATE")


def shifted_narrow_pixels(scene):
    camera = scene_parts.add_camera(scene, (1, -6, 2))
    camera.rotation_euler = (1.3, 0.2, 0.1)
    camera.data.shift_x, camera.data.shift_y = 0.1, -0.05
    camera.data.sensor_fit = "VERTICAL"
    scene.render.pixel_aspect_y = 1.5
    monkey(2)


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
    modifier = cube.modifiers.new("Subsurf", "SUBSURF")
    modifier.render_levels = 5
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
    monkey(3)


def deforming_cage(scene):
    scene_parts.add_camera(scene, (0, -8, 0)).rotation_euler.x = math.pi / 2
    bpy.ops.mesh.primitive_cube_add(size=2)
    cube = bpy.context.object
    drive(shape_key(cube, lift=2.0), "value", "(frame - 9) / 2")
    cube.modifiers.new("Subsurf", "SUBSURF").render_levels = 4


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
    scene.render.film_transparent = True
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 1.0
    set_position(scene, "CENTER")
    scene.frame_set(10)
    build(scene)
    # Cycles places knots at 2^steps + 1 times; as many are ours.
    for thing in scene.objects:
        thing.cycles.motion_steps = 3
    scene.granita.motion_steps = 9
    scene.granita.samples = SAMPLES
    scene.granita.pixel_filter, scene.granita.filter_width = "BOX", 1.0
    scene.cycles.samples = SAMPLES
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1.0
    ours, theirs = coverage(scene, render, "GRANITA"), coverage(scene, render, "CYCLES")
    print(
        "RMS",
        build.__name__,
        np.sqrt(((ours - theirs) ** 2).mean()),
        abs(ours - theirs).max(),
        ours.mean(),
    )
    assert 0.02 < ours.mean() < 0.98
    difference = ours - theirs
    assert np.sqrt((difference**2).mean()) < LIMIT, difference.round(3)
    assert abs(difference).max() < 4 * LIMIT, difference.round(3)
