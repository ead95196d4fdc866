# SPDX-License-Identifier: GPL-3.0-or-later
"""What animators build, against Cycles: coverage in blocks of 8 by 8 pixels (cycles_coverage, where the limits
come from)."""

import bpy
import pytest
import scene_parts
from cycles_coverage import blurred, expect_coverage_of_cycles
from motion_parts import drive, shape_key
from node_parts import with_nodes


def cube(name, location=(0, 0, 0), size=1.0):
    bpy.ops.mesh.primitive_cube_add(size=size, location=location)
    bpy.context.object.name = name
    return bpy.context.object


def grid(cells, size):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cells, y_subdivisions=cells, size=size)
    return bpy.context.object


def a_camera_on_a_path_that_tracks(scene):
    bpy.ops.curve.primitive_bezier_circle_add(radius=6)
    path = bpy.context.object
    camera = scene.camera
    camera.location = (0, 0, 3)
    follow = camera.constraints.new("FOLLOW_PATH")
    follow.target, follow.use_fixed_location = path, True
    drive(follow, "offset_factor", "frame / 20")
    track = camera.constraints.new("TRACK_TO")
    track.target = scene_parts.add_object(scene, "Target", None)
    track.track_axis, track.up_axis = "TRACK_NEGATIVE_Z", "UP_Y"
    cube("Middle", size=1.5)
    cube("Beside", (2, 1, 0))


def an_arm_with_inverse_kinematics(scene):
    bpy.ops.object.armature_add()
    armature = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    upper = armature.data.edit_bones[0]
    upper.name = "Upper"
    upper.head, upper.tail = (-2, 0, 0), (0, 0.3, 0)
    lower = armature.data.edit_bones.new("Lower")
    lower.head, lower.tail, lower.parent, lower.use_connect = upper.tail, (2, 0, 0), upper, True
    bpy.ops.object.mode_set(mode="OBJECT")
    goal = scene_parts.add_object(scene, "Goal", None, (1.4, 0.2, 0))
    drive(goal, "location", "1.2 * (frame - 10)", 1)
    armature.pose.bones["Lower"].constraints.new("IK").target = goal
    skin = grid(16, 2.0)
    skin.scale = (2, 0.4, 1)
    bpy.ops.object.transform_apply(scale=True)
    for bone, side in (("Upper", -1), ("Lower", 1)):
        group = skin.vertex_groups.new(name=bone)
        for vertex in skin.data.vertices:
            group.add([vertex.index], min(max(0.5 + side * vertex.co.x, 0.0), 1.0), "ADD")
    skin.modifiers.new("Armature", "ARMATURE").object = armature
    scene_parts.add_subsurf(skin, 2)


def a_thing_that_is_handed_over(scene):
    """From one parent to another, by influences that are animated."""
    thing = cube("Thing", (0, 1, 0))
    for name, property, index, weight in (
        ("Left", "location", 0, "10.5 - frame"),
        ("Right", "rotation_euler", 2, "frame - 9.5"),
    ):
        parent = scene_parts.add_object(scene, name, None)
        drive(parent, property, "frame - 10", index)
        hold = thing.constraints.new("CHILD_OF")
        hold.target = parent
        drive(hold, "influence", weight)


def a_row_along_an_object(scene):
    offset = scene_parts.add_object(scene, "Offset", None, (0.9, 0, 0))
    drive(offset, "rotation_euler", "0.8 * (frame - 10)", 2)
    row = cube("Row", (-1.5, 0, 0), 0.8).modifiers.new("Array", "ARRAY")
    row.use_relative_offset, row.use_object_offset = False, True
    row.offset_object, row.count = offset, 5


def faces_that_carry_things(scene):
    plane = grid(3, 3)
    plane.instance_type, plane.use_instance_faces_scale = "FACES", True
    plane.show_instancer_for_render = False
    cube("Part", size=0.6).parent = plane
    drive(plane, "rotation_euler", "1.2 * (frame - 10)", 2)
    drive(shape_key(plane), "value", "frame - 10")


def what_turns_on_a_surface_that_bends(scene):
    plane = grid(5, 3)
    part = cube("Part", (0, 0, -90), 0.4)
    drive(shape_key(plane, lift=1.5), "value", "frame - 10")
    drive(plane, "rotation_euler", "0.5 * (frame - 10)", 0)

    def build(nodes, links, geometry):
        info = nodes.new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = part
        place = nodes.new("GeometryNodeInstanceOnPoints")
        turn = nodes.new("GeometryNodeRotateInstances")
        turn.name = "Turn"
        links.new(geometry, place.inputs["Points"])
        links.new(info.outputs["Geometry"], place.inputs["Instance"])
        links.new(place.outputs[0], turn.inputs[0])
        return turn.outputs[0]

    tree = with_nodes(plane, build, "Turn").modifiers[-1].node_group
    drive(tree, 'nodes["Turn"].inputs["Rotation"].default_value', "2 * (frame - 10)", 2)


def what_bends_through_a_lattice_along_a_curve(scene):
    bar = cube("Bar")
    bar.scale = (2, 0.3, 0.3)
    bpy.ops.object.transform_apply(scale=True)
    cells = bar.modifiers.new("Cells", "SUBSURF")
    cells.subdivision_type, cells.levels, cells.render_levels = "SIMPLE", 4, 4
    cage = scene_parts.add_object(scene, "Cage", bpy.data.lattices.new("Cage"))
    cage.scale = (2, 1, 1)
    bar.modifiers.new("Lattice", "LATTICE").object = cage
    drive(cage, "rotation_euler", "0.8 * (frame - 10)", 2)
    bpy.ops.curve.primitive_bezier_curve_add(radius=2)
    bar.modifiers.new("Curve", "CURVE").object = bpy.context.object
    drive(bar, "location", "frame - 10", 0)


def curled_hair_with_children(scene, blurs=True):
    """It runs to the eye."""
    skin = grid(10, 2)
    skin.modifiers.new("Hair", "PARTICLE_SYSTEM")
    hair = skin.particle_systems[0].settings
    hair.type, hair.count, hair.hair_length = "HAIR", 60, 1.0
    hair.child_type, hair.rendered_child_count = "INTERPOLATED", 8
    hair.root_radius, hair.radius_scale = 4.0, 0.01
    hair.kink, hair.kink_amplitude, hair.roughness_1 = "CURL", 0.1, 0.1
    skin.show_instancer_for_render = False
    scene.render.use_motion_blur = blurs
    drive(shape_key(skin, lift=0.5), "value", "frame - 10")
    drive(skin, "rotation_euler", "frame - 10", 1)


def curled_hair_that_stands(scene):
    curled_hair_with_children(scene, blurs=False)


@pytest.mark.parametrize(
    "build",
    [
        a_camera_on_a_path_that_tracks,
        an_arm_with_inverse_kinematics,
        a_thing_that_is_handed_over,
        a_row_along_an_object,
        faces_that_carry_things,
        what_turns_on_a_surface_that_bends,
        what_bends_through_a_lattice_along_a_curve,
        curled_hair_with_children,
        curled_hair_that_stands,
    ],
)
def test_what_animators_build_covers_what_it_covers_in_cycles(scene, render, build):
    blurred(scene)
    scene_parts.add_camera(scene, (0, 0, 7))
    build(scene)
    expect_coverage_of_cycles(scene, render)
