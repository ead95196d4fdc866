# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of the benches that need no Blender, as snapshots (docs/scene_snapshot.md); units are pixels."""

import math
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "closed_form"))
import snapshots as s  # noqa: E402

WIDTH, HEIGHT = 320, 180
DEFAULT_FILTER = {"pixel_filter": "BLACKMAN_HARRIS", "filter_width": 1.5, "threads": 1}


def frame(size=(WIDTH, HEIGHT), **options):
    return s.orthographic(size, **{**DEFAULT_FILTER, **options})


def shift(pixels):
    """Knots of a translation to the right, centred; one knot where nothing moves."""
    return [s.translation(-pixels / 2), s.translation(pixels / 2)] if pixels else None


def unit_sphere(segments=64, rings=32):
    """(points, faces) of a UV sphere, as Blender makes it."""
    theta = np.pi * np.arange(1, rings) / rings
    phi = 2 * np.pi * np.arange(segments) / segments
    ring = np.stack(
        [
            np.outer(np.sin(theta), np.cos(phi)),
            np.outer(np.sin(theta), np.sin(phi)),
            np.outer(np.cos(theta), np.ones(segments)),
        ],
        -1,
    ).reshape(-1, 3)
    points = np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]])
    top, bottom = len(ring), len(ring) + 1
    faces = []
    for i in range(segments):
        j = (i + 1) % segments
        faces.append((top, i, j))
        for r in range(rings - 2):
            a, b = r * segments, (r + 1) * segments
            faces.append((a + i, b + i, b + j, a + j))
        faces.append((bottom, (rings - 2) * segments + j, (rings - 2) * segments + i))
    return points, faces


def spheres(pixels=0.0, **options):
    """60 spheres of 6 to 22 pixels' radius that move to the right by `pixels`."""
    snapshot = frame(**options)
    random = np.random.default_rng(5)
    colors = [s.emission(snapshot, random.uniform(0.05, 1, 3)) for _ in range(6)]
    points, faces = unit_sphere()
    for i in range(60):
        place = random.uniform((20, 10, 100), (300, 170, 300))
        radius = random.uniform(6, 22)
        s.mesh(snapshot, points * radius + place, faces, colors[i % 6], transforms=shift(pixels))
    return snapshot


def turn(center, angle):
    """Knots of a turn by `angle` radians about a point, in chords of a tenth of a radian."""
    if angle == 0:
        return None
    knots = []
    for a in np.linspace(-angle / 2, angle / 2, int(abs(angle) * 10) + 2):
        m = s.translation(*center)
        m[:2, :2] = [[math.cos(a), -math.sin(a)], [math.sin(a), math.cos(a)]]
        knots.append(m)
    return knots


def feathers(angle=0.0, alpha=0.4, **options):
    """400 half-transparent strips of 80 by 16 pixels in ten bunches that turn by `angle`, each about its middle."""
    snapshot = frame(**options)
    random = np.random.default_rng(7)
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, 3), np.linspace(-0.5, 0.5, 13))
    cells = (np.arange(12)[:, None] * 3 + np.arange(2)).reshape(-1, 1) + [0, 1, 4, 3]
    for i in range(10):
        middle = random.uniform((60, 50, 200), (260, 130, 300))
        points, faces = [], []
        for _ in range(40):
            a, bend = random.uniform(0, 2 * math.pi), random.uniform(4, 20)
            place = random.uniform((-50, -40, -20), (50, 40, 20))
            faces += (cells + len(points) * u.size).tolist()
            x = 16 * u * math.cos(a) - 80 * v * math.sin(a) + place[0]
            y = 16 * u * math.sin(a) + 80 * v * math.cos(a) + place[1]
            z = bend * np.cos(math.pi * v) + place[2]
            points.append(np.stack([x, y, z], -1).reshape(-1, 3))
        still = middle if angle == 0 else (0, 0, 0)
        s.mesh(
            snapshot,
            np.concatenate(points) + still,
            faces,
            s.emission(snapshot, random.uniform(0.1, 1, 3), alpha),
            transforms=turn(middle, angle * (-1) ** i),
        )
    return snapshot


def sheet(pixels, size=(WIDTH, HEIGHT), margin=(56, 10), **options):
    """An opaque sheet of one-pixel micropolygons however fast it moves, by `pixels`; wholly on screen."""
    snapshot = frame(size, **{"dicing_rate": 1.0, "motion_factor": 0.0, **options})
    corners = s.rectangle(*margin, size[0] - margin[0], size[1] - margin[1])
    s.quad(snapshot, corners, s.emission(snapshot, (0.2, 0.5, 0.4)), transforms=shift(pixels))
    return snapshot


def tiles(side, whole, **options):
    """A square of side * side micropolygons: one face, or as many faces of one pixel that share nothing."""
    size = (side, side)
    snapshot = s.orthographic(size, **{**DEFAULT_FILTER, "dicing_rate": 1.0, **options})
    material = s.emission(snapshot, (0.8, 0.5, 0.3))
    if whole:
        s.quad(snapshot, s.rectangle(0, 0, side, side), material)
        return snapshot
    y, x = np.divmod(np.arange(side * side), side)
    corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    points = np.ones((side * side, 4, 3), np.float32)
    points[..., :2] = np.stack([x, y], -1)[:, None] + corner
    s.mesh(snapshot, points.reshape(-1, 3), np.arange(4 * side * side).reshape(-1, 4), material)
    return snapshot


def enlarged(snapshot, factor):
    """The same picture on `factor` times as many pixels a side."""
    for side in ("width", "height"):
        snapshot["options"][side] *= factor
    for place in ("scale", "center"):
        camera = snapshot["camera"]
        camera[place] = tuple(factor * x for x in camera[place])
    return snapshot
