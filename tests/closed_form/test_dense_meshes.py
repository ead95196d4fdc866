# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that have many more faces than samples: opened are the faces that samples meet, and nothing is lost."""

import numpy as np
import pytest
import session_parts
import snapshots as s

SIZE = (32, 24)
RADIUS = 6.0
CENTER = np.array([15.3, 12.2, 40.0])
SAMPLES = 16


def ball(rings=200, radius=RADIUS, center=(0.0, 0.0, 0.0)):
    """Points and faces of a sphere: 4 rings^2 of them, as flat as a ring's 2 rings corners are close."""
    polar = np.linspace(0, np.pi, rings + 1)[1:-1, None]
    around = np.arange(4 * rings) * 2 * np.pi / (4 * rings)
    x, y = np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around)
    z = np.broadcast_to(np.cos(polar), x.shape)
    points = np.stack([x, y, z], -1).reshape(-1, 3)
    points = np.concatenate([points, [[0, 0, 1], [0, 0, -1]]]) * radius + np.asarray(center)
    n = 4 * rings
    i, j = np.arange(rings - 2)[:, None] * n, np.arange(n)
    k = (j + 1) % n
    quads = np.stack([i + j, i + k, i + k + n, i + j + n], -1).reshape(-1, 4).tolist()
    top, bottom = len(points) - 2, len(points) - 1
    last = (rings - 2) * n
    quads += [(top, b, a) for a, b in zip(j.tolist(), k.tolist(), strict=True)]
    quads += [(bottom, last + a, last + b) for a, b in zip(j.tolist(), k.tolist(), strict=True)]
    return points, quads


POINTS, FACES = ball()


def far_from_outline(margin, radius=RADIUS):
    """Pixels wholly inside of the ball's disc, and wholly outside."""
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    distance = np.hypot(x - CENTER[0], y - CENTER[1])
    return distance < radius - margin, distance > radius + margin


def place(snapshot, points, faces, material, transforms, **extra):
    """Adds a mesh; twenty more of it, which no sample sees, pay for what its rays meet."""
    geometry = s.mesh(snapshot, points, faces, material, transforms=transforms, **extra)
    for number in range(20):
        s.instance(snapshot, geometry, material, transforms=[s.translation(1e6, number, 40.0)])
    return geometry


def scene(executor="SIMD", alpha=None, **options):
    snapshot = s.orthographic(
        SIZE, executor=executor, samples=SAMPLES, film_transparent=False, **options
    )
    color = s.emission(snapshot, (1, 1, 1), alpha)
    place(snapshot, POINTS, FACES, color, [s.translation(*CENTER)])
    return snapshot


def turned(x, y):
    """Rotations by these angles around x and y."""
    around_x = [[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]]
    around_y = [[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]]
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(around_x) @ around_y
    return matrix


def test_few_of_a_ball_s_faces_are_opened_and_none_is_missing(executor):
    """Before a world ten thousand times as bright a crack between two faces would be seen: without the rays beside
    those that come close to an edge, some samples on it look through one."""
    samples, away, focal = 256, 4e4, 4e4
    turn = s.translation(0, 0, away) @ turned(0.3, 0.5)
    snapshot = s.perspective(
        SIZE, focal, tuple(CENTER[:2]), executor=executor, samples=samples, film_transparent=False
    )
    place(snapshot, POINTS, FACES, s.emission(snapshot), [turn])
    s.constant_world(snapshot, 1e4)
    rendered = s.render(snapshot)
    inside, outside = far_from_outline(0.75)
    assert np.all(rendered["combined"][inside][:, :3] == 1.0)
    assert np.all(rendered["combined"][outside][:, 0] == np.float32(1e4))
    covered = np.mean((1e4 - rendered["combined"][..., 0]) / (1e4 - 1)) * SIZE[0] * SIZE[1]
    assert covered == pytest.approx(np.pi * RADIUS**2, rel=1e-3)
    counts = rendered["statistics"]
    assert 0 < counts["rays_opening"] <= (3.5 * RADIUS) ** 2 * samples
    # Of 160,000 faces half look the other way.
    assert counts["points_diced"] <= 4 * 0.55 * len(FACES)


def test_what_shows_what_lies_behind_it_has_both_its_sides(executor):
    snapshot = scene(executor, alpha=0.5)
    s.constant_world(snapshot, 16.0)
    rendered = s.render(snapshot)
    inside, _ = far_from_outline(0.75)
    assert rendered["statistics"]["rays_opening"] > 0
    expected = 0.5 + 0.5 * 0.5 + 0.25 * 16.0
    assert np.abs(rendered["combined"][inside][:, 0] - expected).max() < 1e-5


