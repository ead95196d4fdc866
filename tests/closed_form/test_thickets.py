# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaves that hide each other: samples are shaded by themselves, and what nobody sees is not."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import diffuse, material

SIZE = 48  # pixels
SMALL, LATTICE = 2.5, 5.0  # sides of leaves, pixels: several share a grid, or one has it
ALBEDO = 0.5


def leaves(snapshot, count, material, side, seed=5):
    """Squares at any turn between 3 and 43 pixels behind the picture, wider than which they spread."""
    random = np.random.default_rng(seed)
    centers = random.uniform((-8, -8, 3), (SIZE + 8, SIZE + 8, 43), (count, 3))
    axes = np.stack([np.linalg.qr(m)[0].T for m in random.normal(size=(count, 3, 2))])
    u, v = side / 2 * axes[:, 0], side / 2 * axes[:, 1]
    points = centers[:, None] + np.stack([-u - v, u - v, u + v, v - u], 1)
    faces = np.arange(4 * count).reshape(-1, 4).tolist()
    s.mesh(snapshot, points.reshape(-1, 3), faces, material)


def thin(snapshot):
    """What a fifth of the light that it scatters passes."""
    nodes = [
        {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8 * ALBEDO,) * 3 + (1.0,)}},
        {"type": "ShaderNodeBsdfTranslucent", "inputs": {"Color": (0.2 * ALBEDO,) * 3 + (1.0,)}},
        {"type": "ShaderNodeEmission", "inputs": {"Color": (1.0 - ALBEDO,) * 3 + (1.0,)}},
    ]
    for first, other in (((0, "BSDF"), (1, "BSDF")), ((3, "Shader"), (2, "Emission"))):
        inputs = {"Shader": ("LINK", *first), "Shader_001": ("LINK", *other)}
        nodes.append({"type": "ShaderNodeAddShader", "inputs": inputs})
    return material(snapshot, nodes, (4, "Shader"))


def opaque(snapshot):
    return diffuse(snapshot, ALBEDO, 1.0 - ALBEDO)


def in_a_furnace(count=6000, side=SMALL, surface=opaque, **options):
    """Leaves that send out what they do not scatter."""
    limits = {"bounces": 8, "diffuse_bounces": 8, "clamp_indirect": 0.0}
    options = {"samples": 16, "light_samples": 16, "executor": "SIMD", **limits, **options}
    snapshot = s.orthographic((SIZE, SIZE), **options)
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    leaves(snapshot, count, surface(snapshot), side)
    return snapshot


@pytest.mark.parametrize("surface", [opaque, thin])
@pytest.mark.parametrize(("count", "side"), [(6000, SMALL), (1200, LATTICE)])
def test_leaves_in_a_furnace_are_not_seen(count, side, surface):
    """But for the noise of leaves as lamps to each other: .9976 to 1.0013 of six such pictures of small ones.  What passes
    thin ones is drawn by a sample in two to three: were each counted as one, .02 would lack."""
    options = {"samples": 64, "light_samples": 64}
    picture = s.render(in_a_furnace(count, side, surface, **options))["combined"][..., 0]
    assert picture.mean() == pytest.approx(1.0, abs=0.005)


@pytest.mark.parametrize(("count", "side"), [(12000, SMALL), (2400, LATTICE)])
def test_what_nobody_sees_is_not_shaded(count, side):
    """No more points than samples; they were more by a half and by a quarter, and more the more leaves."""
    statistics = s.render(in_a_furnace(count, side))["statistics"]
    assert statistics["points_shaded"] < 16 * SIZE**2
    assert statistics["points_refined"] > 0.8 * statistics["points_shaded"]


@pytest.mark.parametrize(("count", "side"), [(6000, SMALL), (1200, LATTICE)])
@pytest.mark.parametrize(
    "options", [{"bucket_size": 16}, {"threads": 1}, {"crop": np.int32([4, 8, 20, 24])}]
)
def test_bits_do_not_depend_on_buckets_threads_or_crop(count, side, options):
    whole = s.render(in_a_furnace(count, side, thin))["combined"]
    if "crop" in options:
        whole = whole[8:24, 4:20]
    assert np.array_equal(whole, s.render(in_a_furnace(count, side, thin, **options))["combined"])


def glossy_under_a_lamp(light_samples, **options):
    """Of diffuse light and a seventh as much of gloss, which looks for the lamp by itself too."""
    nodes = [
        {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.7, 0.7, 0.7, 1.0)}},
        {
            "type": "ShaderNodeBsdfGlossy",
            "inputs": {"Color": (0.1, 0.1, 0.1, 1.0), "Roughness": 0.4},
        },
        {
            "type": "ShaderNodeAddShader",
            "inputs": {"Shader": ("LINK", 0, "BSDF"), "Shader_001": ("LINK", 1, "BSDF")},
        },
    ]
    snapshot = s.orthographic(
        (SIZE, SIZE),
        samples=16,
        light_samples=light_samples,
        bounces=1,
        clamp_indirect=0.0,
        **options,
    )
    leaves(snapshot, 6000, material(snapshot, nodes, (2, "Shader")), SMALL)
    place = s.translation(SIZE / 2, SIZE / 2, -10.0)
    place[:3, :3] = np.diag([1.0, -1.0, -1.0])
    lamp = {"name": "Area", "kind": "AREA", "energy": 1e5, "shape": "SQUARE", "size": (40.0, 40.0)}
    snapshot["lights"] = [{"world_from_light": place[None], **lamp}]
    return s.render(snapshot)


def test_gloss_that_few_samples_look_by_is_as_bright():
    """One in four has a sample of it, and of 128 light samples all: means over three seeds, which deviate by .8 and .3 %."""
    few, many = (
        [glossy_under_a_lamp(light_samples, seed=seed) for seed in range(3)]
        for light_samples in (4, 128)
    )
    assert few[0]["statistics"]["points_refined"] > 0.8 * few[0]["statistics"]["points_shaded"]
    mean = np.mean([one["combined"][..., 0] for one in many])
    assert np.mean([one["combined"][..., 0] for one in few]) == pytest.approx(mean, rel=0.015)
