# SPDX-License-Identifier: GPL-3.0-or-later
"""The exported camera against Blender's own `world_to_camera_view`."""

import math
import random

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Matrix, Vector

from granita.export import ExportError


def project(camera, point):
    """Pixels (x, y) of a world-space point, by the snapshot's own formula."""
    world_from_camera = camera["world_from_camera"][0]
    x, y, z, _ = np.linalg.inv(world_from_camera) @ np.append(point, 1.0)
    depth = z if camera["kind"] == "PERSPECTIVE" else 1.0
    (sx, sy), (cx, cy) = camera["scale"], camera["center"]
    return cx + sx * x / depth, cy + sy * y / depth, z


def random_camera(scene, generator):
    thing = scene_parts.add_camera(scene)
    data = thing.data
    data.type = generator.choice(["PERSP", "ORTHO"])
    data.lens = generator.uniform(10, 150)
    data.sensor_fit = generator.choice(["AUTO", "HORIZONTAL", "VERTICAL"])
    data.sensor_width = generator.uniform(10, 50)
    data.sensor_height = generator.uniform(10, 50)
    data.ortho_scale = generator.uniform(1, 20)
    data.shift_x, data.shift_y = generator.uniform(-1, 1), generator.uniform(-1, 1)
    thing.location = [generator.uniform(-9, 9) for _ in range(3)]
    thing.rotation_euler = [generator.uniform(-3, 3) for _ in range(3)]
    thing.scale = [generator.uniform(0.2, 4) for _ in range(3)]
    render = scene.render
    render.resolution_x, render.resolution_y = (
        generator.randint(10, 4000),
        generator.randint(10, 4000),
    )
    render.resolution_percentage = generator.choice([100, 50, 33])
    render.pixel_aspect_x, render.pixel_aspect_y = generator.choice([(1, 1), (2, 1), (1, 1.5)])
    return thing


@pytest.mark.parametrize("seed", range(40))
def test_projection_is_blenders(scene, seed):
    generator = random.Random(seed)
    thing = random_camera(scene, generator)
    snapshot, _ = export_probe.through_script()
    width, height = snapshot["options"]["width"], snapshot["options"]["height"]
    percentage = scene.render.resolution_percentage
    assert (width, height) == (
        int(scene.render.resolution_x * percentage / 100),
        int(scene.render.resolution_y * percentage / 100),
    )
    if percentage != 100:
        # world_to_camera_view works with the frame before the percentage, whose sides may have
        # another ratio by rounding.
        scene.render.resolution_x, scene.render.resolution_y = width, height
        scene.render.resolution_percentage = 100
        bpy.context.view_layer.update()
    for _ in range(5):
        local = Vector(
            [generator.uniform(-2, 2), generator.uniform(-2, 2), -generator.uniform(1, 20)]
        )
        point = thing.matrix_world.normalized() @ local
        expected = world_to_camera_view(scene, thing, point)
        x, y, z = project(snapshot["camera"], point)
        # Blender's answer has single precision; shifts of a frame and more multiply its error.
        assert x / width == pytest.approx(expected.x, abs=2e-4)
        assert y / height == pytest.approx(expected.y, abs=2e-4)
        assert z == pytest.approx(expected.z, rel=1e-4)


def test_lens(scene):
    thing = scene_parts.add_camera(scene, (0, 0, 5))
    data = thing.data
    data.lens = 100.0
    data.dof.use_dof = True
    data.dof.aperture_fstop = 2.0
    data.dof.focus_distance = 3.0
    data.dof.aperture_blades = 6
    data.dof.aperture_rotation = 0.5
    data.dof.aperture_ratio = 2.0
    camera = export_probe.through_script()[0]["camera"]
    assert camera["lens_radius"] == pytest.approx(0.025)
    assert camera["focus_distance"] == pytest.approx(3.0)
    assert camera["blades"] == 6
    assert camera["blade_rotation"] == pytest.approx(0.5)
    assert camera["lens_ratio"] == pytest.approx(2.0)


def test_focus_object_counts_along_the_view(scene):
    thing = scene_parts.add_camera(scene, (0, 0, 5))
    thing.data.dof.use_dof = True
    thing.data.dof.focus_object = scene_parts.add_object(scene, "Target", None, (3, 4, -2))
    camera = export_probe.through_script()[0]["camera"]
    assert camera["focus_distance"] == pytest.approx(7.0)


def test_focus_on_a_bone_is_on_its_pose(scene):
    """The bone starts 2 m from the armature and is posed 1 m further from the camera."""
    armature = bpy.data.armatures.new("Armature")
    holder = scene_parts.add_object(scene, "Armature", armature, (0, 0, -2))
    bpy.context.view_layer.objects.active = holder
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.edit_bones.new("Bone")
    bone.head, bone.tail = (0, 0, -2), (0, 0, -3)
    bpy.ops.object.mode_set(mode="OBJECT")
    holder.pose.bones["Bone"].location = (0, 1, 0)  # along the bone
    thing = scene_parts.add_camera(scene, (0, 0, 5))
    thing.data.dof.use_dof = True
    thing.data.dof.focus_object = holder
    thing.data.dof.focus_subtarget = "Bone"
    camera = export_probe.through_script()[0]["camera"]
    assert camera["focus_distance"] == pytest.approx(10.0)


