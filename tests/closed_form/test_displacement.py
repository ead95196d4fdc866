# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that materials move: a cube becomes a ball, edges of a rectangle become sines, a square tilts."""

import copy

import numpy as np
import pytest
import snapshots as s
from session_parts import Kept
from snapshots import link

SIZE = 64
MIDDLE = SIZE / 2
FULL = 0.8 * 3.0 / np.pi  # of a matte surface that the sun meets straight on


def vector_math(operation, **inputs):
    return {
        "type": "ShaderNodeVectorMath",
        "inputs": inputs,
        "properties": {"operation": operation},
    }


def matte(snapshot, nodes, displacement, method="DISPLACEMENT"):
    """A white diffuse material whose displacement is an output of `nodes`; returns its index."""
    bsdf = {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.8, 0.8, 1)}}
    snapshot["materials"].append(
        {
            "name": f"Matte {len(snapshot['materials'])}",
            "nodes": [*nodes, bsdf],
            "surface": (len(nodes), "BSDF"),
            "displacement": displacement,
            "displacement_method": method,
        }
    )
    return len(snapshot["materials"]) - 1


def onto_a_ball(snapshot, radius):
    """Moves every point of whatever mesh to a sphere around its origin."""
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        vector_math("NORMALIZE", Vector=link(0, "Object")),
        vector_math("SCALE", Vector=link(1, "Vector"), Scale=float(radius)),
        vector_math("SUBTRACT", Vector=link(2, "Vector"), Vector_001=link(0, "Object")),
        {
            "type": "ShaderNodeVectorDisplacement",
            "inputs": {"Vector": link(3, "Vector"), "Midlevel": 0.0, "Scale": 1.0},
            "properties": {"space": "OBJECT"},
        },
    ]
    return matte(snapshot, nodes, (4, "Displacement"))


def sun(snapshot, towards):
    """A hard sun; `towards`: where its light comes from."""
    z = np.asarray(towards, float) / np.linalg.norm(towards)
    x = np.cross((0.3, 1.0, 0.2), z)
    x /= np.linalg.norm(x)
    turned = np.eye(4)
    turned[:3, :3] = np.stack([x, np.cross(z, x), z], 1)
    lamp = {"name": "Sun", "kind": "SUN", "world_from_light": turned[None], "energy": 3.0}
    snapshot["lights"] = [{**lamp, "sun_angle": 0.0}]
    return z


def cube(snapshot, half, materials, transforms, subdivided=False):
    sign = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    extra = {"subdivision": {"scheme": "CATMULL_CLARK"}} if subdivided else {}
    s.mesh(snapshot, half * sign, faces, materials[0], transforms=transforms, **extra)
    if len(materials) > 1:
        snapshot["geometries"][0]["material_index"] = np.array([0, 1, 0, 1, 1, 0], np.int32)
        snapshot["instances"]["slots"] = [len(materials)]
        snapshot["instances"]["materials"] = list(materials)


def turned(angle=0.6, x=MIDDLE):
    c, n = np.cos(angle), np.sin(angle)
    m = np.eye(4)
    m[:3, :3] = np.array([[c, 0, n], [0, 1, 0], [-n, 0, c]]) @ [[1, 0, 0], [0, c, -n], [0, n, c]]
    m[:3, 3] = (x, MIDDLE, 60.0)
    return m


def ball(radius=20.0, towards=(0, 0, -1), subdivided=False, **options):
    snapshot = s.orthographic((SIZE, SIZE), **{"samples": 64, "executor": "SIMD", **options})
    cube(snapshot, 12.0, [onto_a_ball(snapshot, radius)], [turned()], subdivided)
    return snapshot, sun(snapshot, towards)


def offsets():
    y, x = np.mgrid[:SIZE, :SIZE] + 0.5 - MIDDLE
    return x, y, np.hypot(x, y)


@pytest.mark.parametrize("subdivided", [False, True], ids=["polygons", "subdivision"])
def test_a_cube_that_is_moved_onto_a_ball_covers_its_disc(subdivided):
    snapshot, _ = ball(subdivided=subdivided)
    alpha = s.render(snapshot)["combined"][..., 3]
    away = offsets()[2]
    assert (alpha[away < 19.2] == 1.0).all()
    assert (alpha[away > 20.8] == 0.0).all()
    # A tenth of a pixel along the outline would be 12.6 pixels; micropolygons of a pixel cut arcs short by 1/160 of one
    # on the average, and those that stretch as the cube's corners are rounded by more.
    assert alpha.sum() == pytest.approx(np.pi * 20.0**2, abs=4.0)


