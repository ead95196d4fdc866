# SPDX-License-Identifier: GPL-3.0-or-later
"""The pass Vector beside that of Cycles, which has it without motion blur."""

import bpy
import numpy as np
import pytest
import scene_parts
from motion_parts import drive, shape_key

WIDTH, HEIGHT = 64, 36


@pytest.fixture
def film(scene):
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.view_layers[0].use_pass_vector = True
    scene.granita.samples = scene.cycles.samples = 16
    scene.granita.pixel_filter, scene.granita.filter_width = "BOX", 1.0
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1.0
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    camera = scene_parts.add_camera(scene, (0, 0, 6))
    camera.data.lens = 40.0
    scene.frame_set(10)
    return scene


def vector(scene, render, engine):
    scene.render.engine = engine
    passes = render(scene, engine)
    return np.stack(
        [next(v for k, v in passes.items() if k.endswith(f"Vector.{c}")) for c in "XYZW"], axis=-1
    )


def a_mover(scene):
    drive(scene_parts.add_square(scene), "location", "0.02 * (frame - 8) ** 3", 0)


def a_turning_child(scene):
    hub = scene_parts.add_object(scene, "Hub", None)
    drive(hub, "rotation_euler", "frame / 8", 2)
    blade = scene_parts.add_square(scene, "Blade")
    blade.parent, blade.location.x = hub, 0.7


def a_shape(scene):
    square = scene_parts.add_square(scene)
    key = shape_key(square)
    for point in key.data:  # all along: Cycles makes two triangles of a quad that is not flat
        point.co.x *= 2.0
    drive(key, "value", "(frame - 9) / 2")


def a_cage(scene):
    bpy.ops.mesh.primitive_cube_add(size=2)
    cube = bpy.context.object
    drive(shape_key(cube), "value", "frame - 9")
    scene_parts.add_subsurf(cube, 3)


def a_camera(scene):
    scene_parts.add_square(scene, size=9.0)
    drive(scene.camera, "location", "(frame - 10) / 10", 0)
    drive(scene.camera, "rotation_euler", "(frame - 10) / 20", 2)


def instances(scene):
    part = bpy.data.collections.new("Part")
    part.objects.link(scene_parts.add_square(scene, size=1.0))
    scene.collection.objects.unlink(part.objects[0])
    for i in range(3):
        place = scene_parts.add_object(scene, f"Place{i}", None, (1.5 * i - 1.5, 0, 0))
        place.instance_type, place.instance_collection = "COLLECTION", part
        drive(place, "location", f"(frame - 10) * {i} / 9", 1)


def points_that_fly(scene):
    square = scene_parts.add_square(scene)
    attribute = square.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.tile(np.float32([6, 3, 0]), 4))


@pytest.mark.parametrize(
    "build",
    [
        a_mover,
        a_turning_child,
        a_shape,
        a_cage,
        a_camera,
        instances,
        points_that_fly,
    ],
)
def test_vectors_are_those_of_cycles(film, render, build):
    build(film)
    ours, theirs = (vector(film, render, engine) for engine in ("GRANITA", "CYCLES"))
    seen = np.abs(theirs).max(axis=-1) > 0.0
    assert seen.mean() > 0.05 and np.abs(theirs).max() > 1.0
    difference = np.abs(ours - theirs).max(axis=-1)
    # Both average 16 samples of a pixel, which are not the same: a gradient shows the difference, and
    # few pixels of edges.
    assert np.mean(difference > 0.03 * np.abs(theirs).max()) < 0.02


def test_a_zoom_has_vectors_too(film, render):
    """Cycles leaves it out.  From 38 to 40 mm and on to 42: x / 40 * (38 - 40) and x / 40 * (40 - 42)."""
    scene_parts.add_square(film, size=9.0)
    drive(film.camera.data, "lens", "40 + (frame - 10) * 2")
    made = vector(film, render, "GRANITA")
    x = np.arange(WIDTH) + 0.5 - WIDTH / 2
    expected = np.broadcast_to(-x / 20.0, (HEIGHT, WIDTH))
    # The mean of 16 stratified samples lies within .1 pixel of the centre.
    assert made[..., 0] == pytest.approx(expected, abs=0.1 / 20)
    assert made[..., 2] == pytest.approx(expected, abs=0.1 / 20)


def test_an_orthographic_camera(film, render):
    """Cycles 4.5 is wrong here.  64 pixels span 8 m; the square goes by .02 (2^3 - 1) and .02 (3^3 - 2^3)
    metres, the camera up by .1 a frame."""
    film.camera.data.type, film.camera.data.ortho_scale = "ORTHO", 8.0
    drive(scene_parts.add_square(film, size=30.0), "location", "0.02 * (frame - 8) ** 3", 0)
    drive(film.camera, "location", "(frame - 10) / 10", 1)
    expected = np.float32([-0.14, 0.1, -0.38, 0.1]) * 8.0
    made = vector(film, render, "GRANITA")
    assert made == pytest.approx(np.broadcast_to(expected, (HEIGHT, WIDTH, 4)), abs=1e-3)


def test_a_changed_topology_is_named(film, render):
    import export_probe

    square = scene_parts.add_square(film)
    drive(square.modifiers.new("Screw", "SCREW"), "render_steps", "int(frame)")
    drive(square, "location", "frame - 10", 0)
    snapshot, report, _ = export_probe.through_engine(film)
    assert [name for name, _, _ in report.entries()] == ["mesh 'Square'"]
    assert "adjacent" not in snapshot["geometries"][0]
    x = snapshot["instances"]["adjacent"][:, 0, 3]
    assert x == pytest.approx([-1.0, 1.0])


def test_it_is_the_same_with_motion_blur(film, render):
    """Where Cycles has none: of what stands in the picture it is still the way of whole frames."""
    film.camera.data.type, film.camera.data.ortho_scale = "ORTHO", 8.0
    drive(scene_parts.add_square(film, size=30.0), "location", "(frame - 10) / 2", 0)
    for blur in (False, True):
        film.render.use_motion_blur = blur
        made = vector(film, render, "GRANITA")
        # 64 pixels span 8 m.
        assert made == pytest.approx(np.tile([-4.0, 0, -4.0, 0], (HEIGHT, WIDTH, 1)), abs=1e-3)
    assert (film.frame_current, film.frame_subframe) == (10, 0.0)
