# SPDX-License-Identifier: GPL-3.0-or-later
"""Every modifier that deforms, at the knots of the shutter; Blender's own evaluation is the truth."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from export_probe import geometry_of
from motion_parts import drive, shape_key, with_shutter

TIMES = (9.75, 10.25)


@pytest.fixture
def moving(scene):
    return with_shutter(scene)


def sheet(scene, name="Sheet"):
    """8 by 8 faces."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=2.0)
    bpy.context.object.name = name
    return bpy.context.object


def lattice(scene, thing):
    data = bpy.data.lattices.new("Lattice")
    frame = scene_parts.add_object(scene, "Lattice", data)
    frame.scale = (3, 3, 3)
    thing.modifiers.new("Lattice", "LATTICE").object = frame
    key = shape_key(frame, lift=0.0)
    key.data[0].co.z -= 1.0
    drive(key, "value", "(frame - 9) / 2")


def hook(scene, thing):
    empty = scene_parts.add_object(scene, "Hook", None)
    modifier = thing.modifiers.new("Hook", "HOOK")
    modifier.object = empty
    modifier.vertex_indices_set(range(20))
    drive(empty, "location", "frame / 10", 2)


def bound(thing, operator, modifier):
    with bpy.context.temp_override(object=thing, active_object=thing):
        assert operator(modifier=modifier.name) == {"FINISHED"}


def mesh_deform(scene, thing):
    bpy.ops.mesh.primitive_cube_add(size=4.0)
    cage = bpy.context.object
    key = shape_key(cage, lift=0.5)
    modifier = thing.modifiers.new("Deform", "MESH_DEFORM")
    modifier.object, modifier.precision = cage, 3
    bound(thing, bpy.ops.object.meshdeform_bind, modifier)
    drive(key, "value", "(frame - 9) / 2")


def surface_deform(scene, thing):
    target = sheet(scene, "Target")
    modifier = thing.modifiers.new("Deform", "SURFACE_DEFORM")
    modifier.target = target
    bound(thing, bpy.ops.object.surfacedeform_bind, modifier)
    drive(shape_key(target), "value", "(frame - 9) / 2")


def wave(scene, thing):
    thing.modifiers.new("Wave", "WAVE").height = 0.5


def ocean(scene, thing):
    modifier = thing.modifiers.new("Ocean", "OCEAN")
    modifier.geometry_mode, modifier.resolution, modifier.spatial_size = "DISPLACE", 4, 2
    modifier.viewport_resolution = 4
    drive(modifier, "time", "frame / 10")


def displace(scene, thing):
    modifier = thing.modifiers.new("Displace", "DISPLACE")
    modifier.direction = "Z"
    drive(modifier, "strength", "frame / 10")


def simple_deform(scene, thing):
    modifier = thing.modifiers.new("Twist", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis = "TWIST", "X"
    drive(modifier, "angle", "frame / 20")


def cast(scene, thing):
    drive(thing.modifiers.new("Cast", "CAST"), "factor", "(frame - 9) / 2")


def shrinkwrap(scene, thing):
    target = scene_parts.add_square(scene, "Ground", 9.0, (0, 0, -1))
    target.rotation_euler = (0.3, 0.2, 0)
    thing.modifiers.new("Wrap", "SHRINKWRAP").target = target
    drive(target, "location", "-frame / 10", 2)


def pinned(thing):
    group = thing.vertex_groups.new(name="Pin")
    group.add(range(9), 1.0, "REPLACE")
    return group.name


def cloth(scene, thing):
    thing.modifiers.new("Cloth", "CLOTH").settings.vertex_group_mass = pinned(thing)


def soft_body(scene, thing):
    thing.modifiers.new("Soft", "SOFT_BODY").settings.vertex_group_goal = pinned(thing)


def armature(scene, thing):
    bpy.ops.object.armature_add()
    bones = bpy.context.object
    thing.vertex_groups.new(name=bones.data.bones[0].name).add(range(40), 1.0, "REPLACE")
    thing.modifiers.new("Armature", "ARMATURE").object = bones
    bones.pose.bones[0].rotation_mode = "XYZ"
    drive(bones.pose.bones[0], "rotation_euler", "frame / 20", 0)


BUILDS = [
    lattice,
    hook,
    mesh_deform,
    surface_deform,
    wave,
    ocean,
    displace,
    simple_deform,
    cast,
    shrinkwrap,
    cloth,
    soft_body,
    armature,
]
SIMULATED = {cloth, soft_body}


def evaluated(scene, thing, time):
    scene.frame_set(int(time), subframe=time % 1.0)
    mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    points = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", points.reshape(-1))
    return points


def bake(scene):
    """All caches of the file, frames 1 to 20."""
    scene.frame_end = 20
    bpy.ops.ptcache.bake_all(bake=True)


@pytest.mark.parametrize("as_cage", [False, True], ids=["mesh", "cage"])
@pytest.mark.parametrize("build", BUILDS)
def test_the_shape_at_the_knots_is_blenders(moving, build, as_cage):
    thing = sheet(moving)
    build(moving, thing)
    if build in SIMULATED:
        bake(moving)
    expected = np.stack([evaluated(moving, thing, time) for time in TIMES])
    assert np.abs(expected[1] - expected[0]).max() > 1e-3
    moving.frame_set(10)
    if as_cage:
        scene_parts.add_subsurf(thing, 2)
    snapshot, report, _ = export_probe.through_engine(moving, motion_steps=3)
    geometry = geometry_of(snapshot, "Sheet")
    assert ("subdivision" in geometry) == as_cage
    points = geometry["points"]
    assert points[[0, -1]] == pytest.approx(expected, abs=2e-6)
    assert len(report) == 0


def tube(scene):
    curve = bpy.data.curves.new("Tube", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(2)
    for point, place in zip(spline.points, ((0, 0, 0, 1), (1, 0, 0, 1), (2, 1, 0, 1))):
        point.co = place
    drive(curve, "bevel_depth", "frame / 100")
    return scene_parts.add_object(scene, "Tube", curve)


def nurbs(scene):
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    lattice(scene, bpy.context.object)
    return bpy.context.object


def text(scene):
    bpy.ops.object.text_add()
    drive(bpy.context.object.data, "offset_y", "frame / 10")
    return bpy.context.object


def ball(scene):
    bpy.ops.object.metaball_add()
    drive(bpy.context.object, "location", "frame", 0)
    return bpy.context.object


@pytest.mark.parametrize("make", [tube, nurbs, text])
def test_what_blender_makes_meshes_of(moving, make):
    thing = make(moving)
    expected = []
    for time in TIMES:
        moving.frame_set(int(time), subframe=time % 1.0)
        mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        expected.append([tuple(vertex.co) for vertex in mesh.vertices])
    moving.frame_set(10)
    snapshot, report, _ = export_probe.through_engine(moving, motion_steps=3)
    points = geometry_of(snapshot, thing.name)["points"]
    assert np.abs(np.subtract(*expected)).max() > 1e-3
    assert points[[0, -1]] == pytest.approx(np.float32(expected), abs=2e-6)
    assert len(report) == 0


def test_metaballs_move(moving):
    thing = ball(moving)
    snapshot, _, _ = export_probe.through_engine(moving)
    assert export_probe.knots_of(snapshot, thing.name)[:, 0, 3] == pytest.approx(TIMES)
