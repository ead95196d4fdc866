# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that shine light what is around them without a bounce: form factors, motion, thousands of them, mirrors."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import mirror, reflecting
from test_elements import curves
from test_refined_shading import ALBEDO, EXECUTORS

SIZE = (32, 32)
# Flags of instances: seen by the camera, casting shadows, seen by diffuse and glossy rays.
CAMERA, SHADOWS, DIFFUSE, GLOSSY = 1, 2, 8, 16
HIDDEN_LAMP = SHADOWS | DIFFUSE | GLOSSY
FLOOR, LAMP = 40.0, 30.0  # depths: the camera looks along z


def stage(executor="SIMD", **options):
    """A floor that fills the frame, seen straight from above."""
    more = {"samples": 16, "light_samples": 64, "bounces": 0, **options}
    snapshot = s.orthographic(SIZE, executor=executor, **more)
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (ALBEDO,) * 3 + (1,)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    snapshot["instances"]["flags"] = []
    s.quad(snapshot, s.rectangle(-8, -8, 40, 40, FLOOR), 0)
    snapshot["instances"]["flags"].append(CAMERA | SHADOWS | DIFFUSE | GLOSSY)
    return snapshot


def shines(snapshot, points, faces, strength=1.0, flags=HIDDEN_LAMP, **more):
    s.mesh(snapshot, points, faces, s.emission(snapshot, (strength,) * 3), **more)
    snapshot["instances"]["flags"].append(flags)


def square(snapshot, x0, y0, x1, y1, z=LAMP, **more):
    shines(snapshot, s.rectangle(x0, y0, x1, y1, z), [(0, 1, 2, 3)], **more)


def seen(snapshot):
    return s.render(snapshot)["combined"][..., 0]


def pixels():
    """(x, y) of the middles of pixels, each [rows, columns]."""
    rows, columns = np.mgrid[0 : SIZE[1], 0 : SIZE[0]]
    return columns + 0.5, rows + 0.5


def corner_factor(x, y, h):
    """Of a patch that faces the corner of a rectangle x by y, h away (Howell, configuration C-11); odd in x and y."""
    a, b = x / h, y / h
    u, v = np.sqrt(1 + a * a), np.sqrt(1 + b * b)
    return (a / u * np.arctan(b / u) + b / v * np.arctan(a / v)) / (2 * np.pi)


def form_factor(x0, y0, x1, y1, h, x, y):
    def corner(cx, cy):
        return corner_factor(cx - x, cy - y, h)

    return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)


@pytest.mark.parametrize("executor", EXECUTORS)
def test_a_square_lights_by_its_form_factor(executor):
    snapshot = stage(executor)
    square(snapshot, 10, 12, 22, 18)
    truth = ALBEDO * form_factor(10, 12, 22, 18, FLOOR - LAMP, *pixels())
    assert seen(snapshot) == pytest.approx(truth, abs=0.004)
    assert seen(snapshot).mean() == pytest.approx(truth.mean(), rel=0.002)


def test_a_square_close_to_the_floor_too():
    """A fiftieth of its side above it, where what it lights goes over from half of all there is to nothing."""
    snapshot = stage(light_samples=256)
    square(snapshot, 8, 8, 24, 24, FLOOR - 0.3)
    x, y = pixels()
    truth = ALBEDO * form_factor(8, 8, 24, 24, 0.3, x, y)
    away = np.maximum(np.abs(x - 16), np.abs(y - 16))
    flat = (away < 6) | (away > 10)  # a pixel's mean is not its middle along the edge
    assert seen(snapshot)[flat] == pytest.approx(truth[flat], abs=0.005)


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("how", ["transforms", "points"])
def test_a_square_that_moves_lights_from_where_it_is(executor, how):
    """From the left to the right, as an object and by its vertices; the floor takes the mean of the shutter."""
    snapshot = stage(executor, light_samples=256)
    corners = np.array(s.rectangle(-2, 12, 4, 18, LAMP))
    ways = np.array([[0, 0, 0], [15, 0, 0], [30, 0, 0]], float)
    if how == "transforms":
        moves = {"transforms": [s.translation(*way) for way in ways]}
    else:
        corners, moves = corners[None] + ways[:, None], {}
    shines(snapshot, corners, [(0, 1, 2, 3)], 4.0, **moves)
    times = (np.arange(200) + 0.5) / 200 * 30
    truth = (
        4
        * ALBEDO
        * np.mean(
            [form_factor(-2 + t, 12, 4 + t, 18, FLOOR - LAMP, *pixels()) for t in times], axis=0
        )
    )
    assert seen(snapshot) == pytest.approx(truth, abs=0.012)
    assert seen(snapshot).mean() == pytest.approx(truth.mean(), rel=0.004)