def test_two_materials_are_seen_through_where_one_is_not(executor):
    """The half towards the camera lets half of the light through, the other none."""
    snapshot = scene(executor, alpha=0.5)
    green = s.emission(snapshot, (0, 1, 0))
    middle = POINTS[[f[0] for f in FACES], 2] + POINTS[[f[2] for f in FACES], 2]
    snapshot["geometries"][0]["material_index"] = (middle > 0).astype(np.int32)
    count = len(snapshot["instances"]["slots"])
    snapshot["instances"]["slots"] = [2] * count
    snapshot["instances"]["materials"] = [0, green] * count
    s.constant_world(snapshot, 16.0)
    rendered = s.render(snapshot)
    inside, _ = far_from_outline(1.0)
    assert rendered["statistics"]["rays_opening"] > 0
    assert np.abs(rendered["combined"][inside][:, :2] - [0.5, 1.0]).max() < 1e-5


def blurred(**options):
    """It moves and turns before a lens, and a wall behind it is not of many faces."""
    snapshot = s.perspective(SIZE, 40.0, center=(0, 0), executor="SIMD", samples=SAMPLES, **options)
    snapshot["camera"].update(lens_radius=0.4, focus_distance=30.0)
    turned = np.diag([1.0, 0.8, 1.2, 1.0])
    ways = [s.translation(14, 12, 40.0) @ turned, s.translation(18, 10, 43.0)]
    place(snapshot, POINTS, FACES, s.emission(snapshot, (1, 0.5, 0)), ways)
    s.quad(snapshot, s.rectangle(-100, -100, 200, 200, 90.0), s.emission(snapshot, (0.1, 0.2, 0.3)))
    return snapshot


@pytest.mark.parametrize(
    "change", [{"bucket_size": 16}, {"bucket_size": 128}, {"threads": 1}, {"threads": 3}], ids=str
)
def test_buckets_and_threads_change_no_bit(change):
    base = s.render(blurred())
    assert base["statistics"]["rays_opening"] > 0
    assert np.array_equal(base["combined"], s.render(blurred(**change))["combined"])


@pytest.mark.parametrize("crop", [(12, 9, 13, 10), (0, 10, 32, 14)])
def test_crop_changes_no_bit(crop):
    whole = s.render(blurred())["combined"]
    part = s.render(blurred(crop=np.array(crop, np.int32)))["combined"]
    assert np.array_equal(whole[crop[1] : crop[3], crop[0] : crop[2]], part)


def test_all_numbers_of_samples_that_a_tile_may_take_are_looked_for():
    """A tile that takes all samples is what it is without a threshold; one that takes few has no holes."""
    options = {"min_samples": 1, "noise_threshold": 1e-7}
    rendered = s.render(blurred(**options))
    assert rendered["statistics"]["rays_opening"] > 0
    assert np.array_equal(rendered["combined"], s.render(blurred())["combined"])
    snapshot = scene(min_samples=1, noise_threshold=1000.0)
    s.constant_world(snapshot, 1e4)
    inside, _ = far_from_outline(0.75)
    assert np.all(s.render(snapshot)["combined"][inside][:, :3] == 1.0)


def test_executors_see_the_same():
    pictures = []
    for executor in ("REFERENCE", "SIMD", "COMPUTE"):
        snapshot = blurred()
        snapshot["options"]["executor"] = executor
        pictures.append(s.render(snapshot)["combined"])
    assert np.array_equal(pictures[0], pictures[1])
    assert np.abs(pictures[2] - pictures[1]).max() < 1e-5


def test_a_thing_of_no_thickness_and_what_cannot_be_placed_end_no_frame():
    for sizes in ((1.0, 1.0, 0.0), (1.0, 1.0, 1e-20), (0.0, 0.0, 0.0)):
        snapshot = scene()
        matrix = s.translation(*CENTER) @ np.diag([*sizes, 1.0])
        snapshot["instances"]["world_from_object"][0] = matrix
        s.constant_world(snapshot, 16.0)
        picture = s.render(snapshot)["combined"]
        assert np.all(np.isfinite(picture))
        assert np.any(picture[..., 0] == 1.0) == (sizes[0] > 0)


