# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient Occlusion beside Cycles, as emission."""

import bpy
import numpy as np
import pytest
import scene_parts
from bounced_parts import render_bounced, surface
from node_comparison import Tree, render_both, rmse

SIZE, BLOCK = 48, 6


def blocks(picture):
    rows = SIZE // BLOCK
    return picture.reshape(rows, BLOCK, rows, BLOCK, 3).mean(axis=(1, 3))


def agree(scene, render, least=0.05):
    """Means over blocks, of 16 directions a sample; `least`: how much they differ in Cycles' picture."""
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    theirs, ours = (blocks(picture) for picture in render_both(scene, render, samples=64))
    assert theirs.std() > least
    assert rmse(theirs, ours) < 0.03 * theirs.std(), rmse(theirs, ours) / theirs.std()


def stage(scene):
    """Things on a floor; the camera looks from above."""
    bpy.ops.mesh.primitive_plane_add(size=8.0)
    things = [bpy.context.object]
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(-0.8, 0.2, 0.6), rotation=(0.0, 0.0, 0.4))
    things.append(bpy.context.object)
    bpy.ops.mesh.primitive_torus_add(location=(0.7, -0.2, 0.3), major_radius=0.6, minor_radius=0.3)
    things.append(bpy.context.object)
    scene_parts.add_camera(scene, (0, 0, 8), ortho_scale=3.5)
    return things


def occluded(things, output, distance=1.0, tilt=False, **properties):
    tree = Tree(things[0])
    node = tree.add("ShaderNodeAmbientOcclusion", **properties)
    node.inputs["Color"].default_value = (0.9, 0.5, 0.2, 1.0)
    node.inputs["Distance"].default_value = distance
    if tilt:
        node.inputs["Normal"].hide_value = True
        normal = tree.add("ShaderNodeCombineXYZ")
        normal.inputs[0].default_value, normal.inputs[2].default_value = 0.6, 0.8
        tree.link(normal.outputs[0], node.inputs["Normal"])
    tree.emit(node.outputs[output])
    for thing in things[1:]:
        thing.data.materials.append(tree.material)


@pytest.mark.parametrize("output", ["Color", "AO"])
@pytest.mark.parametrize("distance", [0.5, 2.0])
def test_outside(scene, render, output, distance):
    occluded(stage(scene), output, distance)
    agree(scene, render)


def test_about_another_normal(scene, render):
    occluded(stage(scene), "AO", tilt=True)
    agree(scene, render)


@pytest.mark.parametrize("local", [False, True])
def test_inside(scene, render, local):
    occluded(stage(scene), "AO", 0.5, inside=True, only_local=local)
    agree(scene, render)


def test_of_the_thing_alone(scene, render):
    things = stage(scene)
    occluded(things, "AO", 2.0, only_local=True)
    scene.camera.location[:2] = things[2].location[
        :2
    ]  # the ring, of which one side faces the other
    scene.camera.data.ortho_scale = 2.0
    agree(scene, render, 0.04)


def test_no_distance_is_the_worlds(scene, render):
    scene.world = bpy.data.worlds.new("World")
    scene.world.light_settings.distance = 0.7
    occluded(stage(scene), "AO", 0.0)
    agree(scene, render)


def test_what_light_passes_and_what_casts_no_shadow(scene, render):
    things = stage(scene)
    occluded(things[:1], "AO")
    glass = scene_parts.closure("Clear", "ShaderNodeBsdfTransparent")
    for thing in things[1:]:
        thing.data.materials.append(glass)
    things[2].visible_shadow = False
    agree(scene, render)


@pytest.mark.parametrize("inside", [False, True])
def test_of_a_thing_that_casts_no_shadow(scene, render, inside):
    """Its own rays meet it all the same."""
    things = stage(scene)
    occluded(things, "AO", 2.0, only_local=True, inside=inside)
    things[2].visible_shadow = False
    scene.camera.location[:2] = things[2].location[:2]
    scene.camera.data.ortho_scale = 2.0
    agree(scene, render, 0.04)


def test_in_a_mirror(scene, render):
    """What shines by it is a lamp, and all of that was asked about the same 16 directions: sharp copies of things'
    outlines (.25 of the deviation)."""
    things = stage(scene)
    occluded(things, "AO", 2.0)
    for thing in things:
        thing.location.z -= 8.0
    bpy.ops.mesh.primitive_plane_add(size=8.0, rotation=(np.pi, 0.0, 0.0), location=(0.0, 0.0, 4.0))
    surface(bpy.context.object, "ShaderNodeBsdfGlossy", (1.0, 1.0, 1.0), Roughness=0.0)
    bpy.context.object.visible_shadow = False
    scene.camera.location.z = 3.0
    scene.camera.rotation_euler = (np.pi, 0.0, 0.0)
    scene.cycles.max_bounces = 1
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    theirs, ours = (blocks(p) for p in render_bounced(scene, render, 64, limit=1, samples=64))
    assert theirs.std() > 0.05
    # Borders in mirrors are a grid's corner wide.
    assert rmse(theirs, ours) < 0.06 * theirs.std(), rmse(theirs, ours) / theirs.std()
