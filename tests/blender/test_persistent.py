# SPDX-License-Identifier: GPL-3.0-or-later
"""Persistent Data: every frame is what it is without, bit for bit, whatever changes between frames."""

import bpy
import exr
import numpy as np
import pytest
import render_host
import scene_parts
from call_counts import count_calls
from export_probe import frame_by_frame
from motion_parts import drive, on_every_step, shape_key, with_shutter

from granita.export.geometry import geometry_source
from granita.export.scene import persistent_state, scene_objects

FRAMES = (10, 11, 12)


def same(a, b):
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b))
    return np.array_equal(a, b)


def at(wanted, act):
    """An edit of one frame alone."""
    return lambda frame: act() if frame == wanted else None


# Each builds on a scene with a shutter and a square, and returns what edits it before a frame, or None.


def a_thing_that_moves(scene, square):
    drive(square, "location", "frame * frame", 0)


def a_shape_that_changes(scene, square):
    drive(shape_key(square), "value", "frame / 20")


def a_cage_that_changes(scene, square):
    drive(shape_key(square), "value", "frame / 20")
    scene_parts.add_subsurf(square, 2)


def a_topology_that_changes(scene, square):
    drive(square.modifiers.new("Screw", "SCREW"), "render_steps", "frame")


def a_child(scene, square):
    parent = scene_parts.add_object(scene, "Parent", None)
    square.parent = parent
    drive(parent, "rotation_euler", "frame", 2)


def instances_that_move(scene, square):
    empty = scene_parts.add_object(scene, "Place", None)
    empty.instance_type, empty.instance_collection = (
        "COLLECTION",
        scene_parts.add_collection(scene, "Part", [square]),
    )
    drive(empty, "location", "frame", 0)


def particles_that_fly(scene, square):
    emitter = scene_parts.add_square(scene, "Emitter", 1.0)
    emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = emitter.particle_systems[0].settings
    settings.count, settings.frame_start, settings.frame_end = 5, 1, 10
    settings.render_type, settings.instance_object = "OBJECT", square


def hair_that_moves(scene, square):
    square.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = square.particle_systems[0].settings
    settings.type, settings.count = "HAIR", 3
    drive(square, "rotation_euler", "frame / 3", 1)


def hair_that_swells(scene, square):
    square.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = square.particle_systems[0].settings
    settings.type, settings.count = "HAIR", 3
    drive(settings, "root_radius", "frame")


def lamps(scene, square):
    lamp = scene_parts.add_object(scene, "Lamp", bpy.data.lights.new("Lamp", "POINT"))
    drive(lamp.data, "energy", "frame")
    drive(lamp, "location", "frame", 1)


def a_focal_length(scene, square):
    drive(scene.camera.data, "lens", "20 + frame")


def a_material_in_motion(scene, square):
    material = scene_parts.emission("Glow", (1, 1, 1))
    square.data.materials.append(material)
    node = next(n for n in material.node_tree.nodes if n.type == "EMISSION")
    drive(node.inputs["Strength"], "default_value", "frame")


def edges_that_a_material_shows(scene, square):
    """Of faces that Blender makes, and a cage has not."""
    square.data.polygons[0].use_smooth = True
    square.modifiers.new("Subdivision", "SUBSURF")
    material = scene_parts.emission("Glow", (1, 1, 1))
    square.data.materials.append(material)
    drive(square, "location", "frame", 0)

    def show():
        wire = material.node_tree.nodes.new("ShaderNodeWireframe")
        wire.inputs["Size"].default_value = 0.1
        node = next(n for n in material.node_tree.nodes if n.type == "EMISSION")
        material.node_tree.links.new(wire.outputs[0], node.inputs["Strength"])

    return at(11, show)


def another_material(scene, square):
    square.data.materials.append(scene_parts.emission("One", (1, 0, 0)))
    other = scene_parts.emission("Two", (0, 1, 0))
    drive(square, "location", "frame", 0)

    def swap():
        square.material_slots[0].link = "OBJECT"
        square.material_slots[0].material = other

    return at(11, swap)


def what_is_hidden_and_comes(scene, square):
    drive(square, "location", "frame", 0)
    drive(square, "hide_render", "frame < 11")
    drive(scene_parts.add_square(scene, "Goes"), "hide_render", "frame > 11.5")


