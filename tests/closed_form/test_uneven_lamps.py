# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose emission varies light what is around them without a bounce: by place, view, side, picture and motion."""

import re

import numpy as np
import pytest
import snapshots as s
from test_bounces import mirror
from test_refined_shading import ALBEDO, EXECUTORS
from test_shining_meshes import (
    CAMERA,
    FLOOR,
    HIDDEN_LAMP,
    LAMP,
    SHADOWS,
    SIZE,
    form_factor,
    pixels,
    seen,
    stage,
)

GEOMETRY = {"type": "ShaderNodeNewGeometry", "inputs": {}}


def above(link, limit):
    """1 where a component of a vector is above a limit: two nodes, which follow the one that `link` names."""
    node, output, axis = link
    return [
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", node, output)}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", node + 1, axis), "Value_001": float(limit)},
            "properties": {"operation": "GREATER_THAN"},
        },
    ]


def uneven(snapshot, nodes, output, color=(1.0, 1.0, 1.0, 1.0)):
    """Adds a material that emits what the last of `nodes` says; returns its index."""
    strength = ("LINK", len(nodes) - 1, output)
    emission = {"type": "ShaderNodeEmission", "inputs": {"Color": color, "Strength": strength}}
    made = {
        "name": "Uneven",
        "nodes": [*nodes, emission],
        "surface": (len(nodes), "Emission"),
    }
    snapshot["materials"].append(made)
    return len(snapshot["materials"]) - 1


def shining(snapshot, points, material, faces=((0, 1, 2, 3),), **more):
    s.mesh(snapshot, points, list(faces), material, **more)
    snapshot["instances"]["flags"].append(HIDDEN_LAMP)


def right_half(snapshot):
    return uneven(snapshot, [GEOMETRY, *above((0, "Position", "X"), 16.0)], "Value")


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("bounces", [0, 2])
def test_half_of_a_square_lights_by_its_form_factor(executor, bounces):
    """Nothing is brought twice where ways meet it as well."""
    snapshot = stage(executor, bounces=bounces, diffuse_bounces=4, light_samples=256)
    shining(snapshot, s.rectangle(10, 12, 22, 18, LAMP), right_half(snapshot))
    rendered = s.render(snapshot)
    truth = ALBEDO * form_factor(16, 12, 22, 18, FLOOR - LAMP, *pixels())
    image = rendered["combined"][..., 0]
    assert rendered["warnings"] == []
    assert image == pytest.approx(truth, abs=0.008)
    assert image.mean() == pytest.approx(truth.mean(), rel=0.004)


def test_so_many_faces_that_every_other_is_asked():
    """1,065,800 triangles, of which half are dark: no more is left out than is named."""
    n = 730
    snapshot = stage(light_samples=64)
    j, i = np.mgrid[: n + 1, : n + 1] / n
    points = np.stack([10 + 12 * i, 12 + 6 * j, np.full_like(i, LAMP)], axis=-1).reshape(-1, 3)
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    corners = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=-1)
    if np.cross(*np.diff(s.rectangle(10, 12, 22, 18, LAMP)[:3], axis=0))[2] < 0:
        corners = corners[:, ::-1]
    shining(snapshot, points, right_half(snapshot), corners.tolist())
    truth = ALBEDO * form_factor(16, 12, 22, 18, FLOOR - LAMP, *pixels())
    rendered = s.render(snapshot)
    (warning,) = rendered["warnings"]
    lost = float(re.search(r"(\d+) %", str(warning))[1]) / 100
    assert 0.1 < lost < 0.6
    assert 0.97 * (1 - lost) < rendered["combined"][..., 0].mean() / truth.mean() < 1.01


def test_by_the_view():
    nodes = [{"type": "ShaderNodeLayerWeight", "inputs": {"Blend": 0.5}}]
    snapshot = stage(light_samples=256)
    shining(snapshot, s.rectangle(10, 12, 22, 18, LAMP), uneven(snapshot, nodes, "Facing"))
    x, y = pixels()
    truth = np.zeros(SIZE[::-1])
    for px in 10.25 + 0.5 * np.arange(24):
        for py in 12.25 + 0.5 * np.arange(12):
            cosine = (FLOOR - LAMP) / np.sqrt((x - px) ** 2 + (y - py) ** 2 + (FLOOR - LAMP) ** 2)
            truth += (1 - cosine) * 0.25 * cosine**4 / (FLOOR - LAMP) ** 2
    truth *= ALBEDO / np.pi
    assert seen(snapshot).mean() == pytest.approx(truth.mean(), rel=0.004)
    assert seen(snapshot) == pytest.approx(truth, abs=0.004)


