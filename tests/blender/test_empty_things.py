# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that hold nothing to see leave the rest of the picture as it is, and are no fault."""

import bpy
import numpy as np
import pytest
import scene_parts as parts


def empty_mesh(scene):
    parts.add_object(scene, "Thing", bpy.data.meshes.new("Thing"))


def loose_edges(scene):
    mesh = bpy.data.meshes.new("Thing")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 1), (1, 2)], [])
    parts.add_object(scene, "Thing", mesh)


def hair_curves(scene):
    parts.add_object(scene, "Thing", bpy.data.hair_curves.new("Thing"))


def curve(scene):
    parts.add_object(scene, "Thing", bpy.data.curves.new("Thing", "CURVE"))


def text(scene):
    data = bpy.data.curves.new("Thing", "FONT")
    data.body = ""
    parts.add_object(scene, "Thing", data)


def metaball(scene):
    parts.add_object(scene, "Thing", bpy.data.metaballs.new("Thing"))


def lattice(scene):
    parts.add_object(scene, "Thing", bpy.data.lattices.new("Thing"))


def armature(scene):
    parts.add_object(scene, "Thing", bpy.data.armatures.new("Thing"))


def instances_of_nothing(scene):
    thing = parts.add_object(scene, "Thing", None)
    thing.instance_type = "COLLECTION"
    thing.instance_collection = bpy.data.collections.new("Empty")


def instances_of_a_camera(scene):
    instances_of_nothing(scene)
    bpy.data.collections["Empty"].objects.link(scene.camera)


KINDS = [
    empty_mesh,
    loose_edges,
    hair_curves,
    curve,
    text,
    metaball,
    lattice,
    armature,
    instances_of_nothing,
    instances_of_a_camera,
]


@pytest.mark.parametrize("moves", [False, True], ids=["still", "moving"])
@pytest.mark.parametrize("build", KINDS)
def test_what_is_empty_leaves_the_rest(scene, render, build, moves, capfd):
    parts.add_camera(scene)
    parts.add_square(scene, material=parts.emission("Glow", (0.25, 0.5, 0.75)))
    scene.render.use_motion_blur = moves
    expected = render(scene)
    build(scene)
    if moves:
        thing = bpy.data.objects["Thing"]
        for frame in (0, 2):
            thing.location.x = frame
            thing.keyframe_insert("location", frame=frame)
    capfd.readouterr()
    found = render(scene)
    assert "Warning" not in capfd.readouterr().out
    for name, plane in expected.items():
        np.testing.assert_array_equal(found[name], plane)