@pytest.mark.parametrize("towards", [(0, 0, -1), (1, 0.5, -0.6), (-0.4, 1, -0.3)])
@pytest.mark.parametrize("subdivided", [False, True], ids=["polygons", "subdivision"])
def test_its_normals_are_the_balls_and_it_does_not_shade_itself(subdivided, towards):
    snapshot, light = ball(towards=towards, subdivided=subdivided)
    color = s.render(snapshot)["combined"][..., 0]
    x, y, away = offsets()
    depth = -np.sqrt(np.maximum(20.0**2 - away**2, 0.0))
    cosine = (x * light[0] + y * light[1] + depth * light[2]) / 20.0
    inside = away < 18.5
    # A pixel is the mean of what changes in it by up to .1 near the outline.
    bright = inside & (cosine > 0.15)
    assert color[bright] == pytest.approx(FULL * cosine[bright], abs=0.02)
    assert np.abs(color[inside & (cosine < -0.15)]).sum() == 0.0


@pytest.mark.parametrize("samples", [16])
def test_nothing_is_seen_through_a_closed_surface_of_two_materials_in_motion(samples):
    snapshot = s.orthographic((SIZE, SIZE), samples=samples, executor="SIMD")
    materials = [onto_a_ball(snapshot, 20.0), onto_a_ball(snapshot, 17.0)]
    cube(snapshot, 12.0, materials, [turned(0.6, MIDDLE - 2), turned(0.9, MIDDLE + 2)])
    alpha = s.render(snapshot)["combined"][..., 3]
    away = offsets()[2]
    assert (alpha[away < 14.0] == 1.0).all()


def test_a_rectangles_edges_become_sines():
    snapshot = s.orthographic((SIZE, SIZE), samples=64, executor="SIMD")
    height, wave = 5.0, 2 * np.pi / 24.0
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(0, "Object")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": link(1, "X"), "Value_001": wave},
            "properties": {"operation": "MULTIPLY"},
        },
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": link(2, "Value"), "Value_001": 0.0},
            "properties": {"operation": "SINE"},
        },
        {"type": "ShaderNodeCombineXYZ", "inputs": {"X": 0.0, "Y": link(3, "Value"), "Z": 0.0}},
        {
            "type": "ShaderNodeVectorDisplacement",
            "inputs": {"Vector": link(4, "Vector"), "Midlevel": 0.0, "Scale": height},
            "properties": {"space": "OBJECT"},
        },
    ]
    material = matte(snapshot, nodes, (5, "Displacement"))
    s.quad(snapshot, s.rectangle(4, 16, 60, 48, 10.0), material)
    alpha = s.render(snapshot)["combined"][..., 3]
    x = np.arange(5, 59)
    edge = 48 + height * (np.cos(wave * x) - np.cos(wave * (x + 1))) / wave  # mean over a column
    # 64 samples a pixel place an edge within 1/64 in each column, and a slope's a little worse.
    assert alpha[32:, 5:59].sum(0) + 32 == pytest.approx(edge, abs=0.1)


@pytest.mark.parametrize("method", ["BUMP", "DISPLACEMENT", "BOTH"])
def test_a_height_that_grows_evenly_tilts_a_square(method):
    snapshot = s.orthographic((SIZE, SIZE), samples=16, executor="SIMD")
    slope = 0.5
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(0, "Object")}},
        {
            "type": "ShaderNodeDisplacement",
            "inputs": {"Height": link(1, "X"), "Midlevel": 32.0, "Scale": slope},
            "properties": {"space": "OBJECT"},
        },
    ]
    material = matte(snapshot, nodes, (2, "Displacement"), method)
    s.quad(snapshot, s.rectangle(4, 4, 60, 60, 40.0)[::-1], material)  # faces the camera
    light = sun(snapshot, (0.3, 0, -1))
    color = s.render(snapshot)["combined"][..., 0]
    # It rises towards the camera, which is -z, and so leans to -x.
    normal = np.array([-slope, 0.0, -1.0]) / np.hypot(1.0, slope)
    assert color[8:56, 8:56] == pytest.approx(FULL * normal @ light, abs=2e-3)


def tilted(angle, size, depth):
    """A sheet's middle, at z = 40 of its own, stays in the middle of the picture as its far side sinks."""
    c, n = np.cos(angle), np.sin(angle)
    middle = np.array([size / 2, depth / 2, 40.0])
    turned = np.array([[1, 0, 0], [0, c, -n], [0, n, c]])
    matrix = np.eye(4)
    matrix[:3, :3] = turned
    matrix[:3, 3] = np.array([size / 2, size / 2, 400.0]) - turned @ middle
    return matrix[None]


