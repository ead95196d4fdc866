# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything in Blender that can move a thing moves the same edge over the same pixels (film_parts)."""

import bpy
import numpy as np
import pytest
import scene_parts
from film_parts import (
    HEIGHT,
    MIDPOINTS,
    RMSE,
    WIDTH,
    WORST,
    alpha,
    half_plane,
    hold,
    left_of,
    over_time,
    wall,
)
from motion_parts import drive, set_position

WAY = "6 + 20 * (frame - 10)"
PIXELS = np.arange(WIDTH)


def goer(scene, name="Goer"):
    """An empty that goes the way."""
    empty = scene_parts.add_object(scene, name, None)
    drive(empty, "location", WAY, 0)
    return empty


def grandparent(scene, thing):
    parent = scene_parts.add_object(scene, "Parent", None)
    parent.parent, thing.parent = goer(scene), parent


def mirrored_parent(scene, thing):
    """Case 18: a negative determinant turns faces round, and moves them all the same."""
    mirror = scene_parts.add_object(scene, "Mirror", None)
    mirror.scale.x = -1.0
    thing.parent = mirror
    thing.scale.x = -1.0
    drive(thing, "location", f"-({WAY})", 0)


def copy_location(scene, thing):
    thing.constraints.new("COPY_LOCATION").target = goer(scene)


def child_of(scene, thing):
    constraint = thing.constraints.new("CHILD_OF")
    constraint.target = goer(scene)
    constraint.inverse_matrix.identity()


def limit_location(scene, thing):
    constraint = thing.constraints.new("LIMIT_LOCATION")
    constraint.use_max_x, constraint.max_x = True, 100.0
    drive(constraint, "max_x", WAY)
    thing.location.x = 100.0


def follow_path(scene, thing):
    curve = bpy.data.curves.new("Path", "CURVE")
    curve.dimensions, curve.use_path = "3D", True
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points[0].co, spline.points[1].co = (6, 0, 0, 1), (26, 0, 0, 1)
    constraint = thing.constraints.new("FOLLOW_PATH")
    constraint.target = scene_parts.add_object(scene, "Path", curve)
    constraint.use_fixed_location = True
    drive(constraint, "offset_factor", "frame - 10")


def bone(scene, thing):
    bpy.ops.object.armature_add()
    armature = bpy.context.object
    thing.parent, thing.parent_type = armature, "BONE"
    thing.parent_bone = armature.data.bones[0].name
    thing.rotation_euler.x = -np.pi / 2  # along a bone is y, and the bone stands up
    drive(armature.pose.bones[0], "location", WAY, 0)


def keyed(thing, first, last):
    """Linear keys of location x at two (frame, value)."""
    for frame, value in (first, last):
        thing.location.x = value
        thing.keyframe_insert("location", index=0, frame=frame)
    scene_parts.make_linear(thing)


def keys(scene, thing):
    keyed(thing, (10, 6.0), (20, 206.0))


def nla(scene, thing):
    """A strip of twice the length plays its action at half the speed."""
    keyed(thing, (0, 6.0), (10, 406.0))
    animation = thing.animation_data
    strip = animation.nla_tracks.new().strips.new("Strip", 10, animation.action)
    strip.scale = 2.0
    animation.action = None


def driven_by_a_property(scene, thing):
    empty = scene_parts.add_object(scene, "Panel", None)
    empty["way"] = 0.0
    drive(empty, '["way"]', WAY)
    driver = thing.driver_add("location", 0).driver
    variable = driver.variables.new()
    variable.name = "way"
    variable.targets[0].id, variable.targets[0].data_path = empty, '["way"]'
    driver.expression = "way"


def stretched_time(scene, thing):
    """Frames mapped from 100 to 200: a frame of the film is half of one of the scene."""
    scene.render.frame_map_old, scene.render.frame_map_new = 100, 200
    scene.frame_set(20)
    drive(thing, "location", "6 + 40 * (frame - 10)", 0)