@pytest.mark.parametrize("bounces", [0, 1])
@pytest.mark.parametrize(("near", "lights"), [("shines", 1), ("matte", 1), ("another", 2)])
def test_what_shines_hides_its_own_far_side(near, lights, bounces):
    """Two sheets, the one above the other, that cast no shadow: of one mesh, light of the far one comes from behind."""
    snapshot = stage(bounces=bounces)
    sheets = [s.rectangle(10, 12, 22, 18, z) for z in (LAMP - 0.01, LAMP)]
    if near == "another":
        for sheet in sheets:
            shines(snapshot, sheet, [(0, 1, 2, 3)], flags=DIFFUSE | GLOSSY)
    else:
        faces = [(0, 1, 2, 3), (4, 5, 6, 7)]
        slots = np.array([0, 1], np.int32)
        shines(snapshot, sum(sheets, []), faces, flags=DIFFUSE | GLOSSY, material_index=slots)
        table = snapshot["instances"]
        table["slots"][-1] = 2
        table["materials"].append(0 if near == "matte" else table["materials"][-1])
    truth = lights * ALBEDO * form_factor(10, 12, 22, 18, FLOOR - LAMP, *pixels())
    assert seen(snapshot) == pytest.approx(truth, abs=0.004)
    assert seen(snapshot).mean() == pytest.approx(truth.mean(), rel=0.003)