def sheet_of_waves(
    modelled, size=48, height=4.0, wave=2 * np.pi / 16.0, tilt=0.0, samples=16, **options
):
    """A sheet of waves that a low sun makes shade each other, displaced or modelled five times as finely as pixels."""
    snapshot = s.orthographic((size, size), samples=samples, executor="SIMD", **options)
    sun(snapshot, (1.0, 0.4, -0.6))
    depth = round(1.5 * size / np.cos(tilt)) if tilt else size
    transforms = tilted(tilt, size, depth) if tilt else None
    if modelled:
        n, rows = 5 * size, 5 * depth
        x, y = np.meshgrid(np.linspace(0, size, n + 1), np.linspace(0, depth, rows + 1))
        z = 40.0 - height * np.sin(wave * x) * np.sin(wave * y)
        first = np.arange(rows * (n + 1)).reshape(rows, n + 1)[:, :-1].ravel()
        faces = np.stack([first, first + n + 1, first + n + 2, first + 1], 1)
        points = np.stack([x, y, z], -1).reshape(-1, 3)
        smooth = np.ones(len(faces), np.uint8)
        material = matte(snapshot, [], None)
        s.mesh(snapshot, points, faces.tolist(), material, transforms, smooth=smooth)
        return snapshot
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(0, "Object")}},
    ]

    def math(operation, a, b=0.0):
        inputs = {"Value": a, "Value_001": b}
        properties = {"operation": operation}
        nodes.append({"type": "ShaderNodeMath", "inputs": inputs, "properties": properties})
        return link(len(nodes) - 1, "Value")

    sines = [math("SINE", math("MULTIPLY", link(1, axis), wave)) for axis in "XY"]
    inputs = {"Height": math("MULTIPLY", *sines), "Midlevel": 0.0, "Scale": height}
    nodes.append({"type": "ShaderNodeDisplacement", "inputs": inputs})
    material = matte(snapshot, nodes, (len(nodes) - 1, "Displacement"))
    s.quad(snapshot, s.rectangle(0, 0, size, depth, 40.0)[::-1], material, transforms=transforms)
    return snapshot


def waves(modelled, **options):
    return s.render(sheet_of_waves(modelled, **options))["combined"][..., 0]


def test_hills_on_a_plain_that_is_seen_edge_on_are_those_modelled():
    # Waves of 16 pixels are three high on the plain, where one micropolygon of it as it lies would be five pixels deep.
    # Chords of a pixel cut crests that are seen from the side short; half as long, which samples pay for, a third as much.
    modelled = waves(True, height=3.0, tilt=np.radians(78), samples=64)
    for samples, darker, noise in ((4, 0.045, 0.06), (16, 0.014, 0.021), (64, 0.012, 0.009)):
        displaced = waves(False, height=3.0, tilt=np.radians(78), samples=samples)
        assert displaced.mean() == pytest.approx(modelled.mean(), rel=darker)
        assert np.sqrt(np.mean((displaced - modelled) ** 2)) < noise


def test_what_is_rough_is_diced_as_finely_as_samples_tell():
    def diced(samples, **of):
        return s.render(sheet_of_waves(False, samples=samples, **of))["statistics"]["points_diced"]

    rough = {"height": 1.0, "wave": 2 * np.pi / 5.0}
    smooth = {"height": 0.5, "wave": 2 * np.pi / 40.0}
    few = diced(4, **rough)
    assert diced(64, **rough) == pytest.approx(4 * few, rel=0.03)
    assert diced(256, **rough) > 10 * few
    assert diced(4, **smooth) == diced(256, **smooth) == few


def test_what_is_diced_for_light_is_diced_anew_without():
    glow = {"type": "ShaderNodeEmission", "inputs": {"Color": (1, 1, 1, 1), "Strength": 1.0}}
    lit = sheet_of_waves(False, height=1.0, wave=2 * np.pi / 5.0)
    shining = lit["materials"][0]
    shining |= {"nodes": [*shining["nodes"], glow], "surface": (len(shining["nodes"]), "Emission")}
    s.quad(lit, s.rectangle(0, 0, 8, 8, 30.0)[::-1], matte(lit, [], None))
    kept = Kept()
    kept.follow(lit)
    unlit = copy.deepcopy(lit)
    unlit["materials"][1] |= {"nodes": [glow], "surface": (0, "Emission")}
    before = kept.statistics["points_diced"]
    kept.follow(unlit)
    assert 0 < kept.statistics["points_diced"] < 0.5 * before