def holes(snapshot):
    """Pixels wholly inside of the ball's disc in which some sample sees the world behind it; the frame's statistics."""
    s.constant_world(snapshot, 1e4)
    rendered = s.render(snapshot)
    inside, _ = far_from_outline(0.75)
    return np.count_nonzero(rendered["combined"][inside][:, 0] != 1.0), rendered["statistics"]


def seen_from_afar(center=CENTER[:2], samples=256, **options):
    """By a camera whose single precision is a fiftieth of a face, which those of meshes' points need not be."""
    options = {"executor": "SIMD", "film_transparent": False, "samples": samples, **options}
    return s.perspective(SIZE, 4e4, tuple(center), **options)


@pytest.mark.parametrize("aside", [1e3, 1e4])
def test_what_lies_far_beside_the_camera_s_axis_has_no_holes(aside):
    """There the points that samples meet are rounded by more than in the mesh's own space."""
    snapshot = seen_from_afar(CENTER[:2] - [aside, 0.0], clip=(0.1, 1e6))
    where = s.translation(aside, 0, 4e4) @ turned(0.3, 0.5)
    place(snapshot, POINTS, FACES, s.emission(snapshot), [where])
    assert holes(snapshot)[0] == 0


@pytest.mark.parametrize("away", [1e3, 1e4, 1e6])
def test_what_lies_far_from_its_own_origin_has_no_holes(away):
    snapshot = seen_from_afar()
    where = s.translation(-away, 0, 4e4)
    place(snapshot, POINTS + [away, 0, 0], FACES, s.emission(snapshot), [where])
    assert holes(snapshot)[0] == 0


def test_what_turns_by_its_knots_has_no_holes():
    """Half a turn around the camera's axis: edges are elsewhere at each time."""
    snapshot = seen_from_afar(frame_time=0.5)
    tilted = POINTS @ turned(0.3, 0.5)[:3, :3].T
    angles = np.linspace(0, np.pi, 9)
    knots = []
    for c, sin in zip(np.cos(angles), np.sin(angles), strict=True):
        knots.append(tilted @ np.array([[c, sin, 0], [-sin, c, 0], [0, 0, 1]]))
    place(snapshot, np.array(knots), FACES, s.emission(snapshot), [s.translation(0, 0, 4e4)])
    missing, counts = holes(snapshot)
    assert counts["rays_opening"] > 0
    assert missing == 0


def test_faces_that_lie_on_each_other_are_those_of_the_first():
    """A part that was duplicated and joined: whichever a ray ends at, the picture is the one of all faces."""
    snapshot = scene()
    green = s.emission(snapshot, (0, 1, 0))
    mesh = snapshot["geometries"][0]
    count, vertices = len(FACES), len(POINTS)
    mesh["points"] = np.concatenate([mesh["points"]] * 2, axis=1)
    mesh["corner_verts"] = np.concatenate([mesh["corner_verts"], mesh["corner_verts"] + vertices])
    mesh["face_sizes"] = np.concatenate([mesh["face_sizes"]] * 2)
    mesh["material_index"] = np.repeat(np.array([0, 1], np.int32), count)
    instances = len(snapshot["instances"]["slots"])
    snapshot["instances"]["slots"] = [2] * instances
    snapshot["instances"]["materials"] = [0, green] * instances
    rendered = s.render(snapshot)
    assert rendered["statistics"]["rays_opening"] > 0
    inside, _ = far_from_outline(0.75)
    assert np.all(rendered["combined"][inside][:, :3] == 1.0)


def test_rays_are_asked_only_where_that_spares_more_than_it_costs():
    """One mesh alone would wait for its rays' tree; where a sun's shadows need that, it is there."""
    alone = s.orthographic(SIZE, executor="SIMD", samples=SAMPLES)
    s.mesh(alone, POINTS, FACES, s.emission(alone), transforms=[s.translation(*CENTER)])
    assert s.render(alone)["statistics"]["rays_opening"] == 0
    lit = s.orthographic(SIZE, executor="SIMD", samples=SAMPLES)
    matte = session_parts.matte(lit, (0.8, 0.8, 0.8))
    s.mesh(lit, POINTS, FACES, matte, transforms=[s.translation(*CENTER)])
    session_parts.sun(lit)
    counts = s.render(lit)["statistics"]
    assert counts["rays_opening"] > 0
    assert counts["points_diced"] <= 4 * 0.55 * len(FACES)


