# SPDX-License-Identifier: GPL-3.0-or-later
"""When instances exist that come and go within the shutter; particles: test_motion_particles.py."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from motion_parts import drive, set_position, with_shutter
from node_parts import hidden_collection, instances_on_line, line_of_points


@pytest.fixture
def moving(scene):
    """The shutter is open from 9.75 to 10.25."""
    return with_shutter(scene)


def line(scene, count):
    """As many squares in a row as `count`, a formula of the frame, says; the number of persistent ids
    too."""
    part = scene_parts.add_square(scene, "Part", 0.5)
    tree, node = instances_on_line(scene, part, 3)
    drive(tree, f'nodes["{node.name}"].inputs["Count"].default_value', count)


def lives(snapshot):
    """{x: lifespan} of the instances, by where they are at first."""
    instances = snapshot["instances"]
    first = np.cumsum(instances["knots"]) - instances["knots"]
    xs = instances["world_from_object"][first, 0, 3]
    return {float(x): tuple(life) for x, life in zip(xs, instances["lifespan"])}


# Read at 5 times with 17 steps: 9.75, 9.875, 10, 10.125, 10.25; and at 3 with 3.
@pytest.mark.parametrize(
    "count, steps, expected",
    [
        ("3 if frame < 10.05 else 4", 17, {9: (0.625, 1)}),
        ("3 if frame < 9.9 else 4", 17, {9: (0.375, 1)}),
        ("3 if frame < 9.9 else 4", 3, {9: (0.25, 1)}),
        ("4 if frame < 10.05 else 3", 17, {9: (0, 0.625)}),
        ("2 if frame < 9.9 else 3 if frame < 10.05 else 4", 17, {6: (0.375, 1), 9: (0.625, 1)}),
        ("4 if 9.9 < frame < 10.05 else 3", 17, {9: (0.375, 0.625)}),
    ],
)
def test_instances_of_nodes_come_and_go_half_way(moving, count, steps, expected):
    line(moving, count)
    snapshot, report, _ = export_probe.through_engine(moving, motion_steps=steps)
    found = lives(snapshot)
    assert {x: life for x, life in found.items() if life != (0.0, 1.0)} == expected
    assert set(found) >= {0.0, 3.0} and len(report) == 0


def test_what_comes_again_and_again_is_there_each_time(moving):
    """At the first, the middle and the last of five times; each time on its own way."""
    line(moving, "2 if 9.8 < frame < 9.9 or 10.05 < frame < 10.2 else 3")
    drive(moving.objects["Host"], "location", "4 * frame", 1)
    snapshot, report, _ = export_probe.through_engine(moving, motion_steps=17)
    instances = snapshot["instances"]
    first = np.cumsum(instances["knots"]) - instances["knots"]
    matrices = instances["world_from_object"]
    third = np.flatnonzero(matrices[first, 0, 3] == 6.0)
    spans = sorted(tuple(instances["lifespan"][i]) for i in third)
    assert spans == [(0.0, 0.125), (0.375, 0.625), (0.875, 1.0)]
    assert len(instances["name"]) == 5 and len(np.unique(instances["key"])) == 5
    assert len(set(instances["random"][third])) == 1 and len(report) == 0


def test_each_time_has_the_vector_of_its_thing(moving):
    """The frames before and after, whatever happens within the shutter."""
    moving.view_layers[0].use_pass_vector = True
    line(moving, "0 if 9.8 < frame < 9.9 or 10.05 < frame < 10.2 else 1")
    drive(moving.objects["Host"], "location", "4 * frame", 1)
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    adjacent = snapshot["instances"]["adjacent"].reshape(3, 2, 4, 4)
    assert adjacent[:, :, 1, 3] == pytest.approx(np.tile([36.0, 44.0], (3, 1)))


def test_what_comes_again_goes_on_along_each_way_that_it_was_seen_to_go(moving):
    """Seen at two times on both sides of a gap; it goes up before, down after it."""
    line(moving, "0 if 9.95 < frame < 10.05 else 1")
    drive(moving.objects["Host"], "location", "frame if frame < 10 else -frame", 1)
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    instances = snapshot["instances"]
    ways = {}
    for i, span in enumerate(instances["lifespan"]):
        end = int(instances["knots"][: i + 1].sum())
        knots = instances["world_from_object"][end - int(instances["knots"][i]) : end, 1, 3]
        ways[tuple(span)] = knots[-1] - knots[0]
    assert ways == pytest.approx({(0.0, 0.375): 0.5, (0.625, 1.0): -0.5})


@pytest.mark.parametrize("position, open", [("START", 0.625), ("END", None)])
def test_what_comes_later_belongs_to_the_shutter_and_nothing_beyond_it(moving, position, open):
    """The shutter from 10 to 10.5, or from 9.5 to 10."""
    set_position(moving, position)
    line(moving, "3 if frame < 10.3 else 4")
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    if open is None:
        assert "lifespan" not in snapshot["instances"] and len(snapshot["instances"]["name"]) == 3
    else:
        assert lives(snapshot)[9.0] == (open, 1.0)


def test_what_comes_later_goes_along_its_own_way(moving):
    """It is seen at the last two of five times, and lies on their line before."""
    line(moving, "3 if frame < 10.05 else 4")
    drive(moving.objects["Host"], "location", "4 * frame", 1)
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    instances = snapshot["instances"]
    late = [i for i, life in enumerate(instances["lifespan"]) if life[0] > 0]
    first = np.cumsum(instances["knots"]) - instances["knots"]
    (i,) = late
    ends = instances["world_from_object"][first[i] : first[i] + instances["knots"][i], 1, 3]
    assert ends == pytest.approx([39.0, 41.0], abs=1e-4)


def test_an_animated_visibility_belongs_to_the_frame(moving):
    """Of the instancer, of an object, of what is instanced."""
    line(moving, "3")
    collection = bpy.data.collections.new("Group")
    inside = scene_parts.add_square(moving, "Inside")
    collection.objects.link(inside)
    moving.collection.objects.unlink(inside)
    place = scene_parts.add_object(moving, "Place", None)
    place.instance_type, place.instance_collection = "COLLECTION", collection
    plain = scene_parts.add_square(moving, "Plain")
    for thing in (moving.objects["Host"], inside, plain):
        thing.keyframe_insert("hide_render", frame=9)
        thing.hide_render = True
        thing.keyframe_insert("hide_render", frame=10.1)
        thing.keyframe_insert("hide_render", frame=11)
        thing.hide_render = False
    moving.frame_set(9)
    moving.frame_set(10)
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    assert sorted(snapshot["instances"]["name"]) == ["Inside", "Part", "Part", "Part", "Plain"]
    assert "lifespan" not in snapshot["instances"]


@pytest.mark.parametrize(
    "count, expected",
    [("3 if frame < 10.05 else 4", [3, 4, 4]), ("3 if 9.95 < frame < 10.05 else 4", [4, 5, 4])],
)
def test_a_later_frame_with_persistent_data_is_the_same_as_without(moving, count, expected):
    line(moving, count)

    def frames(persistent):
        return [
            {
                name: job.snapshot["instances"].get(name, np.zeros(0)).tolist()
                for name in ("key", "lifespan", "knots", "world_from_object")
            }
            for job in export_probe.frame_by_frame(
                moving, (9, 10, 11), persistent=persistent, motion_steps=17
            )
        ]

    found = frames(True)
    assert found == frames(False)
    assert [len(frame["key"]) for frame in found] == expected


def test_the_first_of_its_kind_brings_its_own_material(moving):
    line(moving, "0 if frame < 10.05 else 1")
    paint = bpy.data.materials.new("Paint")
    moving.objects.get("Part", bpy.data.objects["Part"]).data.materials.append(paint)
    snapshot, report, _ = export_probe.through_engine(moving, motion_steps=17)
    instances = snapshot["instances"]
    assert instances["name"] == ["Part"] and instances["lifespan"].tolist() == [[0.625, 1.0]]
    assert [m["name"] for m in snapshot["materials"]] == ["Paint"]
    assert instances["materials"].tolist() == [0] and len(report) == 0


def test_two_that_take_turns_cover_everything_once(moving, render):
    """The instances of two objects at one place, of which one goes when the other comes."""
    part = scene_parts.add_square(moving, "Part", 40.0)
    for name, count in (("First", "frame < 10.1"), ("Second", "frame >= 10.1")):
        tree, node = instances_on_line(moving, part, 1, name)
        drive(tree, f'nodes["{node.name}"].inputs["Count"].default_value', f"1 if {count} else 0")
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    assert sorted(snapshot["instances"]["lifespan"].tolist()) == [[0.0, 0.625], [0.625, 1.0]]
    moving.granita.samples = 16
    moving.render.film_transparent = True
    passes = render(moving, "GRANITA")
    values = next(values for key, values in passes.items() if key.endswith("Combined.A"))
    assert (values == 1.0).all()


def test_two_that_alternate_are_one_that_stays(moving, render):
    """Bit by bit: at each of five times the instances of one of two objects, at one place."""
    glow = scene_parts.emission("Glow", (0.25, 0.5, 0.75))
    part = scene_parts.add_square(moving, "Part", 3.0, material=glow)
    moving.granita.samples = 16
    moving.render.film_transparent = True
    still = render(moving, "still")
    odd = "int(round((frame - 9.75) * 8)) % 2"
    for name, count in (("First", f"1 - {odd}"), ("Second", odd)):
        tree, node = instances_on_line(moving, part, 1, name)
        moving.objects[name].location.z = 0.0
        drive(tree, f'nodes["{node.name}"].inputs["Count"].default_value', count)
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    ends = np.sort(snapshot["instances"]["lifespan"][:, 0])
    assert ends.tolist() == [0.0, 0.125, 0.375, 0.625, 0.875]
    passes = render(moving, "alternating")
    assert still.keys() == passes.keys()
    for key, values in still.items():
        assert np.array_equal(values, passes[key]), key


def test_nested_instances_come_and_go_too(moving):
    """A collection that holds an object whose nodes make instances, placed twice: the ids of all levels count,
    and each placed one comes by itself."""
    part = scene_parts.add_square(moving, "Part", 0.5)
    tree, node = instances_on_line(moving, part, 3)
    drive(tree, f'nodes["{node.name}"].inputs["Count"].default_value', "3 if frame < 10.05 else 4")
    collection = hidden_collection(moving, moving.objects["Host"])
    for i in range(2):
        place = scene_parts.add_object(moving, f"Place{i}", None, (0, 3 * i, 0))
        place.instance_type, place.instance_collection = "COLLECTION", collection
    snapshot, report, _ = export_probe.through_engine(moving, motion_steps=17)
    instances = snapshot["instances"]
    assert len(instances["name"]) == 8 and len(np.unique(instances["key"])) == 8
    places = instances["world_from_object"][:, :2, 3]
    late = {tuple(p) for p, life in zip(places.tolist(), instances["lifespan"]) if life[0] > 0}
    assert late == {(9.0, 0.0), (9.0, 3.0)} and len(report) == 0


def test_instances_on_vertices_that_come(moving):
    """As many vertices as nodes make, each with an instance of the child."""
    grid = scene_parts.add_square(moving, "Grid")
    tree, node = line_of_points(grid)
    drive(tree, f'nodes["{node.name}"].inputs["Count"].default_value', "2 if frame < 10.05 else 3")
    scene_parts.add_square(moving, "Child", 0.5).parent = grid
    grid.instance_type = "VERTS"
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    assert snapshot["instances"]["name"].count("Child") == 3
    assert {x: life for x, life in lives(snapshot).items() if life[0] > 0} == {6.0: (0.625, 1.0)}


def test_what_does_not_blur_is_that_of_the_frame(moving):
    line(moving, "3 if frame < 10.05 else 4")
    host = moving.objects["Host"]
    (getattr(host, "cycles", None) or host.granita).use_motion_blur = False
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    assert len(snapshot["instances"]["name"]) == 3 and "lifespan" not in snapshot["instances"]


def test_the_first_of_its_kind_may_be_hidden_itself(moving):
    """Nodes make instances of hidden objects."""
    line(moving, "0 if frame < 10.05 else 1")
    bpy.data.objects["Part"].hide_render = True
    snapshot, report, _ = export_probe.through_engine(moving, motion_steps=17)
    instances = snapshot["instances"]
    assert instances["name"] == ["Part"] and instances["lifespan"].tolist() == [[0.625, 1.0]]
    assert len(report) == 0