def test_focus_on_the_camera_itself_is_reported(scene):
    thing = scene_parts.add_camera(scene, (0, 0, 5))
    thing.data.dof.use_dof = True
    thing.data.dof.focus_object = thing
    snapshot, report = export_probe.through_script()
    assert snapshot["camera"]["lens_radius"] == 0.0
    assert report.entries()[0][0] == "camera 'Camera'"


def test_depth_of_field_off_is_a_pinhole(scene):
    scene_parts.add_camera(scene)
    assert export_probe.through_script()[0]["camera"]["lens_radius"] == 0.0


def test_scaled_parent_leaves_the_camera_unscaled(scene):
    thing = scene_parts.add_camera(scene, (0, 0, 5))
    thing.parent = scene_parts.add_object(scene, "Parent", None)
    thing.parent.matrix_world = Matrix.Diagonal((3, 3, 3, 1))
    bpy.context.view_layer.update()
    axes = export_probe.through_script()[0]["camera"]["world_from_camera"][0][:3, :3]
    assert axes == pytest.approx(np.diag([1, 1, -1]), abs=1e-6)


def test_driven_lens_is_read_from_the_evaluated_camera(scene):
    thing = scene_parts.add_camera(scene)
    thing.data.sensor_width = 36.0
    driver = thing.data.driver_add("lens").driver
    driver.expression = "20 + frame"
    scene.frame_set(10)
    camera = export_probe.through_engine(scene)[0]["camera"]
    assert camera["scale"][0] == pytest.approx(64 * 30 / 36, rel=1e-6)


def no_camera(scene):
    return "scene 'Scene'", "no camera"


def panorama(scene):
    scene_parts.add_camera(scene).data.type = "PANO"
    return "camera 'Camera'", "PANO"


def no_extent(scene):
    scene_parts.add_camera(scene).scale = (1, 0, 1)
    return "camera 'Camera'", "scale"


def clips_everything(scene):
    data = scene_parts.add_camera(scene).data
    data.clip_start, data.clip_end = 10, 1
    return "camera 'Camera'", "clips"


@pytest.mark.parametrize("break_it", [no_camera, panorama, no_extent, clips_everything])
def test_unusable_cameras_are_named(scene, break_it):
    named, said = break_it(scene)
    bpy.context.view_layer.update()
    with pytest.raises(ExportError) as caught:
        export_probe.through_script()
    assert named in str(caught.value) and said in str(caught.value)


def test_an_object_that_is_no_camera_is_named(scene):
    scene.camera = scene_parts.add_object(scene, "Empty", None)
    _, report = export_probe.through_script()
    lens = 50 if bpy.app.version < (5, 1) else 35
    message = f"is no camera object: seen through a lens of {lens} mm"
    assert report.entries() == [("camera 'Empty'", message, 1)]


def test_border(scene):
    scene_parts.add_camera(scene)
    render = scene.render
    render.resolution_x, render.resolution_y = 101, 67
    render.use_border = True
    render.border_min_x, render.border_max_x = 0.26, 0.75
    render.border_min_y, render.border_max_y = 0.25, 0.713
    for crop in (False, True):
        render.use_crop_to_border = crop
        options = export_probe.through_script()[0]["options"]
        assert options["crop"].tolist() == [26, 16, 75, 47]
        assert (options["width"], options["height"]) == (101, 67)
    render.border_max_x = 0.261
    with pytest.raises(ExportError, match="border"):
        export_probe.through_script()


def test_shutter_curve(scene):
    scene_parts.add_camera(scene)
    assert len(export_probe.through_script()[0]["options"]["shutter_curve"]) == 0
    points = scene.render.motion_blur_shutter_curve.curves[0].points
    while len(points) > 2:
        points.remove(points[1])
    points[0].location, points[1].location = (0, 0), (1, 1)
    for point in points:
        point.handle_type = "VECTOR"
    scene.render.motion_blur_shutter_curve.update()
    curve = export_probe.through_script()[0]["options"]["shutter_curve"]
    # A straight ramp; Blender tabulates curves with an error of about 1e-3.
    assert curve == pytest.approx(np.linspace(0, 1, 257), abs=2e-3)


def test_options_come_from_blender_and_from_the_scene(scene):
    scene_parts.add_camera(scene)
    scene.frame_set(7)
    scene.render.film_transparent = True
    scene.render.threads_mode, scene.render.threads = "FIXED", 3
    bpy.context.view_layer.use_pass_z = True
    options = export_probe.through_script()[0]["options"]
    assert (options["frame"], options["threads"]) == (7, 3)
    assert options["film_transparent"] and options["depth_pass"]
    assert math.isclose(options["frame_time"], 0.5)
