# SPDX-License-Identifier: GPL-3.0-or-later
"""A lit picture converges: edges of shadows and textures within micropolygons, light that changes within the shutter."""

import numpy as np
import pytest
import snapshots as s

EXECUTORS = ["SIMD", "COMPUTE", "REFERENCE"]
SUN, ALBEDO = 3.0, 0.8
LIT = ALBEDO * SUN / np.pi  # a floor, where the sun stands straight above it
VISIBLE, CASTS_SHADOW = 1, 2
SIZE = (48, 16)


def stage(executor="SIMD", **options):
    """A sun that shines along the view."""
    snapshot = s.orthographic(SIZE, executor=executor, **{"samples": 256, **options})
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (ALBEDO,) * 3 + (1,)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": down[None], "energy": SUN}
    ]
    snapshot["instances"]["flags"] = []
    return snapshot


def floor(snapshot, **motion):
    """Much larger than the frame."""
    s.quad(snapshot, s.rectangle(-200, -200, 250, 200, 20.0), 0, **motion)
    snapshot["instances"]["flags"].append(VISIBLE)


def caster(snapshot, x0, x1, **motion):
    """Seen by the sun alone."""
    s.quad(snapshot, s.rectangle(x0, -300, x1, 300, 10.0), 0, **motion)
    snapshot["instances"]["flags"].append(CASTS_SHADOW)


def moves(x0, x1):
    return {"transforms": [s.translation(x0), s.translation(x1)]}


def row(snapshot):
    """[columns], the mean of rows, of what is lit all the time."""
    return s.render(snapshot)["combined"][2:-2, :, 0].mean(axis=0) / LIT


def lit_right_of(edge):
    """[columns] part of each that lies right of it."""
    return np.clip(np.arange(SIZE[0]) + 1 - edge, 0.0, 1.0)


# A pixel's samples are a (0, m, 2)-net: an upright edge is right to one elementary interval of the sixteen a row,
# and the mean of twelve rows, whose scrambles are their own, is right to a third of that.
EDGE = 1 / 16


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("edge", [20.3, 20.5, 21.0])
def test_the_edge_of_a_shadow_is_where_it_is(executor, edge):
    snapshot = stage(executor)
    floor(snapshot)
    caster(snapshot, -300, edge)
    assert row(snapshot) == pytest.approx(lit_right_of(edge), abs=EDGE)


def test_without_refinement_it_is_a_micropolygon_wide():
    """That the tests above can fail."""

    def error(edge):
        snapshot = stage(shading_threshold=1000.0)
        floor(snapshot)
        caster(snapshot, -300, edge)
        return np.abs(row(snapshot) - lit_right_of(edge)).max()

    assert max(error(20 + i / 8) for i in range(8)) > 2 * EDGE


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("way", [8.0, 100.0])
def test_a_floor_that_slides_under_a_still_shadow_keeps_its_edge_sharp(executor, way):
    snapshot = stage(executor)
    floor(snapshot, **moves(-way / 2, way / 2))
    caster(snapshot, -300, 20.3)
    assert row(snapshot) == pytest.approx(lit_right_of(20.3), abs=EDGE)


@pytest.mark.parametrize("executor", EXECUTORS)
def test_a_shadow_that_sweeps_over_a_still_floor_is_a_ramp(executor):
    snapshot = stage(executor)
    floor(snapshot)
    caster(snapshot, -300, 0.0, **moves(12.0, 32.0))
    expected = np.clip((32.0 - (np.arange(SIZE[0]) + 0.5)) / 20.0, 0.0, 1.0)
    assert row(snapshot) == pytest.approx(1.0 - expected, abs=EDGE)


def test_who_goes_along_with_a_shadow_wears_its_edge():
    """The floor and the caster move alike: the edge is blurred by the way, and by nothing else."""
    snapshot = stage()
    floor(snapshot, **moves(0.0, 20.0))
    caster(snapshot, -300, 12.0, **moves(0.0, 20.0))
    expected = np.clip((32.0 - (np.arange(SIZE[0]) + 0.5)) / 20.0, 0.0, 1.0)
    assert row(snapshot) == pytest.approx(1.0 - expected, abs=EDGE)


