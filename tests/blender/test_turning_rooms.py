# SPDX-License-Identifier: GPL-3.0-or-later
"""What is built of several objects and turns as one stays closed: none of it has knots of its own."""

import math

import bpy
import export_probe
import pytest
import scene_parts
from bounced_parts import picture, surface
from motion_parts import with_shutter

# Place and turn of each wall, its face inward.
WALLS = [
    ((0, 0, -1), (0, 0, 0)),
    ((0, 0, 1), (math.pi, 0, 0)),
    ((1, 0, 0), (0, -math.pi / 2, 0)),
    ((-1, 0, 0), (0, math.pi / 2, 0)),
    ((0, 1, 0), (math.pi / 2, 0, 0)),
    ((0, -1, 0), (-math.pi / 2, 0, 0)),
]


def walls(scene):
    for i, (place, turn) in enumerate(WALLS):
        wall = scene_parts.add_square(scene, f"Wall {i}", 2.0, place)
        wall.rotation_euler = turn
        surface(wall, "ShaderNodeBsdfDiffuse", (1.0, 1.0, 1.0))
        yield wall


def turn(scene, root, angle):
    for frame, sign in ((0, -1), (2, 1)):
        root.rotation_euler = (0.0, sign * angle, 0.5 * sign * angle)
        root.keyframe_insert("rotation_euler", frame=frame)
    scene_parts.make_linear(root)
    scene.frame_set(1)


@pytest.fixture
def room(scene):
    """Closed, a camera within, a sun outside."""
    with_shutter(scene)
    camera = scene_parts.add_camera(scene, (0.0, 0.0, 0.0))
    camera.data.type, camera.data.lens = "PERSP", 18.0
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy = 1000.0
    scene_parts.add_object(scene, "Sun", sun).rotation_euler = (0.7, 0.5, 0.0)
    scene.granita.samples = 64
    scene.render.resolution_x = scene.render.resolution_y = 48
    return scene


@pytest.mark.parametrize("angle", [0.0, 0.1, 0.3, 0.6])
@pytest.mark.parametrize("goes_along", [False, True])
@pytest.mark.parametrize("threshold", [0.1, 1000.0])
def test_no_light_comes_through_edges(room, render, angle, goes_along, threshold):
    """Walls by chords of their own came apart by a sixteenth of a pixel: up to 4 % of the sun along the edges; and corners
    of micropolygons, which a high threshold shows, lay on two walls: 19 %."""
    room.granita.shading_threshold = threshold
    root = scene_parts.add_object(room, "Root", None)
    for wall in walls(room):
        wall.parent = root
    if goes_along:
        room.camera.parent = root
    turn(room, root, angle)
    assert picture(render(room), "Combined").max() == 0.0


@pytest.mark.parametrize("as_instance", [False, True])
def test_walls_have_as_many_knots_as_any_of_them(room, as_instance):
    """Children of a parent, or of an instance of their collection; a wall that turns alone has its own."""
    part = bpy.data.collections.new("Part")
    root = scene_parts.add_object(room, "Root", None)
    for wall in walls(room):
        if as_instance:
            part.objects.link(wall)
            room.collection.objects.unlink(wall)
        else:
            wall.parent = root
    if as_instance:
        root.instance_type, root.instance_collection = "COLLECTION", part
    alone = scene_parts.add_square(room, "Alone", 0.01)
    turn(room, alone, 0.3)
    turn(room, root, 0.3)
    snapshot, _, _ = export_probe.through_engine(room, motion_steps=17)
    knots = sorted(snapshot["instances"]["knots"].tolist())
    assert knots[0] < knots[1]
    assert knots[1:] == [knots[-1]] * 6
