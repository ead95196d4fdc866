# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes wrong while time is moved: a warning names it, the frame finishes, Blender stays up."""

import bpy
import export_probe
import numpy as np
import pytest
import render_host
import scene_parts
from motion_parts import drive, on_every_step, shape_key, with_shutter, xs


@pytest.fixture
def moving(scene):
    """A mover, a subdivided deforming cage, an instancer, a lamp; all in motion, and the camera."""
    with_shutter(scene)
    drive(scene.camera, "location", "frame", 1)
    drive(scene_parts.add_square(scene, "Mover"), "location", "frame", 0)
    cage = scene_parts.add_square(scene, "Cage")
    scene_parts.add_subsurf(cage, 2)
    drive(shape_key(cage), "value", "frame / 20")
    part = bpy.data.collections.new("Part")
    part.objects.link(scene_parts.add_square(scene, "Inside"))
    place = scene_parts.add_object(scene, "Place", None)
    place.instance_type, place.instance_collection = "COLLECTION", part
    drive(place, "location", "frame", 0)
    lamp = scene_parts.add_object(scene, "Lamp", bpy.data.lights.new("Lamp", "POINT"))
    drive(lamp, "location", "frame", 0)
    drive(lamp.data, "energy", "frame")
    return scene


def warnings(report):
    return {name: message for name, message, _ in report.entries()}


OBJECTS = ["Mover", "Cage", "Inside", "Place", "Lamp", "Camera"]


@pytest.mark.parametrize(
    "collection, doomed",
    [("objects", name) for name in OBJECTS] + [("meshes", name) for name in OBJECTS[:3]],
)
def test_what_a_handler_deletes_stays_where_it_was(moving, collection, doomed):
    """With a mesh go its users.  The pass Vector steps through time once more."""
    moving.view_layers[0].use_pass_vector = True
    things = getattr(bpy.data, collection)

    def delete(*_):
        if doomed in things:
            things.remove(things[doomed])

    snapshot, report, time_after = export_probe.through_engine(moving, **on_every_step(delete))
    names = snapshot["instances"]["name"]
    assert time_after == 10.0
    assert sorted(names) == ["Cage", "Inside", "Inside", "Mover"]
    assert snapshot["lights"][0]["name"] == "Lamp"
    # Nothing came or went: all are there throughout the shutter.
    assert np.all(snapshot["instances"].get("lifespan", (0.0, 1.0)) == np.array([0.0, 1.0]))
    label = f"{'camera' if doomed == 'Camera' else 'object'} '{doomed}'"
    (entry,) = (entry for entry in report.entries() if entry[0] == label)
    assert "was deleted" in entry[1]
    if doomed != "Mover":
        assert xs(snapshot, "Mover") == pytest.approx([9.75, 10.25])
    else:
        assert xs(snapshot, "Mover").tolist() == [10.0]


def test_a_focus_object_that_a_handler_deletes_is_focused_on(moving):
    target = scene_parts.add_object(moving, "Target", None, (0, 0, 6))
    dof = moving.camera.data.dof
    dof.use_dof, dof.focus_object, dof.focus_distance = True, target, 1.0

    def delete(*_):
        if "Target" in bpy.data.objects:
            bpy.data.objects.remove(bpy.data.objects["Target"])

    snapshot, report, _ = export_probe.through_engine(moving, **on_every_step(delete))
    camera = snapshot["camera"]
    assert camera["focus_distance"] == pytest.approx(4.0)
    assert np.ptp(np.asarray(camera.get("lens_knots", np.zeros((1, 2))))[:, 1]) < 1e-6
    assert "without its focus object" in warnings(report)["camera 'Camera'"]


def test_a_cage_that_a_handler_frees_of_its_modifier_keeps_its_shape(moving):
    moving.view_layers[0].use_pass_vector = True
    snapshot, report, _ = export_probe.through_engine(
        moving, **on_every_step(lambda *_: bpy.data.objects["Cage"].modifiers.clear())
    )
    cage = export_probe.geometry_of(snapshot, "Cage")
    assert cage["subdivision"] and len(cage["points"]) == 1
    assert "topology changes" in warnings(report)["mesh 'Cage'"]