def test_what_is_deep_and_lets_light_through_is_opened_as_a_whole():
    """A ray through five hundred sheets costs more than their faces."""
    snapshot = s.orthographic(SIZE, executor="SIMD", samples=SAMPLES)
    half = s.emission(snapshot, alpha=0.5)
    z = np.linspace(0, 1, 500)
    corners = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], float)
    tiles = [
        np.column_stack([corners / 8 + [i / 2, j / 2], np.full(4, depth)])
        for depth in z
        for i in range(8)
        for j in range(8)
    ]
    points = np.concatenate(tiles)
    faces = np.arange(len(points)).reshape(-1, 4).tolist()
    place(snapshot, points, faces, half, [s.translation(8, 8, 40.0)])
    assert s.render(snapshot)["statistics"]["rays_opening"] == 0


def test_later_pictures_of_a_session_are_those_of_frames_alone():
    """With other samples and from elsewhere other faces are met; with another colour none is looked for."""
    kept = session_parts.Kept()
    snapshot = blurred()
    assert kept.follow(snapshot)["statistics"]["rays_opening"] > 0
    snapshot["options"]["samples"] = 4
    kept.follow(snapshot)
    # Another place in the shutter cuts the mesh into triangles anew.
    snapshot["options"]["frame_time"] = 0.0
    kept.follow(snapshot)
    snapshot["camera"]["world_from_camera"] = s.translation(0.2)[None]
    kept.follow(snapshot)
    snapshot["materials"][0]["nodes"][0]["inputs"]["Color"] = (0, 0, 1, 1)
    kept.follow(snapshot)
    assert kept.statistics["rays_opening"] == 0


def shaded(nodes, surface, **options):
    """A ball with a material of these nodes, seen by few samples; light's rays have built its tree."""
    snapshot = s.orthographic(SIZE, executor="SIMD", film_transparent=False, **options)
    material = {"name": "Ball", "nodes": nodes, "surface": surface}
    snapshot["materials"].append(material)
    points, faces = ball(100)
    where = s.translation(*CENTER) @ turned(0.3, 0.5)
    smooth = {"smooth": np.ones(len(faces), np.uint8)}
    s.mesh(snapshot, points, faces, 0, transforms=[where], **smooth)
    return snapshot


def test_points_lie_on_the_surface_whose_faces_are_not_opened():
    """Nothing occludes a convex ball; a mean of faces that are far apart lies inside of it."""
    occlusion = {"Color": (1, 1, 1, 1), "Distance": 3.0}
    glow = {"Color": ("LINK", 0, "Color"), "Strength": 1.0}
    nodes = [
        {"type": "ShaderNodeAmbientOcclusion", "inputs": occlusion},
        {"type": "ShaderNodeEmission", "inputs": glow},
    ]
    rendered = s.render(shaded(nodes, (1, "Emission"), samples=4))
    assert rendered["statistics"]["rays_opening"] > 0
    inside, _ = far_from_outline(0.75)
    assert rendered["combined"][inside][:, 0].mean() == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("samples", [1, 4])
def test_a_coarse_picture_is_as_bright_as_the_ball(samples):
    """Lambert's law, of a sun behind the camera, where samples are not shaded by themselves (a view's first pictures)."""
    diffuse = {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.8, 0.8, 1)}}
    snapshot = shaded([diffuse], (0, "BSDF"), samples=samples, refine_samples=False)
    session_parts.sun(snapshot)
    rendered = s.render(snapshot)
    assert rendered["statistics"]["rays_opening"] > 0
    inside, _ = far_from_outline(0.75)
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    squared = ((x - CENTER[0]) ** 2 + (y - CENTER[1]) ** 2)[inside] / RADIUS**2
    expected = 0.8 / np.pi * 3.0 * np.sqrt(1 - squared)
    # One sample a pixel lies elsewhere than in its middle.
    assert rendered["combined"][inside][:, 0].mean() == pytest.approx(expected.mean(), rel=0.02)


def test_a_pattern_is_the_same_with_a_threshold_at_which_all_samples_are_taken():
    """Which faces a threshold's fewer samples meet must not move the points of those that all of them meet."""
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeTexChecker", "inputs": {"Vector": ("LINK", 0, "Object"), "Scale": 0.7}},
        {"type": "ShaderNodeEmission", "inputs": {"Color": ("LINK", 1, "Color"), "Strength": 1.0}},
    ]
    pictures = [
        s.render(shaded(nodes, (2, "Emission"), samples=SAMPLES, **options))["combined"]
        for options in ({}, {"min_samples": 1, "noise_threshold": 1e-7})
    ]
    assert np.array_equal(*pictures)
