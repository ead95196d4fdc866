# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves in ways that no closed form says, against Cycles: coverage in blocks of 8 by 8 pixels
(cycles_coverage, where the limits come from)."""

import bpy
import pytest
import scene_parts
from cycles_coverage import blurred, expect_coverage_of_cycles
from motion_parts import drive
from node_parts import instances_on_line, with_nodes


def cube(name="Cube", location=(0, 0, 0), size=1.0):
    bpy.ops.mesh.primitive_cube_add(size=size, location=location)
    bpy.context.object.name = name
    return bpy.context.object


def letters_that_drift_apart(scene):
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.align_x, text.extrude = "Hello", "CENTER", 0.1
    scene_parts.add_object(scene, "Text", text).scale = (1.3, 1.3, 1.3)
    drive(text, "space_character", "1 + 0.3 * (frame - 10)")


def a_rigid_body_that_falls(scene):
    """Baked."""
    bpy.ops.rigidbody.world_add()
    world = scene.rigidbody_world
    world.collection = world.collection or bpy.data.collections.new("Bodies")
    body = cube(location=(0, 0, 1), size=1.2)
    body.rotation_euler = (0.5, 0.3, 0.0)
    bpy.ops.rigidbody.object_add()
    cube("Floor", (0, 0, -1.2), 2.0)
    bpy.ops.rigidbody.object_add(type="PASSIVE")
    scene.frame_end = 20
    with bpy.context.temp_override(point_cache=world.point_cache):
        bpy.ops.ptcache.bake(bake=True)
    scene.camera.location, scene.camera.rotation_euler.x = (0, -6, 1), 1.4


def a_bone_that_bends(scene):
    bpy.ops.object.armature_add()
    armature = bpy.context.object
    armature.data.bones[0].bbone_segments = 8
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.data.edit_bones[0]
    bone.head, bone.tail = (-1.5, 0, 0), (1.5, 0, 0)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=16, y_subdivisions=2, size=2.0)
    arm = bpy.context.object
    arm.scale, arm.parent = (1.5, 0.3, 1.0), armature
    arm.modifiers.new("Armature", "ARMATURE").object = armature
    group = arm.vertex_groups.new(name=armature.data.bones[0].name)
    group.add(range(len(arm.data.vertices)), 1.0, "ADD")
    for curve in ("bbone_curveinz", "bbone_curveoutz", "bbone_curveoutx"):
        drive(armature.pose.bones[0], curve, "2 * (frame - 10)")


def instances_that_nodes_turn(scene, realized=False):
    instances_on_line(scene, cube("Part", size=0.8), 2)
    host = scene.objects["Host"]
    host.location.x = -1.5

    def build(nodes, links, geometry):
        turn = nodes.new("GeometryNodeRotateInstances")
        turn.name = "Turn"
        links.new(geometry, turn.inputs[0])
        if not realized:
            return turn.outputs[0]
        real = nodes.new("GeometryNodeRealizeInstances")
        links.new(turn.outputs[0], real.inputs[0])
        return real.outputs[0]

    tree = with_nodes(host, build, "Turn").modifiers[1].node_group
    drive(tree, 'nodes["Turn"].inputs["Rotation"].default_value', "1.2 * (frame - 10)", 2)


def what_nodes_realize(scene):
    instances_that_nodes_turn(scene, realized=True)


def a_screw_that_opens(scene):
    line = scene_parts.add_mesh(scene, "Line", [(0.5, 0, 0), (1.5, 0, 0.2)], [])
    line.data.edges.add(1)
    line.data.edges[0].vertices = (0, 1)
    screw = line.modifiers.new("Screw", "SCREW")
    screw.steps = screw.render_steps = 32
    drive(screw, "angle", "3 + 2 * (frame - 10)")


def a_simulation_of_nodes(scene):
    """It goes .2 metres a frame."""

    def build(nodes, links, geometry):
        begin = nodes.new("GeometryNodeSimulationInput")
        end = nodes.new("GeometryNodeSimulationOutput")
        begin.pair_with_output(end)
        step = nodes.new("GeometryNodeSetPosition")
        step.inputs["Offset"].default_value = (0.2, 0.0, 0.0)
        links.new(geometry, begin.inputs[0])
        links.new(begin.outputs[1], step.inputs[0])
        links.new(step.outputs[0], end.inputs[1])
        return end.outputs[0]

    with_nodes(cube(location=(-1.8, 0, 0)), build)
    for frame in range(1, 13):
        scene.frame_set(frame)
    scene.frame_set(10)


BUILDS = [
    letters_that_drift_apart,
    a_rigid_body_that_falls,
    a_bone_that_bends,
    instances_that_nodes_turn,
    what_nodes_realize,
    a_screw_that_opens,
]
if hasattr(bpy.types, "GeometryNodeSimulationInput"):
    BUILDS.append(a_simulation_of_nodes)


@pytest.mark.parametrize("build", BUILDS)
def test_what_moves_covers_what_it_covers_in_cycles(scene, render, build):
    blurred(scene)
    scene_parts.add_camera(scene, (0, 0, 7))
    build(scene)
    expect_coverage_of_cycles(scene, render)