def test_samples_that_may_not_be_taken_or_shaded_make_nothing_finer():
    def diced(**options):
        snapshot = sheet_of_waves(False, height=1.0, wave=2 * np.pi / 5.0, **options)
        return s.render(snapshot)["statistics"]["points_diced"]

    few = diced(samples=4)
    assert diced(samples=256, noise_threshold=0.01, min_samples=8) == few
    assert diced(samples=256, refine_samples=False) == few


def test_corners_of_what_is_rough_are_not_lit():
    rough = sheet_of_waves(False, height=1.0, wave=2 * np.pi / 5.0, samples=64)
    done = s.render(rough)["statistics"]
    assert done["points_shaded"] == done["points_refined"] == 48 * 48 * 64
    smooth = sheet_of_waves(False, height=0.5, wave=2 * np.pi / 40.0, samples=64)
    assert s.render(smooth)["statistics"]["points_refined"] == 0
    # But where no sample is to be shaded by itself, and where light bounces and all of them are seen.
    rough["options"]["shading_threshold"] = 1000.0
    assert s.render(rough)["statistics"]["points_refined"] == 0
    rough["options"] |= {"shading_threshold": 0.06, "bounces": 1}
    assert s.render(rough)["statistics"]["grids_shaded"] > 0


def test_shadows_are_those_of_the_same_waves_modelled():
    displaced, modelled = waves(False), waves(True)
    assert (modelled < 0.02).mean() > 0.1  # there are shadows
    # Edges of shadows are a part of a pixel away.
    assert np.sqrt(np.mean((displaced - modelled) ** 2)) < 0.011
    # Where nothing changes from pixel to pixel there is no speckle, dark or bright.
    around = np.stack([np.roll(modelled, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    even = np.ptp(around, 0) < 0.1
    assert even.mean() > 0.2
    assert displaced[even] == pytest.approx(modelled[even], abs=0.06)


def test_pictures_do_not_depend_on_buckets_threads_or_crop():
    snapshot, _ = ball(towards=(1, 0.5, -0.6), samples=16)
    whole = s.render(snapshot)["combined"]
    for change in ({"bucket_size": 16, "threads": 1}, {"bucket_size": 48, "threads": 2}):
        other, _ = ball(towards=(1, 0.5, -0.6), samples=16, **change)
        assert (s.render(other)["combined"] == whole).all(), change
    rough = {"height": 1.0, "wave": 2 * np.pi / 5.0}
    whole = waves(False, **rough)
    for change in ({"bucket_size": 16, "threads": 1}, {"bucket_size": 32, "threads": 2}):
        assert (waves(False, **rough, **change) == whole).all(), change


def test_what_lies_beside_a_narrow_face_is_not_said_to_go_too_far():
    """Slopes across a strip of a pixel are told by places beside it, where its height is more than its bound."""
    snapshot = s.orthographic((16, 16), samples=16, executor="SIMD")
    sun(snapshot, (0, 0, -1))
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(0, "Object")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": link(1, "X"), "Value_001": 2.0},
            "properties": {"operation": "POWER"},
        },
        {
            "type": "ShaderNodeDisplacement",
            "inputs": {"Height": link(2, "Value"), "Midlevel": 0.0, "Scale": 1.0},
        },
    ]
    strip = matte(snapshot, nodes, (3, "Displacement"))
    at = np.eye(4)[None].copy()
    at[0, :3, 3] = (6.0, 4.0, 40.0)
    s.quad(snapshot, s.rectangle(0, 0, 1.2, 8.0, 0.0)[::-1], strip, transforms=at)
    assert s.render(snapshot)["warnings"] == []


def test_points_of_a_material_that_displaces_are_named():
    snapshot = s.orthographic((SIZE, SIZE), samples=4, executor="SIMD")
    points = {
        "name": "points 'Points'",
        "kind": "POINTS",
        "points": np.array([[[MIDDLE, MIDDLE, 40.0]]], np.float32),
        "radius": np.array([[10.0]], np.float32),
    }
    snapshot["geometries"].append(points)
    s.instance(snapshot, 0, onto_a_ball(snapshot, 20.0))
    done = s.render(snapshot)
    assert [m for _, m, _ in done["warnings"] if "no effect on curves and points" in m]
    assert done["combined"][..., 3].sum() == pytest.approx(np.pi * 10.0**2, abs=5.0)