def settings_of_a_mover(scene, square):
    drive(square, "location", "frame", 0)

    def change():
        square.visible_camera, square.pass_index = False, 7

    return at(11, change)


def settings_of_what_stands(scene, square):
    def change():
        square.visible_shadow, square.pass_index = False, 7

    return at(11, change)


def a_mesh_that_is_edited(scene, square):
    scene_parts.add_object(scene, "Twin", square.data)

    def change():
        square.data.vertices[0].co.x += 1.0
        square.data.update()

    return at(11, change)


def a_mesh_that_is_replaced(scene, square):
    other = scene_parts.add_square(scene, "Other", 5.0).data

    def change():
        square.data = other

    return at(11, change)


def an_object_that_comes_and_one_that_goes(scene, square):
    scene_parts.add_square(scene, "Goes", 1.0)

    def change():
        scene_parts.add_square(scene, "Comes", 3.0)
        bpy.data.objects.remove(scene.objects["Goes"])

    return at(11, change)


def an_object_of_the_same_name(scene, square):
    scene_parts.add_square(scene, "Again", 1.0)

    def change(frame):
        bpy.data.objects.remove(scene.objects["Again"])
        scene_parts.add_square(scene, "Again", frame / 5)

    return change


def an_index_that_is_animated(scene, square):
    drive(square, "pass_index", "frame")


def another_name(scene, square):
    def rename():
        square.name = "Renamed"

    return at(11, rename)


def a_collection_held_out(scene, square):
    scene_parts.add_collection(scene, "Part", [square])
    layer = bpy.context.view_layer.layer_collection.children["Part"]
    drive(scene_parts.add_square(scene, "Mover"), "location", "frame", 0)

    def change(frame):
        layer.holdout, layer.exclude = frame == 11, frame == 12

    return change


def a_modifier_switched_off(scene, square):
    modifier = scene_parts.add_subsurf(square, 2)

    def change():
        modifier.render_levels = 0

    return at(11, change)


def simplify(scene, square):
    scene_parts.add_subsurf(square, 2)
    scene.render.simplify_subdivision_render = 0

    def change():
        scene.render.use_simplify = True

    return at(11, change)


def things_left_out(scene, square):
    """By Simplify's culling; what it is asked changes, then what the thing lets it."""
    scene.render.use_simplify = True
    square.location.x += 30.0

    def change(frame):
        scene.cycles.use_camera_cull = frame > 10
        square.cycles.use_camera_cull = frame != 12

    return change


CHANGES = [
    a_thing_that_moves,
    a_shape_that_changes,
    a_cage_that_changes,
    a_topology_that_changes,
    a_child,
    instances_that_move,
    hair_that_swells,
    lamps,
    a_focal_length,
    a_material_in_motion,
    edges_that_a_material_shows,
    another_material,
    what_is_hidden_and_comes,
    settings_of_a_mover,
    settings_of_what_stands,
    a_mesh_that_is_edited,
    a_mesh_that_is_replaced,
    an_object_that_comes_and_one_that_goes,
    an_object_of_the_same_name,
    an_index_that_is_animated,
    another_name,
    a_collection_held_out,
    simplify,
    things_left_out,
]


# Blender itself evaluates these otherwise with Persistent Data: with other last bits, or not at all.
BLENDERS_OWN = [particles_that_fly, hair_that_moves, a_modifier_switched_off]


def frames_of(scene_with_home, change, **how):
    scene = scene_with_home()
    with_shutter(scene)
    square = scene_parts.add_square(scene)
    scene_parts.add_square(scene, "Still", 3.0, (0, 0, -3))
    edit = change(scene, square) or (lambda _frame: None)
    for frame in range(1, FRAMES[0]):
        scene.frame_set(frame)  # particles want to be played
    return list(frame_by_frame(scene, FRAMES, edit=edit, **how))


@pytest.fixture
def anew(scene):
    """Makes the empty scene of the fixture `scene` again."""

    def again():
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        return bpy.context.scene

    return again


@pytest.mark.parametrize("change", CHANGES)
def test_frames_are_those_without_it(anew, change):
    fresh = frames_of(anew, change, persistent=False)
    hold(frames_of(anew, change, persistent=True), fresh)


@pytest.mark.parametrize("change", BLENDERS_OWN)
def test_frames_are_those_that_blender_keeps(anew, change):
    fresh = frames_of(anew, change, persistent=True, keeps=False)
    hold(frames_of(anew, change, persistent=True), fresh)