@pytest.mark.parametrize("turned", [False, True])
def test_by_the_side(turned):
    """What shines behind alone lights the floor that it turns its back to."""
    snapshot = stage()
    corners = s.rectangle(10, 12, 22, 18, LAMP)  # its normal looks along z, to the floor
    material = uneven(snapshot, [GEOMETRY], "Backfacing")
    shining(snapshot, corners[::-1] if turned else corners, material)
    truth = ALBEDO * form_factor(10, 12, 22, 18, FLOOR - LAMP, *pixels())
    assert seen(snapshot) == pytest.approx(truth if turned else 0 * truth, abs=0.004)


def wall(snapshot, picture, z=LAMP):
    """A wall over all the view of as many faces as `picture` [rows, columns] has values: each shines as its own says."""
    rows, columns = picture.shape
    x, y = np.meshgrid(np.linspace(0, 32, columns + 1), np.linspace(0, 32, rows + 1))
    points = np.stack([x, y, np.full_like(x, z)], axis=-1).reshape(-1, 3)
    a = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    faces = np.stack([a, a + 1, a + columns + 2, a + columns + 1], axis=1)
    values = picture.astype(np.float32).reshape(-1, 1)
    nodes = [
        {"type": "ShaderNodeAttribute", "inputs": {}, "properties": {"attribute_name": "Glow"}}
    ]
    glow = {"name": "Glow", "domain": "FACE", "kind": "GENERIC", "values": values}
    shining(
        snapshot,
        points,
        uneven(snapshot, nodes, "Fac"),
        [tuple(face) for face in faces],
        attributes=[glow],
    )


def lit_by(picture, z=LAMP):
    rows, columns = picture.shape
    x, y = pixels()
    truth = np.zeros(SIZE[::-1])
    for row, column in np.argwhere(picture):
        x0, y0 = 32 * column / columns, 32 * row / rows
        truth += picture[row, column] * form_factor(
            x0, y0, x0 + 32 / columns, y0 + 32 / rows, FLOOR - z, x, y
        )
    return ALBEDO * truth


def picture(seed, bright=1024, side=32):
    """Values of `bright` faces of a square, the others dark."""
    rng = np.random.default_rng(seed)
    values = np.zeros(side * side)
    values[rng.permutation(values.size)[:bright]] = rng.uniform(0.1, 3.0, bright)
    return values.reshape(side, side)


@pytest.mark.parametrize("bright", [20, 1024])
def test_a_wall_of_a_thousand_faces(bright):
    """Faces are asked by what they send: a few that are not dark are as quiet as all."""
    values = picture(5, bright)
    snapshot = stage(light_samples=16 if bright < 100 else 64)
    wall(snapshot, values)
    truth = lit_by(values)
    assert seen(snapshot).mean() == pytest.approx(truth.mean(), rel=0.004)
    # .0015 and .0038 were seen.
    assert np.sqrt(np.mean((seen(snapshot) / truth - 1) ** 2)) < 0.008


def test_dark_faces_are_no_lamps():
    """None is asked: light of two others is that of two faces, each asked as often as there are light samples."""
    alone, among = stage(light_samples=16), stage(light_samples=16)
    values = np.zeros((16, 16))
    values[4, 5] = values[11, 9] = 50.0
    wall(among, values)
    for x, y in ((10, 8), (18, 22)):
        shining(alone, s.rectangle(x, y, x + 2, y + 2, LAMP), s.emission(alone, (50.0,) * 3))
    rays = [s.render(one)["statistics"]["rays_shadow"] for one in (alone, among)]
    assert rays[0] == rays[1]


def test_a_picture_by_its_texels():
    """An image over a square, sharp between texels: each a square of its own."""
    texels = np.random.default_rng(2).uniform(0.0, 2.0, (4, 4)).astype(np.float32)
    pixels_ = np.ones((4, 4, 4), np.float32)
    pixels_[..., :3] = texels[..., None]
    snapshot = stage(light_samples=256)
    image = {"name": "I", "path": "", "colorspace": "scene_linear", "alpha_mode": "STRAIGHT"}
    snapshot["images"] = [image | {"pixels": pixels_}]
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {
            "type": "ShaderNodeTexImage",
            "inputs": {"Vector": ("LINK", 0, "Generated")},
            "properties": {"image": "I", "interpolation": "Closest"},
        },
    ]
    shining(snapshot, s.rectangle(8, 8, 24, 24, LAMP), uneven(snapshot, nodes, "Color"))
    x, y = pixels()
    truth = np.zeros(SIZE[::-1])
    for row in range(4):
        for column in range(4):
            place = 8 + 4 * column, 8 + 4 * row, 12 + 4 * column, 12 + 4 * row
            truth += texels[row, column] * form_factor(*place, FLOOR - LAMP, x, y)
    assert seen(snapshot) == pytest.approx(ALBEDO * truth, abs=0.008)
    assert seen(snapshot).mean() == pytest.approx(ALBEDO * truth.mean(), rel=0.004)


