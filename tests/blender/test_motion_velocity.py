# SPDX-License-Identifier: GPL-3.0-or-later
"""The attribute `velocity`, of whatever has points and however it is placed: exact motion, or a warning that
names what cannot be used."""

import math
from types import SimpleNamespace

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from film_parts import HEIGHT, MIDPOINTS, WIDTH, alpha, hold, left_of, moving_disc, over_time, wall
from hair_parts import curve_through, mesh_points
from motion_parts import drive, set_position, shape_key
from node_parts import hidden_collection, instances_on_line, store_attribute

from granita.export.geometry.velocity import read_velocity

PIXELS = np.arange(WIDTH)


def give_velocity(thing, vector, kind="FLOAT_VECTOR", domain="POINT"):
    attribute = thing.data.attributes.new("velocity", kind, domain)
    if kind == "FLOAT_VECTOR":
        attribute.data.foreach_set("vector", np.tile(np.float32(vector), len(attribute.data)))
    return thing


def expect_edge(render, film):
    """It moves from 6 to 26."""
    expected = over_time(lambda t: left_of(6 + 20 * t, PIXELS), MIDPOINTS)
    hold(alpha(render, film), np.broadcast_to(expected, (HEIGHT, WIDTH)))


def test_metres_a_second(film, render):
    """500 at 25 frames a second are 20 a frame, about the frame's place."""
    film.render.fps, film.render.fps_base = 50, 2.0
    set_position(film, "CENTER")
    give_velocity(wall(film, 16.0), (500, 0, 0))
    expect_edge(render, film)


@pytest.mark.parametrize("how", ["COLLECTION", "NODES"])
def test_instances_turn_the_velocity_of_their_object(film, render, how):
    """The wall lies on the other side, and goes the other way, before it is turned around."""
    part = give_velocity(wall(film, 0.0, "Part"), (0, 480, 0))
    if how == "COLLECTION":
        place = scene_parts.add_object(film, "Place", None)
        place.instance_type, place.instance_collection = "COLLECTION", hidden_collection(film, part)
    else:
        instances_on_line(film, part, 1)
        place = film.objects["Host"]
    place.location.x = 6.0
    # What is to the left and goes up is below and goes right.
    place.rotation_euler.z = -math.pi / 2
    snapshot, report, _ = export_probe.through_engine(film)
    points = export_probe.geometry_of(snapshot, "Part")["points"]
    assert points[1] - points[0] == pytest.approx(np.tile([0.0, 20.0, 0.0], (4, 1)))
    assert len(report) == 0
    for corner in part.data.vertices:  # to the upper half, of which a turn makes the left one
        corner.co = (corner.co.y, -corner.co.x - 200.0, 0.0)
    expect_edge(render, film)


def test_points_of_a_cloud(film, render):
    disc = mesh_points(film, [(6.0, 8.0, 0.0)], [], 5.0)
    store_attribute(disc, "velocity", "FLOAT_VECTOR", "POINT", (480, 0, 0))
    hold(alpha(render, film), moving_disc((6.0, 8.0), 5.0, 20.0), crossings=2)


def test_points_of_curves(film, render):
    curve = curve_through(film, [(-94.0, -40.0, 0.0), (-94.0, 8.0, 0.0), (-94.0, 56.0, 0.0)], 100.0)
    store_attribute(curve, "velocity", "FLOAT_VECTOR", "POINT", (480, 0, 0))
    expect_edge(render, film)


def test_a_changed_topology_moves_by_it(film):
    thing = give_velocity(wall(film, 16.0), (24, 0, 0))
    build = thing.modifiers.new("Screw", "SCREW")
    drive(build, "steps", "4 + int(10 * (frame - 10))")
    snapshot, report, _ = export_probe.through_engine(film)
    points = snapshot["geometries"][0]["points"]
    assert len(report) == 0 and points.shape[0] == 2
    assert points[1] - points[0] == pytest.approx(np.tile([1.0, 0.0, 0.0], (points.shape[1], 1)))


