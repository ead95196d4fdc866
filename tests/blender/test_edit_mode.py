# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh in Edit Mode is rendered as it is being edited, beside Cycles in the same Blender."""

import bmesh
import bpy
import export_probe
import numpy as np
import pytest
import scene_parts as parts


@pytest.fixture
def cube(scene):
    """A cube of 2 m, chequered by its UV map, seen at an angle."""
    parts.add_camera(scene, ortho_scale=6.0)
    scene.render.film_transparent = True
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    cube.rotation_euler = (0.5, 0.4, 0.3)
    glow = parts.emission("Glow", (1.0, 1.0, 1.0))
    nodes, links = glow.node_tree.nodes, glow.node_tree.links
    checker, uv = nodes.new("ShaderNodeTexChecker"), nodes.new("ShaderNodeUVMap")
    links.new(uv.outputs["UV"], checker.inputs["Vector"])
    emit = next(node for node in nodes if node.type == "EMISSION")
    links.new(checker.outputs["Color"], emit.inputs["Color"])
    cube.data.materials.append(glow)
    yield cube
    if bpy.context.object is not None and bpy.context.object.mode == "EDIT":
        bpy.ops.object.mode_set(mode="OBJECT")


def edit(cube, flush):
    """Enters Edit Mode and makes the cube half as large in all directions."""
    bpy.context.view_layer.objects.active = cube
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(cube.data)
    bmesh.ops.scale(edited, vec=(0.5, 0.5, 0.5), verts=edited.verts)
    bmesh.update_edit_mesh(cube.data)
    if flush:
        cube.update_from_editmode()


def assert_as_in_cycles(scene, render, least_alpha):
    ours, theirs = (
        np.array([channels[f"ViewLayer.Combined.{c}"] for c in "RGBA"])
        for channels in parts.direct_light_of_both(scene, render, 64)
    )
    assert theirs[3].mean() > least_alpha
    # 64 samples of theirs a pixel at edges of shape and texture, up to a seventh of the pixels.
    assert np.abs(ours - theirs).mean() < 0.009
    assert np.abs(ours.mean(axis=(1, 2)) - theirs.mean(axis=(1, 2))).max() < 0.002


@pytest.mark.parametrize("flush", [True, False])
def test_what_is_edited_is_rendered(scene, cube, render, flush):
    edit(cube, flush)
    assert_as_in_cycles(scene, render, 0.05)


@pytest.mark.parametrize("flush", [True, False])
def test_its_modifiers_work_on_what_is_edited(scene, cube, render, flush):
    """Blender's own subdivision, as deep as the limit surface can be told from it: 1/256 of an edge."""
    subdivision = cube.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels = subdivision.render_levels = 4
    edit(cube, flush)
    assert_as_in_cycles(scene, render, 0.015)


def test_objects_that_share_the_mesh_show_it_too(scene, cube, render):
    other = parts.add_object(scene, "Other", cube.data, (1.5, 1.0, 0.0))
    collection = bpy.data.collections.new("Cubes")
    collection.objects.link(cube)
    empty = parts.add_object(scene, "Empty", None, (-2.0, 0.0, 0.0))
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    other.rotation_euler = (0.1, 0.2, 0.3)
    edit(cube, flush=True)
    assert_as_in_cycles(scene, render, 0.12)


def test_it_is_blurred_by_what_deforms_it(scene, cube):
    """A lattice that rises by 2 m in two frames carries the vertices with it in Edit Mode, too: between their
    middles Bezier keys go 3 t^2 - 2 t^3 from a quarter to three quarters of the way, 1.375 m."""
    lattice = parts.add_object(scene, "Lattice", bpy.data.lattices.new("Lattice"))
    lattice.scale = (4.0, 4.0, 4.0)
    modifier = cube.modifiers.new("Lattice", "LATTICE")
    modifier.object, modifier.show_in_editmode = lattice, True
    cube.rotation_euler = (0.0, 0.0, 0.0)
    for frame, z in ((0, -1.0), (2, 1.0)):
        for point in lattice.data.points:
            point.co_deform.z = point.co.z + z / 4.0
            point.keyframe_insert("co_deform", frame=frame)
    scene.frame_set(1)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    edit(cube, flush=True)
    snapshot, report, _ = export_probe.through_engine(scene)
    points = export_probe.geometry_of(snapshot, "Cube")["points"]
    assert len(points) > 1, report.entries()
    rise = points[-1] - points[0]
    assert np.abs(rise - (0.0, 0.0, 1.375)).max() < 1e-3, rise
