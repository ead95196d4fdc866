# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals of what bends while the shutter is open: a tent whose ridge rises, lit by the mean of its cosines.

Its points move along the view alone, so that a column sees one place of it.
"""

import numpy as np
import pytest
import snapshots as s

EXECUTORS = ["SIMD", "COMPUTE", "REFERENCE"]
SIZE, RIDGE, HALF, STEEP = (48, 16), 24.0, 20.0, 0.5
ALBEDO, SUN = 0.8, 3.0
EVERYWHERE, NO_SHADOW = 123, 121
FACES = [(0, 1, 4, 3), (1, 2, 5, 4)]
TIMES = (np.arange(256) + 0.5) / 256


def stage(executor="SIMD", behind=False, **options):
    """A sun that shines along the view, or against it, and 45 degrees to the right."""
    snapshot = s.orthographic(SIZE, executor=executor, **{"samples": 256, **options})
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (ALBEDO,) * 3 + (1,)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    way = -1.0 if behind else 1.0
    c = np.sqrt(0.5)
    shines = np.eye(4)
    shines[:3, :3] = [[-way * c, 0, -c], [0, 1, 0], [c, 0, -way * c]]
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": shines[None], "energy": SUN}
    ]
    snapshot["instances"]["flags"] = []
    return snapshot


def tent(slope, foot=20.0, way=1.0):
    """[6, 3]: two squares that lean by `slope` from the ridge on."""
    columns = [
        (x, foot + way * slope * abs(x - RIDGE)) for x in (RIDGE - HALF, RIDGE, RIDGE + HALF)
    ]
    return np.array([(x, y, z) for y in (-50.0, 70.0) for x, z in columns])


def leaning(slope):
    """Unit normals of the tent's two sides, (x, towards the sun's side of the view)."""
    return np.array([(-slope, 1.0), (slope, 1.0)]) / np.hypot(slope, 1.0)


def bend(snapshot, knots, foot=20.0, way=1.0, place=None, **extra):
    """`place`: of the instance; points are where it is undone."""
    points = np.array([tent(slope, foot, way) for slope in np.linspace(0.0, STEEP, knots)])
    if place is not None:
        undone = np.linalg.inv(place)
        points = points @ undone[:3, :3].T + undone[:3, 3]
        extra["transforms"] = [s.translation(0, y) @ place for y in (-5.0, 5.0)]
    s.mesh(snapshot, points, FACES, 0, **extra)
    snapshot["instances"]["flags"].append(EVERYWHERE)


def smooth_cosines(width=HALF):
    """[columns], the mean over the shutter, where the faces along the ridge are as wide."""
    x = np.arange(SIZE[0]) + 0.5
    mix = np.minimum(np.abs(x - RIDGE) / width, 1.0)
    cosines = []
    for slope in STEEP * TIMES:
        side = leaning(slope)[(x > RIDGE).astype(int)]
        normal = mix[:, None] * side + (1.0 - mix)[:, None] * [0.0, 1.0]
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        cosines.append((normal[:, 1] - normal[:, 0]) * np.sqrt(0.5))
    return np.mean(cosines, axis=0)


def flat_cosines():
    """Of both sides."""
    normals = np.array([leaning(slope) for slope in STEEP * TIMES])
    return ((normals[..., 1] - normals[..., 0]) * np.sqrt(0.5)).mean(axis=0)


def row(snapshot):
    return s.render(snapshot)["combined"][2:-2, :, 0].mean(axis=0) / (ALBEDO * SUN / np.pi)


def corner_normals(slope, smooth=True):
    """Of the tent at one moment, of its sides that are turned from the eye: out of its faces."""
    sides = leaning(slope)
    of_vertex = [sides[0], np.array([0.0, 1.0]), sides[1]] * 2
    normals = [of_vertex[v] if smooth else sides[i] for i, f in enumerate(FACES) for v in f]
    return np.array([(-x, 0.0, z) for x, z in normals], np.float32)


INSIDE = slice(6, 42)
# With two knots normals go straight where the slope does; 33 leave nothing of that.
KNOTS = [(33, 0.004), (2, 0.011)]


@pytest.mark.parametrize("frame_time", [0.0, 0.3, 0.5, 1.0])
@pytest.mark.parametrize("knots, error", KNOTS)
def test_a_smooth_bend_has_the_normals_of_its_moments(knots, error, frame_time):
    snapshot = stage(frame_time=frame_time)
    bend(snapshot, knots, smooth=np.ones(2, np.uint8))
    assert row(snapshot)[INSIDE] == pytest.approx(smooth_cosines()[INSIDE], abs=error)


@pytest.mark.parametrize("executor", EXECUTORS)
def test_so_has_each_executor(executor):
    snapshot = stage(executor)
    bend(snapshot, 33, smooth=np.ones(2, np.uint8))
    assert row(snapshot)[INSIDE] == pytest.approx(smooth_cosines()[INSIDE], abs=0.004)


@pytest.mark.parametrize("scale", [(1, 1, 4), (3, 1, 0.5), (-1, 1, 1)], ids=str)
@pytest.mark.parametrize("given", [False, True], ids=["smooth", "corner normals"])
def test_so_has_what_is_scaled_and_moves(given, scale):
    snapshot = stage(frame_time=1.0)
    place = s.translation(RIDGE, 3.0, 20.0) @ np.diag([*scale, 1.0])
    extra = {"smooth": np.ones(2, np.uint8)}
    if given:
        # Out of faces, which the points of a mirrored object go around the other way.
        of_object = corner_normals(STEEP) @ place[:3, :3] * np.sign(np.prod(scale))
        of_object /= np.linalg.norm(of_object, axis=1)[:, None]
        extra = {"corner_normals": of_object.astype(np.float32)}
    bend(snapshot, 33, place=place, **extra)
    assert row(snapshot)[INSIDE] == pytest.approx(smooth_cosines()[INSIDE], abs=0.004)


@pytest.mark.parametrize("width", [4.0, 2.5, 0.5])
def test_so_has_what_is_of_small_faces(width):
    """All but those along the ridge are plane: batches of faces, and faces below a pixel."""
    snapshot = stage()
    n = round(2 * HALF / width)
    x = np.linspace(RIDGE - HALF, RIDGE + HALF, n + 1)
    y = np.arange(-2.0, 18.1, width)
    points = [
        [(a, b, 20.0 + slope * abs(a - RIDGE)) for b in y for a in x]
        for slope in np.linspace(0.0, STEEP, 33)
    ]
    i = np.arange(len(x) * len(y)).reshape(len(y), len(x))
    faces = np.stack([i[:-1, :-1], i[:-1, 1:], i[1:, 1:], i[1:, :-1]], axis=-1).reshape(-1, 4)
    s.mesh(snapshot, np.array(points), faces.tolist(), 0, smooth=np.ones(len(faces), np.uint8))
    snapshot["instances"]["flags"].append(EVERYWHERE)
    left, right = flat_cosines()
    found = row(snapshot)
    assert found[6:19] == pytest.approx(left, abs=0.004)
    assert found[29:42] == pytest.approx(right, abs=0.004)
    if width > 1.0:
        assert found[22:26] == pytest.approx(smooth_cosines(width)[22:26], abs=0.012)


@pytest.mark.parametrize("frame_time", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("knots, error", KNOTS)
def test_normals_that_corners_share_stay_shared(knots, error, frame_time):
    """A tent that the frame shows smooth is smooth when its ridge is sharper."""
    snapshot = stage(frame_time=frame_time)
    bend(snapshot, knots, corner_normals=corner_normals(STEEP * frame_time))
    assert row(snapshot)[INSIDE] == pytest.approx(smooth_cosines()[INSIDE], abs=error)


def test_a_sharp_edge_stays_sharp():
    snapshot = stage(frame_time=1.0)
    bend(snapshot, 33, corner_normals=corner_normals(STEEP, smooth=False))
    left, right = flat_cosines()
    found = row(snapshot)
    assert found[6:22] == pytest.approx(left, abs=0.004)
    assert found[26:42] == pytest.approx(right, abs=0.004)


def in_mirror(**options):
    """What stands behind the eye, in a mirror that fills the view."""
    limits = {"bounces": 1, "glossy_bounces": 1, "clamp_indirect": 0.0, "filter_glossy": 0.0}
    snapshot = stage(behind=True, **limits, **options)
    nodes = [{"type": "ShaderNodeBsdfGlossy", "inputs": {"Color": (1.0,) * 4, "Roughness": 0.0}}]
    snapshot["materials"].append({"name": "Mirror", "nodes": nodes, "surface": (0, "BSDF")})
    s.quad(snapshot, s.rectangle(-200, -200, 250, 200, 20.0), 1)
    snapshot["instances"]["flags"].append(NO_SHADOW)
    return snapshot


@pytest.mark.parametrize("frame_time", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(
    "extra", [{}, {"subdivision": {"scheme": "CATMULL_CLARK"}}], ids=["flat", "subdivided"]
)
def test_a_mirror_shows_sides_as_they_lean(extra, frame_time):
    snapshot = in_mirror(frame_time=frame_time)
    for face in FACES:
        points = [tent(slope, -20.0, -1.0)[list(face)] for slope in np.linspace(0.0, STEEP, 33)]
        s.quad(snapshot, np.array(points), 0, **extra)
        snapshot["instances"]["flags"].append(EVERYWHERE)
    left, right = flat_cosines()
    found = row(snapshot)
    assert found[12:20] == pytest.approx(left, abs=0.004)
    assert found[28:36] == pytest.approx(right, abs=0.004)


@pytest.mark.parametrize("frame_time", [0.0, 0.5, 1.0])
def test_a_mirror_shows_a_smooth_bend(frame_time):
    snapshot = in_mirror(frame_time=frame_time)
    bend(snapshot, 33, -20.0, -1.0, smooth=np.ones(2, np.uint8))
    assert row(snapshot)[INSIDE] == pytest.approx(smooth_cosines()[INSIDE], abs=0.004)