def turned(angle):
    """About y, through the middle of the frame."""
    m = np.eye(4)
    m[:3, :3] = [
        [np.cos(angle), 0, np.sin(angle)],
        [0, 1, 0],
        [-np.sin(angle), 0, np.cos(angle)],
    ]
    return s.translation(24, 8, 20) @ m @ s.translation(-24, -8, -20)


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("begin, end", [(0.0, 1.0), (0.7, 1.3)])
def test_a_plane_that_turns_is_lit_by_the_mean_of_its_cosines(executor, begin, end):
    """33 knots: their chords are right to 1e-4."""
    snapshot = stage(executor)
    angles = np.linspace(begin, end, 33)
    floor(snapshot, transforms=[turned(a) for a in angles])
    mean = (np.sin(end) - np.sin(begin)) / (end - begin)
    assert row(snapshot)[20:28] == pytest.approx(mean, abs=0.002)


def test_the_edge_of_a_texture_is_where_it_is():
    """Checkers of 10.4 pixels in a material, of which nothing knows where they end."""
    snapshot = stage()
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 0, "Object")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 1, "X"), "Value_001": 20.3},
            "properties": {"operation": "GREATER_THAN"},
        },
        {"type": "ShaderNodeEmission", "inputs": {"Color": ("LINK", 2, "Value"), "Strength": LIT}},
    ]
    snapshot["materials"].append({"name": "Step", "nodes": nodes, "surface": (3, "Emission")})
    s.quad(snapshot, s.rectangle(-2, -2, 50, 18, 20.0), 1)
    snapshot["instances"]["flags"].append(VISIBLE)
    assert row(snapshot) == pytest.approx(lit_right_of(20.3), abs=EDGE)


CHANGES = [
    {"bucket_size": 16},
    {"threads": 1},
    {"threads": 3},
    {"executor": "COMPUTE"},
    {"executor": "REFERENCE"},
]


def busy(**options):
    """Shadows, motion, a lamp with a size and passes."""
    snapshot = stage(**{"samples": 16, "passes": ["Diffuse Direct", "Shadow"], **options})
    floor(snapshot, **moves(-3.0, 3.0))
    caster(snapshot, 10.3, 20.2, **moves(-1.0, 2.0))
    size = {"shape": "SQUARE", "size": (9.0, 9.0)}
    place = np.diag([1.0, -1.0, -1.0, 1.0])
    place[:3, 3] = (30, 8, 0)
    snapshot["lights"].append(
        {"name": "Area", "kind": "AREA", "world_from_light": place[None], "energy": 900.0, **size}
    )
    return snapshot


@pytest.mark.parametrize("change", CHANGES, ids=str)
def test_no_bit_depends_on_buckets_threads_or_executor(change):
    base, other = s.render(busy()), s.render(busy(**change))
    assert base["statistics"]["points_refined"] > 1000
    for name in ("combined", "Diffuse Direct", "Shadow"):
        assert np.array_equal(picture(base, name), picture(other, name)), name


def picture(result, name):
    return result["combined"] if name == "combined" else result["passes"][name]


CROPS = [(0, 0, 48, 1), (13, 5, 31, 9), (47, 15, 48, 16)]


def assert_crop_changes_no_bit(shot, crop):
    """`shot(**options)`: a snapshot."""
    whole = s.render(shot())["combined"]
    part = s.render(shot(crop=np.array(crop, np.int32)))["combined"]
    assert np.array_equal(whole[crop[1] : crop[3], crop[0] : crop[2]], part)


@pytest.mark.parametrize("crop", CROPS)
def test_crop_changes_no_bit(crop):
    assert_crop_changes_no_bit(busy, crop)


@pytest.mark.parametrize("crop", [(8, 8, 16, 16), (10, 0, 16, 16), (0, 8, 48, 16)])
def test_nor_where_what_moves_is_left_out(crop):
    """A still floor under a sweeping shadow, and a small pane that moves before a corner of it."""

    def shot(**options):
        snapshot = stage(samples=16, **options)
        floor(snapshot)
        caster(snapshot, -300, 0.0, **moves(8.0, 20.0))
        pane = s.rectangle(2, 2, 7, 7, 8.0)
        s.quad(snapshot, pane, s.emission(snapshot, alpha=0.5), **moves(-1.0, 1.0))
        snapshot["instances"]["flags"].append(VISIBLE)
        return snapshot

    assert_crop_changes_no_bit(shot, crop)


def test_what_is_smooth_costs_nothing():
    snapshot = stage()
    floor(snapshot)
    assert s.render(snapshot)["statistics"]["points_refined"] == 0


def test_only_what_is_at_an_edge_is_refined():
    snapshot = stage()
    floor(snapshot)
    caster(snapshot, -300, 20.3)
    refined = s.render(snapshot)["statistics"]["points_refined"]
    # Five micropolygons across the edge, and no more.
    assert 0 < refined <= 5 * (SIZE[1] + 2) * 256
