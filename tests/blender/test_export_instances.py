# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances of every kind: how many, sharing what, seen by whom, under which key."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from mesh_parts import cube_in_view  # noqa: F401
from node_parts import hidden_collection, instances_on_line

from granita.export import Cancelled


def instances_of(snapshot, name):
    """Indices of the instances of an object."""
    return [i for i, own in enumerate(snapshot["instances"]["name"]) if own == name]


def collection_instances(scene, cube, count=5):
    collection = hidden_collection(scene, cube)
    for i in range(count):
        empty = scene_parts.add_object(scene, f"Place{i}", None, (3 * i, 0, 0))
        empty.instance_type = "COLLECTION"
        empty.instance_collection = collection
    return count


def on_vertices(scene, cube):
    grid = scene_parts.add_mesh(scene, "Grid", [(3 * i, 0, 0) for i in range(7)], [])
    cube.parent = grid
    grid.instance_type = "VERTS"
    # With show_instancer_for_render the grid itself is there too, but it has no faces.
    return 7


def on_faces(scene, cube):
    verts = [(x, y, 0) for y in range(3) for x in range(4)]
    faces = [(i, i + 1, i + 5, i + 4) for i in (0, 1, 2, 4, 5, 6)]
    grid = scene_parts.add_mesh(scene, "Grid", verts, faces)
    cube.parent = grid
    grid.instance_type = "FACES"
    grid.show_instancer_for_render = False
    grid.show_instancer_for_viewport = False
    return 6


def by_particles(scene, cube):
    emitter = scene_parts.add_square(scene, "Emitter", 10.0)
    emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
    emitter.show_instancer_for_render = False
    emitter.show_instancer_for_viewport = False
    settings = emitter.particle_systems[0].settings
    settings.count = 11
    settings.frame_start, settings.frame_end = 0, 1
    settings.lifetime = 100
    settings.render_type = "OBJECT"
    settings.instance_object = cube
    hidden_collection(scene, cube)
    scene.frame_set(0)
    scene.frame_set(5)
    return 11


def by_nodes(scene, cube, count=9):
    instances_on_line(scene, cube, count)
    return count


@pytest.mark.smoke
@pytest.mark.parametrize(
    "make", [collection_instances, on_vertices, on_faces, by_particles, by_nodes]
)
def test_instances_share_one_geometry(scene, cube, make):
    count = make(scene, cube)
    bpy.context.view_layer.update()
    snapshot, report, _ = export_probe.through_engine(scene)
    placed = instances_of(snapshot, "Cube")
    assert len(placed) == count
    assert len(snapshot["instances"]["name"]) == count
    assert len(snapshot["geometries"]) == 1
    assert len(np.unique(snapshot["instances"]["key"])) == count
    assert len(report) == 0


@pytest.mark.parametrize("make", [collection_instances, by_nodes])
def test_instances_of_a_subsurf_share_one_cage(scene, cube, make):
    scene_parts.add_subsurf(cube, 2)
    count = make(scene, cube)
    snapshot, _, _ = export_probe.through_engine(scene)
    assert len(snapshot["instances"]["name"]) == count
    assert len(snapshot["geometries"]) == 1
    assert snapshot["geometries"][0]["points"].shape == (1, 8, 3)
    assert "subdivision" in snapshot["geometries"][0]


def test_places(scene, cube):
    collection_instances(scene, cube, 3)
    bpy.data.objects["Place1"].rotation_euler = (0, 0, np.pi / 2)
    cube.location = (1, 0, 0)
    snapshot, _, _ = export_probe.through_engine(scene)
    matrices = snapshot["instances"]["world_from_object"]
    assert matrices.dtype == np.float64 and snapshot["instances"]["knots"].tolist() == [1, 1, 1]
    assert matrices[:, :3, 3] == pytest.approx(
        np.array([(1, 0, 0), (3, 1, 0), (7, 0, 0)]), abs=1e-6
    )
    assert matrices[1, :2, :2] == pytest.approx(np.array([(0, -1), (1, 0)]), abs=1e-6)