def nested_instances(scene, thing):
    """A collection in a collection, and the outer empty goes."""
    for name in ("Inner", "Outer"):
        part = bpy.data.collections.new(name)
        part.objects.link(thing)
        for collection in list(thing.users_collection):
            if collection != part:
                collection.objects.unlink(thing)
        thing = scene_parts.add_object(scene, f"Of{name}", None)
        thing.instance_type, thing.instance_collection = "COLLECTION", part
    drive(thing, "location", WAY, 0)


def instance_on_a_vertex(scene, thing):
    points = scene_parts.add_mesh(scene, "Points", [(0, 0, 0)], [])
    points.instance_type = "VERTS"
    thing.parent = points
    drive(points, "location", WAY, 0)


def instance_on_a_face(scene, thing):
    face = scene_parts.add_square(scene, "Face", 1e-3)
    face.instance_type, face.show_instancer_for_render = "FACES", False
    thing.parent = face
    drive(face, "location", WAY, 0)


@pytest.mark.parametrize(
    "build",
    [
        grandparent,
        mirrored_parent,
        copy_location,
        child_of,
        limit_location,
        follow_path,
        bone,
        keys,
        nla,
        driven_by_a_property,
        stretched_time,
        nested_instances,
        instance_on_a_vertex,
        instance_on_a_face,
    ],
)
def test_whatever_moves_it_the_edge_is_blurred(film, render, build):
    build(film, wall(film, 0.0))
    expected = over_time(lambda t: left_of(6 + 20 * t, PIXELS), MIDPOINTS)
    hold(alpha(render, film), np.broadcast_to(expected, (HEIGHT, WIDTH)))


def test_a_scale_through_nothing(film, render):
    """Case 18: of half width 10 |2 t - 1|; mirrored in the first half of the shutter."""
    square = scene_parts.add_square(film, size=20.0, location=(16, 8, 0))
    drive(square, "scale", "2 * (frame - 10) - 1", 0)

    def inside(t):
        half = 10 * abs(2 * t - 1)
        return left_of(16 + half, PIXELS) - left_of(16 - half, PIXELS)

    image = alpha(render, film)
    expected = over_time(inside, MIDPOINTS)
    hold(image, np.broadcast_to(expected, (HEIGHT, WIDTH)), crossings=2)


def test_a_camera_that_rolls_sees_what_turns_the_other_way(film, render):
    """By one and a half turns."""
    film.granita.motion_steps = 65
    half = half_plane(film)
    drive(film.camera, "rotation_euler", "3 * pi * (frame - 10)", 2)
    rolled = alpha(render, film)
    film.camera.driver_remove("rotation_euler", 2)
    film.camera.rotation_euler.z = 0.0
    drive(half, "rotation_euler", "-3 * pi * (frame - 10)", 2)
    turned = alpha(render, film)
    # Three edges pass a pixel; both pictures have the noise of the film, of samples that are the same.
    assert np.ptp(turned) > 0.2
    assert np.sqrt(np.mean((rolled - turned) ** 2)) <= RMSE * np.sqrt(3)
    assert np.abs(rolled - turned).max() <= WORST * np.sqrt(3)


def test_a_camera_that_flies_along(film, render):
    """What goes with the camera stands, what stands goes the other way."""
    drive(film.camera, "location", "16 + 20 * (frame - 10)", 0)
    wall(film, 26.0)
    expected = over_time(lambda t: left_of(26 - 20 * t, PIXELS), MIDPOINTS)
    hold(alpha(render, film), np.broadcast_to(expected, (HEIGHT, WIDTH)))


@pytest.mark.parametrize("position", ["START", "CENTER", "END"])
def test_a_cut_between_cameras_does_not_smear(film, render, position):
    """A marker switches within the shutter: the frame is wholly the camera's that has it."""
    film.render.motion_blur_shutter = 3.0
    set_position(film, position)
    wall(film, 16.5)
    first = film.camera
    second = scene_parts.add_camera(film, (90.0, 70.0, 50.0), ortho_scale=3.0)
    for frame, camera in ((8, second), (10, first), (11, second)):
        film.timeline_markers.new(f"F{frame}", frame=frame).camera = camera
    film.frame_set(10)
    assert np.array_equal(
        alpha(render, film), np.broadcast_to(np.float32(left_of(16.5, PIXELS)), (HEIGHT, WIDTH))
    )
