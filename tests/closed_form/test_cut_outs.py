# SPDX-License-Identifier: GPL-3.0-or-later
"""Cut-outs: opacity that ends within micropolygons is found by each sample where it is, moving or in layers."""

import numpy as np
import pytest
import snapshots as s

EXECUTORS = ["SIMD", "COMPUTE", "REFERENCE"]
SIZE = (48, 16)
# As of test_refined_shading.py: one elementary interval of the sixteen in a row of a pixel's samples.
EDGE = 1 / 16


def stage(executor="SIMD", **options):
    return s.orthographic(SIZE, executor=executor, **{"samples": 256, **options})


def link(node, socket):
    return ("LINK", node, socket)


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


CHANGES = [
    {"bucket_size": 16},
    {"threads": 1},
    {"threads": 3},
    {"executor": "COMPUTE"},
    {"executor": "REFERENCE"},
    {"list_memory": 1},
]


def busy(**options):
    snapshot = stage(**{"samples": 16, "passes": ["Emission"], **options})
    moves = {"transforms": [s.translation(-3.0), s.translation(4.0)]}
    for i in range(6):
        sheet(snapshot, cut(snapshot, "GREATER_THAN", 7.3 * i + 1), 20.0 + i, **moves)
    sheet(snapshot, s.emission(snapshot, (0, 0, 1), 0.5), 40.0)
    return snapshot


@pytest.mark.parametrize("change", CHANGES, ids=str)
def test_no_bit_depends_on_buckets_threads_memory_or_executor(change):
    base, other = s.render(busy()), s.render(busy(**change))
    assert base["statistics"]["points_refined"] > 500
    assert np.array_equal(base["combined"], other["combined"])
    assert np.array_equal(base["passes"]["Emission"], other["passes"]["Emission"])


@pytest.mark.parametrize("crop", [(0, 0, 48, 1), (13, 5, 31, 9), (47, 15, 48, 16)])
def test_crop_changes_no_bit(crop):
    whole = s.render(busy())["combined"]
    part = s.render(busy(crop=np.array(crop, np.int32)))["combined"]
    assert np.array_equal(whole[crop[1] : crop[3], crop[0] : crop[2]], part)


def test_the_pass_of_what_is_refined_is_the_picture():
    """All light is the cut-outs' own."""
    result = s.render(busy())
    assert result["passes"]["Emission"][..., :3] == pytest.approx(
        result["combined"][..., :3], abs=1e-5
    )


def test_opacity_that_is_even_costs_nothing():
    snapshot = stage()
    sheet(snapshot, s.emission(snapshot, (1, 1, 1), 0.5))
    assert s.render(snapshot)["statistics"]["points_refined"] == 0