@pytest.mark.parametrize("hidden", [False, True], ids=["shown", "hidden"])
def test_a_lone_instance_of_the_first_object_is_itself(scene, cube, hidden):
    """Blender frees it before Python sees it where its instancer is hidden: another's place and name stood there."""
    squares = [scene_parts.add_square(scene, f"Square{i}") for i in range(30)]
    others = hidden_collection(scene, squares[0])
    for i, each in enumerate(squares[1:], 1):
        each.location.x = i
        others.objects.link(each)
        scene.collection.objects.unlink(each)
    camera = scene.camera
    scene.collection.objects.unlink(camera)
    for name, collection in (("Lone", hidden_collection(scene, cube)), ("Others", others)):
        empty = scene_parts.add_object(
            scene, name, None, (0, 7, 0) if name == "Lone" else (0, 0, 0)
        )
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.show_instancer_for_render = not hidden
    scene.collection.objects.link(camera)
    collected = export_probe.through_engine(scene)[0]["instances"]
    found = {
        (name, tuple(matrix[:3, 3]))
        for name, matrix in zip(collected["name"], collected["world_from_object"])
    }
    assert found == {("Cube", (0, 7, 0))} | {(f"Square{i}", (i, 0, 0)) for i in range(30)}
    assert len(set(collected["key"].tolist())) == 31


def curve(scene):
    bpy.ops.curve.primitive_bezier_circle_add()
    bpy.context.object.data.bevel_depth = 0.1


def text(scene):
    bpy.ops.object.text_add()


def surface(scene):
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()


def metaball(scene):
    bpy.ops.object.metaball_add(type="BALL")


@pytest.mark.parametrize("make", [curve, text, surface, metaball])
def test_what_blender_tessellates_comes_once(scene, make):
    scene_parts.add_camera(scene)
    make(scene)
    material = bpy.data.materials.new("Paint")
    bpy.context.object.data.materials.append(material)
    name = bpy.context.object.name
    snapshot, report, _ = export_probe.through_engine(scene)
    assert snapshot["instances"]["name"] == [name]
    assert len(snapshot["geometries"]) == 1
    assert snapshot["instances"]["materials"].tolist() == [0]
    assert len(report) == 0


def test_what_cannot_be_rendered_is_named(scene, cube):
    scene_parts.add_object(scene, "Smoke", bpy.data.volumes.new("Smoke"))
    _, report, _ = export_probe.through_engine(scene)
    named = {datablock: message for datablock, message, _ in report.entries()}
    assert "VOLUME" in named["object 'Smoke'"]


def test_empties_armatures_and_friends_do_not_disturb(scene, cube):
    for i, data in enumerate(
        (None, bpy.data.armatures.new("A"), bpy.data.lattices.new("L"), bpy.data.speakers.new("S"))
    ):
        scene_parts.add_object(scene, f"Thing{i}", data)
    snapshot, report, _ = export_probe.through_engine(scene)
    assert snapshot["instances"]["name"] == ["Cube"] and len(report) == 0


def test_excluded_and_hidden_objects_are_not_there(scene, cube):
    excluded = bpy.data.collections.new("Excluded")
    scene.collection.children.link(excluded)
    excluded.objects.link(scene_parts.add_square(scene, "Out"))
    scene.collection.objects.unlink(bpy.data.objects["Out"])
    scene_parts.add_square(scene, "Hidden").hide_render = True
    bpy.context.view_layer.layer_collection.children["Excluded"].exclude = True
    snapshot, _, _ = export_probe.through_engine(scene)
    assert snapshot["instances"]["name"] == ["Cube"]