def test_vanishing_numbers_are_named(film):
    thing = give_velocity(wall(film, 16.0), (0, 0, 0))
    thing.data.attributes["velocity"].data[0].vector.x = np.nan
    _, report, _ = export_probe.through_engine(film)
    assert [entry[:2] for entry in report.entries()] == [
        ("mesh 'Wall'", "its 'velocity' is not finite at 1 point, taken as 0")
    ]


@pytest.mark.parametrize(
    "kind, domain",
    [
        ("FLOAT_VECTOR", "FACE"),
        ("FLOAT_VECTOR", "CORNER"),
        ("FLOAT_VECTOR", "EDGE"),
        ("FLOAT", "POINT"),
        ("FLOAT_COLOR", "POINT"),
        ("FLOAT2", "POINT"),
        ("INT", "POINT"),
        ("BOOLEAN", "FACE"),
    ],
)
def test_what_is_no_vector_on_points_is_named_and_leaves_the_deformation(film, kind, domain):
    thing = give_velocity(wall(film, 16.0), (480, 0, 0), kind, domain)
    drive(shape_key(thing), "value", "frame - 10")
    snapshot, report, _ = export_probe.through_engine(film)
    ((name, message, _),) = report.entries()
    assert name == "mesh 'Wall'" and f"{kind} on {domain}" in message
    points = export_probe.geometry_of(snapshot, "Wall")["points"]
    assert points[-1] - points[0] == pytest.approx(np.tile([0.0, 0.0, 1.0], (4, 1)))


@pytest.mark.parametrize(
    "build, kind, domain",
    [
        (lambda film: mesh_points(film, [(6.0, 8.0, 0.0)], [], 3.0), "FLOAT", "POINT"),
        (lambda film: mesh_points(film, [(6.0, 8.0, 0.0)], [], 3.0), "FLOAT_COLOR", "POINT"),
        (lambda film: curve_through(film, [(6, 0, 0), (6, 9, 0)], 3.0), "FLOAT_VECTOR", "CURVE"),
    ],
)
def test_of_curves_and_clouds_likewise(film, build, kind, domain):
    thing = build(film)
    store_attribute(thing, "velocity", kind, domain, (480, 0, 0))
    _, report, _ = export_probe.through_engine(film)
    (name,) = (entry[0] for entry in report.entries() if f"{kind} on {domain}" in entry[1])
    assert name == f"object '{thing.name}'"


def test_another_number_of_values_than_points_is_named():
    """Blender's own interface does not let one make such data; a broken file may hold it."""
    values = SimpleNamespace(domain="POINT", data_type="FLOAT_VECTOR", data=[None] * 3)
    said = []
    found = read_velocity(
        SimpleNamespace(attributes={"velocity": values}),
        4,
        "mesh 'Wall'",
        lambda *e: said.append(e),
    )
    assert found is None
    assert said == [("mesh 'Wall'", "its 'velocity' has 3 values for 4 points: not used")]


readable = pytest.mark.skipif(
    not hasattr(bpy.types.Object, "evaluated_geometry"), reason="Blender does not show it"
)


def scatter(film, vector, formula="2", with_ids=False, kind="FLOAT_VECTOR"):
    """A wall instanced on points in a line, whose instances carry a velocity; the count is a formula."""
    tree, line = instances_on_line(film, wall(film, 0.0, "Part"), 2)
    drive(tree, f'nodes["{line.name}"].inputs["Count"].default_value', formula)
    host = film.objects["Host"]
    if with_ids:
        identify = tree.nodes.new("GeometryNodeSetID")
        place = next(n for n in tree.nodes if n.bl_idname == "GeometryNodeInstanceOnPoints")
        tree.links.new(line.outputs["Mesh"], identify.inputs["Geometry"])
        tree.links.new(identify.outputs["Geometry"], place.inputs["Points"])
    store_attribute(host, "velocity", kind, "INSTANCE", vector)
    return host