def ball(radius, center, around=48):
    """(points, faces), poles left open by a thousandth."""
    rings = np.linspace(0.001, np.pi - 0.001, around // 2)
    angles = np.arange(around) * 2 * np.pi / around
    x = np.outer(np.sin(rings), np.cos(angles))
    y = np.outer(np.sin(rings), np.sin(angles))
    z = np.outer(np.cos(rings), np.ones(around))
    points = np.array(center) + radius * np.stack([x, y, z], axis=-1).reshape(-1, 3)
    faces = [
        (
            r * around + i,
            r * around + (i + 1) % around,
            (r + 1) * around + (i + 1) % around,
            (r + 1) * around + i,
        )
        for r in range(len(rings) - 1)
        for i in range(around)
    ]
    return points, faces


def test_a_ball_of_a_thousand_faces_lights_as_a_ball():
    """E = pi L (r / d)^2 cos.  Its faces lie inside the sphere: .6 % of its section is missing."""
    snapshot = stage()
    points, faces = ball(4.0, (16, 16, 20))
    shines(snapshot, points, faces, 20.0)
    x, y = pixels()
    away = np.sqrt((x - 16) ** 2 + (y - 16) ** 2 + 20**2)
    truth = ALBEDO * 20.0 * (4.0 / away) ** 2 * 20 / away
    part = (
        np.sin(2 * np.pi / 48) / (2 * np.pi / 48)
    ) ** 0.5  # of a circle's area that 48 chords hold, as a rest
    assert seen(snapshot).mean() == pytest.approx(truth.mean() * part, rel=0.006)
    assert seen(snapshot) == pytest.approx(truth, rel=0.06)


@pytest.mark.parametrize("count", [3, 30])
def test_many_small_squares_add_up(count):
    """900 of them: each as good as a point, L A cos cos / d^2, under the floor's half of space."""
    rng = np.random.default_rng(7)
    snapshot = stage()
    places = rng.uniform((0, 0, 25), (32, 32, 30), (count**2, 3))
    half = 0.05
    corners = np.array([(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)])
    points = (places[:, None] + corners).reshape(-1, 3)
    faces = [tuple(range(4 * i, 4 * i + 4)) for i in range(len(places))]
    strength = 20000.0 / count**2
    shines(snapshot, points, faces, strength)
    x, y = pixels()
    truth = np.zeros(SIZE[::-1])
    for px, py, pz in places:
        h = FLOOR - pz
        truth += h * h / ((x - px) ** 2 + (y - py) ** 2 + h * h) ** 2
    truth *= ALBEDO / np.pi * strength * (2 * half) ** 2
    assert seen(snapshot).mean() == pytest.approx(truth.mean(), rel=0.01)
    error = np.sqrt(np.mean((seen(snapshot) / truth - 1) ** 2))
    assert error < 0.05


def test_nothing_comes_through_a_closed_box():
    """A square outside of a box of six planes that encloses the view of the floor."""
    snapshot = stage()
    square(snapshot, -500, -500, 500, 500, -5.0, strength=100.0)
    corners = np.array([(x, y, z) for z in (1.0, FLOOR) for y in (-8, 40) for x in (-8, 40)], float)
    for face in [(0, 1, 3, 2), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]:
        s.quad(snapshot, corners[list(face)], 0)
        snapshot["instances"]["flags"].append(SHADOWS)
    assert seen(snapshot).max() == 0.0


@pytest.mark.parametrize(("flags", "lights"), [(SHADOWS | GLOSSY, False), (DIFFUSE, True)])
def test_what_diffuse_rays_do_not_see_lights_nothing_diffuse(flags, lights):
    """Whether it casts shadows of other lamps or not."""
    snapshot = stage()
    square(snapshot, 8, 8, 24, 24, flags=flags)
    assert (seen(snapshot).max() > 0.1) == lights


def test_a_mirror_shows_it_without_a_bounce():
    """The square, mirrored, stands where it would be seen from above."""
    snapshot = s.orthographic(SIZE, samples=16, bounces=0)
    s.quad(snapshot, s.rectangle(-8, -8, 40, 40, FLOOR), mirror(snapshot, 0.5))
    snapshot["instances"]["flags"] = [CAMERA | SHADOWS]
    square(snapshot, 8, 8, 24, 24)
    image = seen(snapshot)
    assert image[10:22, 10:22] == pytest.approx(0.5, abs=1e-5)
    assert image[:6].max() == 0.0 and image[26:].max() == 0.0


def many(**options):
    snapshot = stage(**options)
    points, faces = ball(4.0, (10, 20, 25), 16)
    shines(snapshot, points, faces, 10.0)
    square(snapshot, 20, 2, 30, 12, transforms=[s.translation(0), s.translation(-4)])
    return s.render(snapshot)["combined"]


def test_bits_do_not_depend_on_buckets_and_threads():
    whole = many()
    assert np.array_equal(whole, many(bucket_size=16))
    assert np.array_equal(whole, many(threads=1))
    assert np.array_equal(whole[8:24, 4:20], many(crop=np.int32([4, 8, 20, 24])))


@pytest.mark.parametrize("bounces", [1, 4])
def test_they_light_no_more_where_light_bounces(bounces):
    """One floor and a lamp that reflects nothing: no way brings anything more, and the lamp is not met as well."""
    snapshot = stage(bounces=bounces, diffuse_bounces=4, clamp_indirect=0.0)
    square(snapshot, 10, 12, 22, 18)
    truth = ALBEDO * form_factor(10, 12, 22, 18, FLOOR - LAMP, *pixels())
    assert seen(snapshot) == pytest.approx(truth, abs=0.004)


def test_strands_that_shine_are_named_where_nothing_bounces():
    snapshot = stage()
    curves(snapshot, np.linspace((4, 16, LAMP), (28, 16, LAMP), 5), [5], 1.0, s.emission(snapshot))
    snapshot["instances"]["flags"].append(HIDDEN_LAMP)
    assert [text for _, text, _ in s.render(snapshot)["warnings"]] == [
        "shines, but is no mesh: it is seen, but lights nothing without bounces"
    ]
    snapshot["options"].update(bounces=1)
    rendered = s.render(snapshot)
    assert rendered["warnings"] == [] and rendered["combined"][..., 0].mean() > 0.001


@pytest.mark.parametrize("thickness", [0.0003, 0.01])
def test_a_thin_box_lights_as_its_side_does(thickness):
    """Its far side does not shine through, however thin it is."""
    snapshot = stage(light_samples=256)
    corners = [(x, y, z) for z in (LAMP - thickness, LAMP) for y in (12, 18) for x in (10, 22)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    shines(snapshot, np.array(corners), faces)
    truth = ALBEDO * form_factor(10, 12, 22, 18, FLOOR - LAMP, *pixels())
    assert seen(snapshot).mean() == pytest.approx(truth.mean(), rel=0.01)


def test_what_lies_just_before_it_hides_it():
    snapshot = stage()
    square(snapshot, 10, 12, 22, 18)
    s.quad(snapshot, s.rectangle(9, 11, 23, 19, LAMP + 0.0003), 0)
    snapshot["instances"]["flags"].append(SHADOWS)
    assert seen(snapshot).max() == 0.0


@pytest.mark.parametrize("moves", [False, True])
@pytest.mark.parametrize("far", [1e4, 1e5])
def test_vertices_far_from_their_object_light_all_the_same(far, moves):
    """Rays meet them less exactly than their lamp stands: it is not to shadow itself."""
    snapshot = stage(light_samples=64)
    away = far * np.array([0.71, 0.53, 1.17])
    turn = np.eye(4)
    turn[:2, :2] = [[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]]
    tilt = np.eye(4)
    tilt[1:3, 1:3] = [[np.cos(0.2), -np.sin(0.2)], [np.sin(0.2), np.cos(0.2)]]
    turn = turn @ tilt
    there = np.eye(4)
    there[:3, 3] = -(turn[:3, :3] @ away) + (16, 15, FLOOR - 3)
    matrix = there @ turn
    corners = np.array([(-6, -3, 0), (6, -3, 0), (6, 3, 0), (-6, 3, 0)]) + away
    ways = [matrix, s.translation(0.01) @ matrix] if moves else [matrix]
    shines(snapshot, corners, [(0, 1, 2, 3)], transforms=ways)
    lit = seen(snapshot).mean()
    unturned = stage(light_samples=64)
    still = np.eye(4)
    still[:3, :3], still[:3, 3] = turn[:3, :3], (16, 15, FLOOR - 3)
    shines(unturned, corners - away, [(0, 1, 2, 3)], transforms=[still])
    # Single precision holds vertices at 1e5 m to 8 mm of their 6 and 12 m.
    assert lit == pytest.approx(seen(unturned).mean(), rel=0.01)


def test_emission_for_one_type_of_ray_alone_is_named():
    nodes = [
        {"type": "ShaderNodeLightPath", "inputs": {}},
        {
            "type": "ShaderNodeEmission",
            "inputs": {"Color": (1.0,) * 4, "Strength": ("LINK", 0, "Is Diffuse Ray")},
        },
    ]
    snapshot = stage()
    snapshot["materials"].append({"name": "Rays", "nodes": nodes, "surface": (1, "Emission")})
    s.quad(snapshot, s.rectangle(10, 12, 22, 18, LAMP), 1)
    snapshot["instances"]["flags"].append(HIDDEN_LAMP)
    assert [owner for owner, *_ in s.render(snapshot)["warnings"]] == ["material 'Rays'"]


def test_no_way_goes_further_for_what_no_ray_sees():
    def rays(extra):
        snapshot = stage(bounces=2, diffuse_bounces=4)
        square(snapshot, -8, -8, 40, 40, 5.0)
        if extra:
            snapshot["materials"].append(
                {
                    "name": "Hidden",
                    "nodes": [
                        {"type": "ShaderNodeLightPath", "inputs": {}},
                        {
                            "type": "ShaderNodeEmission",
                            "inputs": {"Strength": ("LINK", 0, "Is Diffuse Ray")},
                        },
                    ],
                    "surface": (1, "Emission"),
                }
            )
            s.quad(snapshot, s.rectangle(0, 0, 4, 4, 8.0), len(snapshot["materials"]) - 1)
            snapshot["instances"]["flags"].append(SHADOWS)
        return s.render(snapshot)["statistics"]["rays_bounce"]

    assert rays(True) == rays(False)


def cut_stone(radius, center, around=24):
    """(points, faces): the hull of places on a sphere, most of it quadrilaterals that are not planar, split along their ridges."""
    rows, rng = around // 2, np.random.default_rng(1)
    rings = np.linspace(0.3, np.pi - 0.3, rows)[:, None] + np.zeros(around)
    turns = np.zeros((rows, 1)) + np.arange(around) * 2 * np.pi / around
    rings += rng.uniform(-0.05, 0.05, rings.shape) * np.pi / rows
    turns += rng.uniform(-0.05, 0.05, turns.shape) * 2 * np.pi / around
    across = np.sin(rings)
    sphere = np.stack([np.cos(rings), across * np.cos(turns), across * np.sin(turns)], axis=-1)
    points = np.concatenate([sphere.reshape(-1, 3), [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)]])
    first, last = len(points) - 2, (rows - 1) * around
    faces = [(first, i, (i + 1) % around) for i in range(around)]
    faces += [(first + 1, last + (i + 1) % around, last + i) for i in range(around)]
    for row in range(rows - 1):
        for i in range(around):
            upper, lower, after = row * around, (row + 1) * around, (i + 1) % around
            a, b, c, d = face = (upper + i, lower + i, lower + after, upper + after)
            normal = np.cross(points[b] - points[a], points[c] - points[a])
            is_ridge = normal @ (points[d] - points[a]) < 0
            faces.append(face if is_ridge else face[1:] + face[:1])
    return np.array(center) + radius * points, faces


@pytest.mark.parametrize("lobe", ["Diffuse", "Glossy"])
@pytest.mark.parametrize(("smooth", "most"), [(False, 1e-5), (True, 0.002)])
def test_a_convex_body_does_not_light_itself(smooth, most, lobe):
    """Samples' places on the diced surface lie some thousandths below the triangles of its ridges, which shone on them from
    above: .044 of the body's own radiance where it is smooth.  Tilted normals see a little of it there."""
    name = f"{lobe} Direct"
    snapshot = s.orthographic(
        (64, 64), samples=16, light_samples=16, shading_threshold=0.0, passes=[name]
    )
    glow = reflecting(snapshot, lobe, 0.5, emitted=1.0, Roughness=0.4)
    points, faces = cut_stone(28.0, (32.3, 32.1, 40.0))
    s.mesh(snapshot, points, faces, glow, smooth=np.full(len(faces), smooth, np.uint8))
    assert s.render(snapshot)["passes"][name].mean() < most