def test_flags(scene, cube):
    things = {name: scene_parts.add_square(scene, name) for name in "ABCD"}
    things["A"].visible_camera = False
    things["B"].visible_shadow = False
    things["C"].is_holdout = True
    things["D"].pass_index = 7
    scene_parts.set_terminator_offset(things["D"], 0.5)
    held = bpy.data.collections.new("Held")
    indirect = bpy.data.collections.new("Indirect")
    for collection, name in ((held, "E"), (indirect, "F")):
        scene.collection.children.link(collection)
        collection.objects.link(scene_parts.add_square(scene, name))
        scene.collection.objects.unlink(bpy.data.objects[name])
    layers = bpy.context.view_layer.layer_collection.children
    layers["Held"].holdout = True
    layers["Indirect"].indirect_only = True
    snapshot, _, _ = export_probe.through_engine(scene)
    instances = snapshot["instances"]
    flags = dict(zip(instances["name"], instances["flags"].tolist()))
    seen = 8 + 16 + 32 + 64  # by diffuse, glossy, transmission and volume scatter rays
    expected = {"Cube": 3, "A": 2, "B": 1, "C": 7, "D": 3, "E": 7, "F": 2}
    assert {n: f & 0xFFFF for n, f in flags.items()} == {n: f + seen for n, f in expected.items()}
    offsets = {name: (flag >> 16) / 65535 for name, flag in flags.items()}
    assert offsets == pytest.approx(
        {name: 0.5 if name == "D" else 0.1 for name in expected}, abs=1e-5
    )
    index = dict(zip(instances["name"], instances["object_index"].tolist()))
    assert index["D"] == 7 and index["A"] == 0


def test_an_instancer_hides_and_holds_out_its_instances(scene, cube):
    collection_instances(scene, cube, 3)
    bpy.data.objects["Place0"].visible_camera = False
    bpy.data.objects["Place1"].is_holdout = True
    snapshot, _, _ = export_probe.through_engine(scene)
    flags = snapshot["instances"]["flags"] & 0xFFFF
    assert flags.tolist() == [2 + 120, 7 + 120, 3 + 120]


def test_keys_stay_when_others_come_and_go(scene, cube):
    for i in range(20):
        scene_parts.add_square(scene, f"Square{i}")
    by_nodes(scene, cube)

    def keys():
        instances = export_probe.through_engine(scene)[0]["instances"]
        return list(zip(instances["name"], instances["key"].tolist()))

    everything = keys()
    bpy.data.objects["Square7"].hide_render = True
    assert keys() == [pair for pair in everything if pair[0] != "Square7"]
    scene.frame_set(scene.frame_current + 1)
    bpy.data.objects["Square7"].hide_render = False
    assert sorted(keys()) == sorted(everything)


def test_scale_zero_and_broken_transforms_are_named(scene, cube):
    scene_parts.add_square(scene, "Nothing").scale = (0, 0, 0)
    scene_parts.add_square(scene, "Flat").scale = (1, 1, 0)
    scene_parts.add_square(scene, "Broken").location.x = float("nan")
    snapshot, report, _ = export_probe.through_engine(scene)
    assert snapshot["instances"]["name"] == ["Cube", "Nothing", "Flat"]
    assert [datablock for datablock, _, _ in report.entries()] == [
        "object 'Broken'",
        "object 'Nothing'",
    ]


def test_a_hundred_thousand_instances(scene, cube):
    by_nodes(scene, cube, 100_000)
    snapshot, _, _ = export_probe.through_engine(scene)
    assert len(snapshot["instances"]["name"]) == 100_000
    assert len(np.unique(snapshot["instances"]["key"])) == 100_000


def test_cancel_within_the_walk(scene, cube):
    """A cancelled walk ends at once and leaves Blender usable."""
    by_nodes(scene, cube, 10_000)
    calls = []

    def cancelled(_wanted):
        calls.append(1)
        return len(calls) > 3

    with pytest.raises(Cancelled):
        export_probe.through_engine(scene, cancelled=cancelled)
    assert len(calls) == 4
    assert len(export_probe.through_engine(scene)[0]["instances"]["name"]) == 10_000
