# SPDX-License-Identifier: GPL-3.0-or-later
"""Cut-outs: opacity that ends within micropolygons is found by each sample where it is, moving or in layers."""

import numpy as np
import pytest
import snapshots as s
from snapshots import link
from test_refined_shading import (
    CHANGES,
    CROPS,
    EDGE,
    EXECUTORS,
    SIZE,
    assert_crop_changes_no_bit,
    turned,
)


def stage(executor="SIMD", **options):
    return s.orthographic(SIZE, executor=executor, **{"samples": 256, **options})


def cut(snapshot, operation, value, color=(1, 1, 1), of_x=()):
    """Adds a material that emits where `operation(x, value)` holds of the object's x, and is not there elsewhere.

    `of_x`: operations of x before that, each with its second value.
    """
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(0, "Object")}},
    ]
    for step, other in [*of_x, (operation, value)]:
        x = link(len(nodes) - 1, "X" if len(nodes) == 2 else "Value")
        inputs = {"Value": x, "Value_001": other}
        nodes.append(
            {"type": "ShaderNodeMath", "inputs": inputs, "properties": {"operation": step}}
        )
    last = len(nodes)
    mix = {
        "Fac": link(last - 1, "Value"),
        "Shader": link(last, "BSDF"),
        "Shader_001": link(last + 1, "Emission"),
    }
    nodes += [
        {"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1, 1, 1, 1)}},
        {"type": "ShaderNodeEmission", "inputs": {"Color": (*color, 1), "Strength": 1.0}},
        {"type": "ShaderNodeMixShader", "inputs": mix},
    ]
    index = len(snapshot["materials"])
    surface = (last + 2, "Shader")
    snapshot["materials"].append({"name": f"Cut {index}", "nodes": nodes, "surface": surface})
    return index


def sheet(snapshot, material, z=20.0, **motion):
    s.quad(snapshot, s.rectangle(-100, -50, 150, 60, z), material, **motion)


def row(snapshot, channel=0):
    """[columns], the mean of rows."""
    return s.render(snapshot)["combined"][2:-2, :, channel].mean(axis=0)


def right_of(edge):
    """[columns] part of each that lies right of it."""
    return np.clip(np.arange(SIZE[0]) + 1 - edge, 0.0, 1.0)


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("edge", [20.3, 20.5, 21.0])
def test_a_cut_out_ends_where_it_does(executor, edge):
    snapshot = stage(executor)
    sheet(snapshot, cut(snapshot, "GREATER_THAN", edge))
    picture = s.render(snapshot)["combined"][2:-2].mean(axis=0)
    assert picture[:, 0] == pytest.approx(right_of(edge), abs=EDGE)
    assert picture[:, 3] == pytest.approx(right_of(edge), abs=EDGE)


def test_without_refinement_it_is_a_micropolygon_wide():
    """That the test above can fail."""

    def error(edge):
        snapshot = stage(shading_threshold=1000.0)
        sheet(snapshot, cut(snapshot, "GREATER_THAN", edge))
        return np.abs(row(snapshot) - right_of(edge)).max()

    assert max(error(20 + i / 8) for i in range(8)) > 2 * EDGE


@pytest.mark.parametrize("executor", EXECUTORS)
def test_what_is_behind_its_hole_is_all_there(executor):
    """Nothing behind is culled by what corners think of the opacity, whatever threshold ends lists."""
    snapshot = stage(executor, opacity_threshold=0.95)
    sheet(snapshot, cut(snapshot, "GREATER_THAN", 20.3, (1, 0, 0)), 20.0)
    sheet(snapshot, s.emission(snapshot, (0, 5, 0)), 30.0)
    assert row(snapshot, 1) == pytest.approx(5 * (1 - right_of(20.3)), abs=5 * EDGE)
    assert row(snapshot, 0) == pytest.approx(right_of(20.3), abs=EDGE)


@pytest.mark.parametrize("executor", EXECUTORS)
def test_layers_of_cut_outs_leave_the_product_of_their_holes(executor):
    snapshot = stage(executor)
    sheet(snapshot, cut(snapshot, "GREATER_THAN", 30.7, (1, 0, 0)), 20.0)
    sheet(snapshot, cut(snapshot, "LESS_THAN", 10.4, (0, 1, 0)), 25.0)
    sheet(snapshot, s.emission(snapshot, (0, 0, 1)), 30.0)
    picture = s.render(snapshot)["combined"][2:-2].mean(axis=0)
    assert picture[:, 0] == pytest.approx(right_of(30.7), abs=EDGE)
    assert picture[:, 1] == pytest.approx(1 - right_of(10.4), abs=EDGE)
    assert picture[:, 2] == pytest.approx(right_of(10.4) - right_of(30.7), abs=EDGE)


@pytest.mark.parametrize("executor", EXECUTORS)
def test_a_cut_out_that_moves_is_a_ramp(executor):
    snapshot = stage(executor)
    motion = {"transforms": [s.translation(-10.0), s.translation(10.0)]}
    sheet(snapshot, cut(snapshot, "GREATER_THAN", 24.0), **motion)
    expected = np.clip((np.arange(SIZE[0]) + 0.5 - 14.0) / 20.0, 0.0, 1.0)
    assert row(snapshot) == pytest.approx(expected, abs=EDGE)


def test_stripes_are_where_they_are():
    """Of 3.3 pixels every 6.6: each is seen by some corner, none ends at one."""
    snapshot = stage()
    wave = 2 * np.pi / 6.6
    sheet(snapshot, cut(snapshot, "GREATER_THAN", 0.0, of_x=[("MULTIPLY", wave), ("SINE", 0.0)]))
    fine = np.sin(wave * (np.arange(SIZE[0] * 64) + 0.5) / 64) > 0
    assert row(snapshot) == pytest.approx(fine.reshape(-1, 64).mean(axis=1), abs=EDGE)


@pytest.mark.parametrize("executor", EXECUTORS)
def test_a_hole_is_no_first_surface(executor):
    snapshot = stage(executor, depth_pass=True)
    sheet(snapshot, cut(snapshot, "GREATER_THAN", 20.3), 20.0)
    sheet(snapshot, s.emission(snapshot, (0, 1, 0)), 30.0)
    depth = s.render(snapshot)["depth"][2:-2]
    assert depth[:, :20] == pytest.approx(30.0)
    assert depth[:, 21:] == pytest.approx(20.0)


@pytest.mark.parametrize("executor", EXECUTORS)
def test_a_holdout_is_cut_out_where_it_is(executor):
    snapshot = stage(executor)
    sheet(snapshot, cut(snapshot, "GREATER_THAN", 20.3), 20.0)
    sheet(snapshot, s.emission(snapshot), 30.0)
    snapshot["instances"]["flags"] = [3 | 4, 3]
    picture = s.render(snapshot)["combined"][2:-2].mean(axis=0)
    assert picture[:, 0] == pytest.approx(1 - right_of(20.3), abs=EDGE)
    assert picture[:, 3] == pytest.approx(1 - right_of(20.3), abs=EDGE)


def fine_holes(snapshot, opacity, stripe):
    """Adds a material of `opacity` with holes .12 wide that no corner of a pixel's micropolygon meets, and a texture's edge
    across them at y = 8.4."""
    index = cut(snapshot, "GREATER_THAN", 0.12, of_x=[("SUBTRACT", 0.44), ("FRACT", 0.0)])
    nodes = snapshot["materials"][index]["nodes"]
    mix = next(node for node in nodes if node["type"] == "ShaderNodeMixShader")
    factor = mix["inputs"]["Fac"][1]
    del nodes[factor + 1 :]
    x = {"Value": link(factor, "Value"), "Value_001": opacity}
    y = {"Value": link(1, "Y"), "Value_001": stripe}
    math = "ShaderNodeMath"
    nodes += [
        {"type": math, "inputs": x, "properties": {"operation": "MULTIPLY"}},
        {"type": math, "inputs": y, "properties": {"operation": "GREATER_THAN"}},
        {"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1, 1, 1, 1)}},
        {
            "type": "ShaderNodeEmission",
            "inputs": {"Color": link(factor + 2, "Value"), "Strength": 1.0},
        },
        {
            "type": "ShaderNodeMixShader",
            "inputs": {
                "Fac": link(factor + 1, "Value"),
                "Shader": link(factor + 3, "BSDF"),
                "Shader_001": link(factor + 4, "Emission"),
            },
        },
    ]
    snapshot["materials"][index]["surface"] = (factor + 5, "Shader")
    return index


@pytest.mark.parametrize("executor", EXECUTORS)
def test_fine_holes_let_no_world_through(executor):
    """What is behind the sheets' end was culled: samples that find the holes there may not go by them."""
    snapshot = stage(executor, opacity_threshold=0.996)
    sheet(snapshot, fine_holes(snapshot, 0.97, 8.4), 20.0)
    sheet(snapshot, fine_holes(snapshot, 0.97, 8.4), 25.0)
    sheet(snapshot, s.emission(snapshot, (0, 0, 0)), 30.0)
    result = s.render(snapshot)
    assert result["statistics"]["points_refined"] > 0
    assert result["combined"][..., 3].min() > 0.99


@pytest.mark.parametrize("executor", EXECUTORS)
def test_holes_that_no_corner_meets_are_open(executor):
    """Hiding took such a sheet for opaque."""
    snapshot = stage(executor)
    sheet(snapshot, fine_holes(snapshot, 1.0, 8.4), 20.0)
    picture = s.render(snapshot)["combined"][:, 12:38]
    assert picture[..., 3] == pytest.approx(0.88, abs=EDGE)
    rows = picture[..., 0].mean(axis=1)
    assert rows == pytest.approx(0.88 * np.clip(np.arange(SIZE[1]) + 1 - 8.4, 0.0, 1.0), abs=EDGE)


def test_opacity_that_follows_the_view_is_that_of_each_time():
    """A sheet that turns, as opaque as it is turned away: the integral of Layer Weight's Facing, blend 1/2."""
    snapshot = stage()
    nodes = [
        {"type": "ShaderNodeLayerWeight", "inputs": {"Blend": 0.5}},
        {"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1, 1, 1, 1)}},
        {"type": "ShaderNodeEmission", "inputs": {"Color": (1, 1, 1, 1), "Strength": 1.0}},
        {
            "type": "ShaderNodeMixShader",
            "inputs": {
                "Fac": link(0, "Facing"),
                "Shader": link(1, "BSDF"),
                "Shader_001": link(2, "Emission"),
            },
        },
    ]
    snapshot["materials"].append({"name": "Rim", "nodes": nodes, "surface": (3, "Shader")})
    angles = np.linspace(0.0, 1.2, 33)
    sheet(snapshot, 0, transforms=[turned(a) for a in angles])
    expected = 1.2 - np.sin(1.2)  # of 1 - cos
    assert row(snapshot)[20:28] == pytest.approx(expected / 1.2, abs=0.005)


def busy(**options):
    snapshot = stage(**{"samples": 16, "passes": ["Emission"], **options})
    moves = {"transforms": [s.translation(-3.0), s.translation(4.0)]}
    for i in range(6):
        sheet(snapshot, cut(snapshot, "GREATER_THAN", 7.3 * i + 1), 20.0 + i, **moves)
    sheet(snapshot, s.emission(snapshot, (0, 0, 1), 0.5), 40.0)
    return snapshot


@pytest.mark.parametrize("change", CHANGES, ids=str)
def test_no_bit_depends_on_buckets_threads_or_executor(change):
    base, other = s.render(busy()), s.render(busy(**change))
    assert base["statistics"]["points_refined"] > 500
    assert np.array_equal(base["combined"], other["combined"])
    assert np.array_equal(base["passes"]["Emission"], other["passes"]["Emission"])


def test_lists_in_parts_change_no_bit():
    """40 faint layers of cut-outs; one of them moves over still ones in a corner."""

    def shot(**options):
        snapshot = stage(**{"samples": 256, **options})
        for i in range(40):
            sheet(snapshot, cut(snapshot, "GREATER_THAN", 1.1 * i + 0.7), 20.0 + i)
        moves = {"transforms": [s.translation(-1.0), s.translation(2.0)]}
        s.quad(snapshot, s.rectangle(2, 2, 7, 7, 10.0), s.emission(snapshot, alpha=0.5), **moves)
        return s.render(snapshot)

    whole, parts = shot(), shot(list_memory=1)
    key = "peak_list_bytes"
    assert parts["statistics"][key] < whole["statistics"][key]
    assert np.array_equal(whole["combined"], parts["combined"])


@pytest.mark.parametrize("crop", CROPS)
def test_crop_changes_no_bit(crop):
    assert_crop_changes_no_bit(busy, crop)


def test_the_pass_of_what_is_refined_is_the_picture():
    """All light is the cut-outs' own."""
    result = s.render(busy())
    assert result["passes"]["Emission"][..., :3] == pytest.approx(
        result["combined"][..., :3], abs=1e-5
    )


def test_of_many_layers_those_are_shaded_that_are_seen():
    """24 sheets half open: two of them are seen, in the mean, and of these what lies at edges."""
    snapshot = stage(samples=64)
    wave = 2 * np.pi / 3.3
    for i in range(24):
        of_x = [("ADD", 0.37 * i), ("MULTIPLY", wave), ("SINE", 0.0)]
        sheet(snapshot, cut(snapshot, "GREATER_THAN", 0.0, of_x=of_x), 20.0 + i)
    refined = s.render(snapshot)["statistics"]["points_refined"]
    margin = 2
    assert 0 < refined <= 4 * 64 * (SIZE[0] + 2 * margin) * (SIZE[1] + 2 * margin)


def test_opacity_that_is_even_costs_nothing():
    snapshot = stage()
    sheet(snapshot, s.emission(snapshot, (1, 1, 1), 0.5))
    assert s.render(snapshot)["statistics"]["points_refined"] == 0