def test_what_is_nowhere_at_another_time_stays_where_it_was(moving):
    thing = scene_parts.add_square(moving, "Lost")
    thing.parent = scene_parts.add_object(moving, "Parent", None)
    for owner in (thing, thing.parent):  # their product is beyond single precision
        drive(owner, "scale", "1 if frame <= 10 else 1e30", 0)
    snapshot, report, _ = export_probe.through_engine(moving)
    assert len(export_probe.knots_of(snapshot, "Lost")) == 1
    assert "no finite transform" in warnings(report)["object 'Lost'"]


def test_what_a_handler_renames_stays_where_it_was(moving):
    def rename(*_):
        if "Mover" in bpy.data.objects:
            bpy.data.objects["Mover"].name = "Other"

    snapshot, report, _ = export_probe.through_engine(moving, **on_every_step(rename))
    assert xs(snapshot, "Mover").tolist() == [10.0]
    assert "renamed" in warnings(report)["object 'Mover'"]


@pytest.mark.parametrize("doomed", ["Mover", "Cage", "Place", "Lamp"])
@pytest.mark.parametrize("how", ["unlinks", "excludes"])
def test_what_a_handler_unlinks_stays_where_it_was(moving, how, doomed):
    """So does what it instances."""
    extra = bpy.data.collections.new("Extra")
    moving.collection.children.link(extra)
    extra.objects.link(moving.objects[doomed])
    moving.collection.objects.unlink(moving.objects[doomed])

    def unlink(scene, _depsgraph):
        if scene.frame_subframe == 0.0:
            return
        if how == "excludes":
            scene.view_layers[0].layer_collection.children["Extra"].exclude = True
        elif doomed in extra.objects:
            extra.objects.unlink(extra.objects[doomed])

    bpy.app.handlers.frame_change_post.append(unlink)
    try:
        jobs = list(export_probe.frame_by_frame(moving, (10, 11), persistent=True))
    finally:
        bpy.app.handlers.frame_change_post.remove(unlink)
    instances, label = jobs[0].snapshot["instances"], f"object '{doomed}'"
    assert sorted(instances["name"]) == ["Cage", "Inside", "Inside", "Mover"]
    assert np.all(instances.get("lifespan", (0.0, 1.0)) == np.array([0.0, 1.0]))
    assert len(jobs[0].snapshot["lights"]) == 1
    assert {name: "was unlinked" in text for name, text in warnings(jobs[0].report).items()} == {
        label: True
    }
    # The next frame is without it.
    assert len(jobs[1].report) == 0 and doomed not in jobs[1].snapshot["instances"]["name"]
    assert len(jobs[1].snapshot["lights"]) == (doomed != "Lamp")


def test_what_a_handler_makes_is_not_there(moving):
    """The frame is what it was when it began."""

    def make(scene, _depsgraph):
        scene_parts.add_square(scene, f"New{scene.frame_subframe}")

    snapshot, report, _ = export_probe.through_engine(moving, **on_every_step(make))
    assert sorted(snapshot["instances"]["name"]) == ["Cage", "Inside", "Inside", "Mover"]
    assert xs(snapshot, "Mover") == pytest.approx([9.75, 10.25]) and len(report) == 0


def test_a_handler_that_raises_changes_nothing(moving):
    def fail(*_):
        raise RuntimeError("on purpose")

    snapshot, report, _ = export_probe.through_engine(moving, **on_every_step(fail))
    assert xs(snapshot, "Mover") == pytest.approx([9.75, 10.25]) and len(report) == 0


def test_a_driver_that_fails_is_named(moving):
    drive(moving.objects["Cage"], "location", "no_such_name * frame", 0)
    _, report, _ = export_probe.through_engine(moving)
    assert warnings(report) == {
        "object 'Cage'": "the driver of its location fails: the value stays as it was"
    }