def hold(kept, fresh):
    for frame, expected in zip(kept, fresh, strict=True):
        assert same(frame.snapshot, expected.snapshot)
        assert frame.report.entries() == expected.report.entries()
    assert not same(fresh[0].snapshot, fresh[1].snapshot)


def test_what_a_handler_left_elsewhere_is_found_there(anew):
    """Moved within the shutter of one frame, by nothing that is animated."""

    def frames(persistent_data):
        scene = with_shutter(anew())
        square = scene_parts.add_square(scene)
        drive(scene_parts.add_square(scene, "Mover"), "location", "frame", 0)

        def push(scene, _depsgraph):
            if scene.frame_current + scene.frame_subframe == 10.25:
                scene.objects["Square"].location.x = 5.0

        square.location.x = 1.0
        handlers = on_every_step(push)
        handlers["before"](None)
        try:
            return list(frame_by_frame(scene, FRAMES, persistent=persistent_data))
        finally:
            handlers["after"](None)

    hold(frames(True), frames(False))


@pytest.mark.parametrize("change", [a_thing_that_moves, a_shape_that_changes, a_child, lamps])
def test_what_stands_alone_needs_no_walk(anew, change, monkeypatch):
    walks = []
    walk = persistent_state.read_scene_objects
    monkeypatch.setattr(
        persistent_state, "read_scene_objects", lambda *all_: walks.append(1) or walk(*all_)
    )
    frames_of(anew, change, persistent=True)
    assert len(walks) == 1


def test_what_nothing_touched_is_not_read_again(anew, monkeypatch):
    """Where the scene is walked anew: of three geometries, the one that deforms."""
    read = []
    mesh = geometry_source.read_geometry

    def counted(data, label, *rest, **named):
        read.append(label)
        return mesh(data, label, *rest, **named)

    monkeypatch.setattr(geometry_source, "read_geometry", counted)

    def change(scene, square):
        instances_that_move(scene, scene_parts.add_square(scene, "Leaf"))
        drive(shape_key(square), "value", "frame / 20")

    frames_of(anew, change, persistent=True)
    assert sorted(read) == ["mesh 'Leaf'"] + ["mesh 'Square'"] * 3 + ["mesh 'Still'"]


def test_a_static_crowd_is_walked_once(anew, monkeypatch):
    """Of later frames the one thing that moves is read, however many stand still (bench/export_cost.py)."""
    count = count_calls(
        monkeypatch, walks=(scene_objects, "visit"), places=(persistent_state, "from_matrix")
    )

    def change(scene, square):
        drive(square, "location", "frame", 0)
        crowd = scene_parts.add_square(scene, "Ground", 8.0)
        crowd.instance_type = "VERTS"
        scene_parts.add_square(scene, "Leaf", 0.5).parent = crowd

    frames_of(anew, change, persistent=True)
    assert count == {"walks": 1, "places": len(FRAMES) - 1}


OTHER_LAYER = """
part = bpy.data.collections.new("Part")
scene.collection.children.link(part)
for name in ("Left", "Right"):
    thing = bpy.data.objects.new(name, square.data)
    thing.location.x = -1.5 if name == "Left" else 1.5
    part.objects.link(thing)
thing.driver_add("location", 1).driver.expression = "frame / 9"
scene.view_layers.new("Other").layer_collection.children["Part"].exclude = True
"""


@pytest.mark.parametrize("more", ["", OTHER_LAYER], ids=["one layer", "two layers"])
def test_pictures_of_an_animation_are_those_without_it(blend, tmp_path, more):
    prepare = """
import bpy
scene = bpy.context.scene
scene.render.use_motion_blur = True
scene.render.use_persistent_data = {}
square = scene.objects["Square"]
square.driver_add("location", 0).driver.expression = "frame / 3"
lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "SUN"))
scene.collection.objects.link(lamp)
"""
    with_it, without = (
        render_host.run(blend, tmp_path / str(on), prepare.format(on) + more, first=3, last=5)
        for on in (True, False)
    )
    assert with_it.code == without.code == 0, with_it.output
    assert len(with_it.files) == len(without.files) == 3
    for file, expected in zip(with_it.files, without.files):
        pixels, truth = exr.read(file), exr.read(expected)
        assert len(truth) == (8 if more else 4)
        assert all(np.array_equal(pixels[name], truth[name]) for name in truth)
