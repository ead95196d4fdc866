# SPDX-License-Identifier: GPL-3.0-or-later
"""Light on what stands still before a lens that zooms: half way between two knots."""

import numpy as np
import pytest
import snapshots as s
from test_elements import curves

SIZE = (64, 32)


def floor_light(ends):
    """Light and alpha of a floor two metres below the eye, 400 m long, under a sun; the camera goes from one matrix to the
    other."""
    snapshot = s.perspective(SIZE, 60.0, executor="SIMD", samples=4, light_samples=4)
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.8, 0.8, 1)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    floor = [(-200, 2, -50), (200, 2, -50), (200, 2, 400), (-200, 2, 400)]  # y goes down
    s.quad(snapshot, floor, 0)
    down = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
    sun = {"name": "Sun", "kind": "SUN", "world_from_light": down[None], "energy": 3.0}
    snapshot["lights"] = [sun]
    snapshot["camera"]["world_from_camera"] = np.array(ends)
    snapshot["options"]["frame_time"] = 0.5
    picture = s.render(snapshot)["combined"][20:]
    return picture[..., 0], picture[..., 3]


def zoomed(by):
    return np.diag([1 / by, 1 / by, 1.0, 1.0])


def rolled(angle):
    c, t = np.cos(angle), np.sin(angle)
    return np.array([[c, -t, 0, 0], [t, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


@pytest.mark.parametrize(
    "ends",
    [(zoomed(0.95), zoomed(1.05)), (zoomed(1.2), zoomed(0.8)), (rolled(-0.02), rolled(0.02))],
    ids=["zoom", "long zoom", "roll"],
)
def test_a_floor_does_not_hide_itself(ends):
    """Places seen there are where they are, not a five-thousandth farther away and below it: 3 W / m2 * .8 / pi."""
    light, alpha = floor_light(ends)
    assert alpha.min() == 1.0
    assert np.abs(light - 3.0 * 0.8 / np.pi).max() < 1e-3


def ribbon_width(world_from_camera, world_from_object=None):
    """Pixels that a curve of 20 cm takes across the picture, 10 m before an eye of 60 mm."""
    snapshot = s.perspective(SIZE, 60.0, executor="SIMD", samples=256)
    s.emission(snapshot)
    points = [(0.3, -8, 10), (0.3, -3, 10), (0.3, 3, 10), (0.3, 8, 10)]
    curves(snapshot, points, [4], 0.1, 0, world_from_object)
    snapshot["camera"]["world_from_camera"] = np.array(world_from_camera)
    snapshot["options"]["frame_time"] = 0.5
    return s.alpha(snapshot)[8:24].sum(1).mean()


MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])  # as Blender's cameras, whose y goes up


@pytest.mark.parametrize("mirror", [np.eye(4), MIRROR], ids=["right-handed", "left-handed"])
def test_hair_does_not_turn_over_where_its_scale_is_even(mirror):
    """At the frame a zoom scales evenly, at the knots beside it does not: ribbons went over to their other side
    between, and lost half of their width."""
    still = 60.0 * 0.2 / 10.0
    ends = [mirror @ zoomed(by) for by in (0.9, 1.0, 1.1)]
    assert ribbon_width(ends) == pytest.approx(still, rel=0.01)
    bends = [mirror @ np.diag([by, 1.0, 1.0, 1.0]) for by in (0.9, 1.0, 1.1)]
    moved = ribbon_width([np.eye(4)], bends)
    assert moved == pytest.approx(still, rel=0.01)