@pytest.mark.parametrize("how", ["transforms", "points"])
def test_what_moves_takes_its_picture_along(how):
    """Half of a square that goes from the left to the right, by Generated coordinates."""
    snapshot = stage(light_samples=256)
    nodes = [{"type": "ShaderNodeTexCoord", "inputs": {}}, *above((0, "Generated", "X"), 0.5)]
    material = uneven(snapshot, nodes, "Value", (4.0, 4.0, 4.0, 1.0))
    corners = np.array(s.rectangle(-2, 12, 4, 18, LAMP))
    ways = np.array([[0, 0, 0], [15, 0, 0], [30, 0, 0]], float)
    generated = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float32)
    if how == "transforms":
        moves = {"transforms": [s.translation(*way) for way in ways]}
    else:
        corners, moves = corners[None] + ways[:, None], {}
    shining(snapshot, corners, material, generated=generated, **moves)
    times = (np.arange(200) + 0.5) / 200 * 30
    each = [form_factor(1 + t, 12, 4 + t, 18, FLOOR - LAMP, *pixels()) for t in times]
    truth = 4 * ALBEDO * np.mean(each, axis=0)
    assert seen(snapshot) == pytest.approx(truth, abs=0.012)
    assert seen(snapshot).mean() == pytest.approx(truth.mean(), rel=0.006)


def test_a_mirror_shows_its_half():
    snapshot = s.orthographic(SIZE, samples=16, bounces=0)
    s.quad(snapshot, s.rectangle(-8, -8, 40, 40, FLOOR), mirror(snapshot, 0.5))
    snapshot["instances"]["flags"] = [CAMERA | SHADOWS]
    shining(snapshot, s.rectangle(8, 8, 24, 24, LAMP), right_half(snapshot))
    image = seen(snapshot)
    assert image[10:22, 18:22] == pytest.approx(0.5, abs=1e-5)
    assert image[10:22, :14].max() == 0.0


def test_bits_do_not_depend_on_buckets_and_threads():
    def rendered(**options):
        snapshot = stage(light_samples=8, **options)
        snapshot["materials"][0]["nodes"][0]["type"] = "ShaderNodeBsdfGlossy"
        snapshot["materials"][0]["nodes"][0]["inputs"]["Roughness"] = 0.4
        wall(snapshot, picture(3, 400))
        shining(snapshot, s.rectangle(2, 2, 14, 8, 25.0), right_half(snapshot))
        return s.render(snapshot)["combined"]

    whole = rendered()
    assert whole[..., 0].max() > 0.1
    assert np.array_equal(whole, rendered(bucket_size=16))
    assert np.array_equal(whole, rendered(threads=1))
    assert np.array_equal(whole[8:24, 4:20], rendered(crop=np.int32([4, 8, 20, 24])))


@pytest.mark.parametrize("bounces", [0, 1])
def test_of_more_faces_than_may_be_lamps_the_brightest_are(bounces):
    """A wall of 541,696 triangles: what is left out is met by chance, and in any case named with its share."""
    values = np.full((520, 520), 1e-3)
    values[100:116, 200:216] = 10.0
    values[300, 300:340] = 0.0
    snapshot = stage(bounces=bounces)
    wall(snapshot, values)
    rendered = s.render(snapshot)
    ((_, text, _),) = rendered["warnings"]
    assert "more faces than may be lamps" in text
    assert ("by chance" in text) == (bounces > 0)
    share = float(text.split(" %")[0].split()[-1])
    lost = (541_696 - 80 - 2 * 256 - (2**19 - 2 * 256)) / 2 * 1e-3 / values.sum()
    assert lost * 100 <= share <= lost * 100 + 1
    truth = (
        ALBEDO
        * 10.0
        * form_factor(
            200 * 32 / 520, 100 * 32 / 520, 216 * 32 / 520, 116 * 32 / 520, FLOOR - LAMP, *pixels()
        )
    )
    rest = ALBEDO * 1e-3 * form_factor(0, 0, 32, 32, FLOOR - LAMP, *pixels())
    image = rendered["combined"][..., 0]
    assert image.mean() == pytest.approx((truth + rest).mean(), rel=0.01)