def ways(film, **options):
    """float64 [instances, 3]: from the opening of the shutter to its end."""
    snapshot, report, _ = export_probe.through_engine(film, motion_steps=17, **options)
    assert len(report) == 0
    instances = snapshot["instances"]
    first = np.cumsum(instances["knots"]) - instances["knots"]
    places = instances["world_from_object"][:, :3, 3]
    return places[first + instances["knots"] - 1] - places[first]


@readable
@pytest.mark.parametrize("with_ids", [False, True])
def test_instances_that_stand_still_fly_by_their_velocity(film, render, with_ids):
    """One of them; 480 metres a second are 20 in a frame.  It lies and flies the other way before the host is turned."""
    host = scatter(film, (0, 480, 0), "1", with_ids)
    host.location.x, host.rotation_euler.z = 6.0, -math.pi / 2
    assert ways(film) == pytest.approx(np.array([[20.0, 0.0, 0.0]]), abs=1e-5)
    for corner in bpy.data.objects["Part"].data.vertices:
        corner.co = (corner.co.y, -corner.co.x - 200.0, 0.0)
    expect_edge(render, film)


@readable
def test_the_motion_of_their_object_comes_on_top(film):
    """It turns by half a turn while they fly along an axis of it that is up at first, and goes to the right."""
    host = scatter(film, (480, 0, 0), "1")
    drive(host, "location", "5 * (frame - 10)", 0)
    drive(host, "rotation_euler", "pi * (frame - 10.5)", 2)
    # Half of the way of 20 is to come at the frame, when the shutter opens.
    assert ways(film) == pytest.approx(np.array([[5.0, 20.0, 0.0]]), abs=1e-4)


@readable
def test_those_that_come_and_go_fly_by_it_too(film):
    """The third comes at .4 of the frame, and is seen at its place then."""
    scatter(film, (0, 48, 0), "2 if frame < 10.4 else 3", with_ids=True)
    assert ways(film) == pytest.approx(np.tile([0.0, 2.0, 0.0], (3, 1)), abs=1e-5)


@readable
def test_those_of_an_object_that_has_none_at_first_go_by_their_places(film):
    """Where it was before its first instance is not known."""
    scatter(film, (0, 48, 0), "0 if frame < 10.4 else 1", with_ids=True)
    assert ways(film) == pytest.approx(np.zeros((1, 3)), abs=1e-5)


@readable
@pytest.mark.parametrize("with_ids, expected", [(False, (0, 2, 0)), (True, (3, 0, 0))])
def test_places_say_more_where_they_can(film, with_ids, expected):
    """They go 3 metres to the right, as nodes have it.  Another number of them without ids may be another order."""
    host = scatter(film, (0, 48, 0), "2 if frame < 10.4 else 3", with_ids)
    tree = host.modifiers["Nodes"].node_group
    end = next(n for n in tree.nodes if n.bl_idname == "NodeGroupOutput")
    move = tree.nodes.new("GeometryNodeTranslateInstances")
    tree.links.new(end.inputs[0].links[0].from_socket, move.inputs["Instances"])
    tree.links.new(move.outputs["Instances"], end.inputs[0])
    drive(tree, f'nodes["{move.name}"].inputs["Translation"].default_value', "3 * (frame - 10)", 0)
    found = ways(film)
    assert found[:2] == pytest.approx(np.tile(np.float64(expected), (2, 1)), abs=1e-5)


@readable
def test_instances_of_another_type_are_named(film):
    scatter(film, (480, 0, 0), kind="FLOAT_COLOR")
    snapshot, report, _ = export_probe.through_engine(film)
    assert [entry[:2] for entry in report.entries()] == [
        ("object 'Host'", "'velocity' of its instances (FLOAT_COLOR) is no vector: not used")
    ]
    assert (snapshot["instances"]["knots"] == 1).all()
