# SPDX-License-Identifier: GPL-3.0-or-later
"""The attribute `velocity`, of whatever has points and however it is placed: exact motion, or a warning that
names what cannot be used."""

import math
from types import SimpleNamespace

import export_probe
import numpy as np
import pytest
import scene_parts
from film_parts import HEIGHT, MIDPOINTS, WIDTH, alpha, hold, left_of, moving_disc, over_time, wall
from hair_parts import curve_through, mesh_points
from motion_parts import drive, set_position, shape_key
from node_parts import hidden_collection, instances_on_line, store_attribute

from granita.export.velocity import read_velocity

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


def test_instances_move_by_their_places_whatever_they_say(film):
    instances_on_line(film, wall(film, 0.0, "Part"), 1)
    place = film.objects["Host"]
    store_attribute(place, "velocity", "FLOAT_VECTOR", "INSTANCE", (480, 0, 0))
    drive(place, "location", "frame - 10", 1)
    snapshot, report, _ = export_probe.through_engine(film)
    ways = np.diff(export_probe.knots_of(snapshot, "Part")[[0, -1], :3, 3], axis=0)
    assert ways[0] == pytest.approx([0.0, 1.0, 0.0]) and len(report) == 0


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