def simulated(scene, kind):
    square = scene_parts.add_square(scene, "Sim")
    if kind == "PARTICLES":
        square.modifiers.new("Dust", "PARTICLE_SYSTEM")
        square.particle_systems[0].settings.render_type = "HALO"
    else:
        square.modifiers.new("Sim", kind)
    return square


@pytest.mark.parametrize("kind", ["CLOTH", "SOFT_BODY", "PARTICLES"])
def test_a_simulation_that_is_not_baked_is_named(moving, kind):
    simulated(moving, kind)
    for frame in range(1, 11):
        moving.frame_set(frame)
    _, report, _ = export_probe.through_engine(moving)
    assert list(warnings(report)) == ["object 'Sim'"]
    assert "is not baked" in warnings(report)["object 'Sim'"]
    moving.render.use_motion_blur = False
    assert len(export_probe.through_engine(moving)[1]) == 0


def test_rigid_bodies_that_are_not_baked_are_named(moving):
    bpy.ops.rigidbody.world_add()
    with bpy.context.temp_override(object=moving.objects["Cage"]):
        bpy.ops.rigidbody.object_add()
    _, report, _ = export_probe.through_engine(moving)
    assert warnings(report) == {
        "scene 'Scene'": "its rigid bodies are not baked: their blur may be wrong"
    }
    moving.render.use_motion_blur = False
    assert len(export_probe.through_engine(moving)[1]) == 0


def test_hair_that_is_no_simulation_is_not(moving):
    square = simulated(moving, "PARTICLES")
    square.particle_systems[0].settings.type = "HAIR"
    square.particle_systems[0].settings.count = 2
    assert len(export_probe.through_engine(moving)[1]) == 0


def test_a_missing_cache_file_is_named(moving, tmp_path):
    cage = moving.objects["Mover"]
    modifier = cage.modifiers.new("Alembic", "MESH_SEQUENCE_CACHE")
    _, report, _ = export_probe.through_engine(moving)
    assert "no cache file" in warnings(report)["object 'Mover'"]
    (tmp_path / "lost.abc").write_bytes(b"no archive")
    bpy.ops.cachefile.open(filepath=str(tmp_path / "lost.abc"))
    modifier.cache_file = bpy.data.cache_files[0]
    (tmp_path / "lost.abc").unlink()
    _, report, _ = export_probe.through_engine(moving)
    assert "lost.abc" in warnings(report)["object 'Mover'"]


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e30])
def test_velocities_beyond_measure(moving, value):
    """Not finite: named, and the point stands still.  Finite: its blur is as long as it says."""
    square = moving.objects["Mover"]
    attribute = square.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.float32([value, 0, 0] + [0, 0, 0] * 3))
    snapshot, report, _ = export_probe.through_engine(moving)
    points = export_probe.geometry_of(snapshot, "Mover")["points"]
    assert np.isfinite(points).all()
    assert len(report) == (0 if np.isfinite(value) else 1)


PREPARE = """
import bpy
scene = bpy.context.scene
scene.render.use_motion_blur = True
square = scene.objects["Square"]
square.driver_add("location", 0).driver.expression = "frame / 3"
{}
"""

DELETE = """
def delete(scene, _depsgraph):
    if scene.frame_subframe and "Square" in bpy.data.objects:
        bpy.data.objects.remove(bpy.data.objects["Square"])
bpy.app.handlers.frame_change_post.append(delete)
"""


@pytest.mark.parametrize(
    "lines, says",
    [
        ("scene.render.motion_blur_shutter = 0.0", None),
        ("scene.render.motion_blur_shutter = 1e6", None),
        (
            "square.driver_add('scale', 0).driver.expression = '1 / (frame - frame)'",
            "driver of its scale",
        ),
        (DELETE, "object 'Square': was deleted"),
    ],
    ids=["shutter 0", "shutter 1e6", "driver", "handler"],
)
def test_a_farm_gets_its_frame(blend, tmp_path, lines, says):
    outcome = render_host.run(blend, tmp_path / "out", PREPARE.format(lines), first=5, last=5)
    assert outcome.code == 0, outcome.output
    assert len(outcome.files) == 1
    assert says is None or says in outcome.output, outcome.output
