# SPDX-License-Identifier: GPL-3.0-or-later
"""Ribbons that light passes: of the layers that a sample sees through each other it shades one in the mean."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import material
from test_elements import curves

ALBEDO = 0.8
RADIUS = 0.45  # of a ribbon that only samples shade


def fading(snapshot, opacity):
    nodes = [
        {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (ALBEDO,) * 3 + (1.0,)}},
        {"type": "ShaderNodeBsdfTransparent"},
        {
            "type": "ShaderNodeMixShader",
            "inputs": {
                "Fac": opacity,
                "Shader": ("LINK", 1, "BSDF"),
                "Shader_001": ("LINK", 0, "BSDF"),
            },
        },
    ]
    return material(snapshot, nodes, (2, "Shader"))


def stacks(layers, opacity, **options):
    """Twelve upright hairs, each of so many behind one another, under a sun that nothing hides."""
    return stacks_of([opacity] * layers, **options)


def stacks_of(opacities, **options):
    """From front to back, a unit apart."""
    snapshot = s.orthographic((48, 32), light_samples=4, **options)
    for layer, opacity in enumerate(opacities):
        surface = fading(snapshot, opacity)
        places = [
            (4.0 * x + 2.3, y, 20.0 + layer) for x in range(12) for y in (-20.0, 5.0, 27.0, 52.0)
        ]
        curves(snapshot, places, [4] * 12, RADIUS, surface)
    turned = np.eye(4)
    turned[:3, 2] = (0.0, 0.0, -1.0)
    turned[:3, 0] = (-1.0, 0.0, 0.0)
    sun = {"name": "Sun", "kind": "SUN", "world_from_light": turned[None], "energy": np.pi}
    snapshot["lights"] = [sun | {"casts_shadow": False}]
    return snapshot


def test_layers_are_seen_through_each_other():
    """Half of each layer's light reaches the next: n of them show 1 - 2^-n of what a solid one shows."""
    solid = s.render(stacks(1, 1.0, samples=64))["combined"]
    made = s.render(stacks(4, 0.5, samples=64))
    # Which layer a sample takes makes no difference here, but for those whose sum is below 1.
    assert made["combined"][..., :3].sum() == pytest.approx(
        (1 - 0.5**4) * solid[..., :3].sum(), rel=0.002
    )
    assert made["combined"][..., 3].sum() == pytest.approx(
        (1 - 0.5**4) * solid[..., 3].sum(), rel=1e-4
    )
    # A shading point for a sample that sees anything: 48 x 32 pixels, of which .9 in 4.
    assert made["statistics"]["points_refined"] < 64 * 48 * 32 * 0.25


@pytest.mark.parametrize("opacity", [0.05, 0.3, 0.9])
def test_what_is_nearly_clear_brings_its_light(opacity):
    made = s.render(stacks(3, opacity, samples=256))["combined"][..., 0].sum()
    solid = s.render(stacks(1, 1.0, samples=256))["combined"][..., 0].sum()
    assert made == pytest.approx((1 - (1 - opacity) ** 3) * solid, rel=0.01)


PASSES = ["Combined", "Diffuse Direct", "Diffuse Color", "Normal"]


def test_passes_that_add_up():
    """Light and colour as Combined, whose bits they do not change; what mist takes of it."""
    mist = np.array([0.0, 40.0, 1.0], np.float32)  # all of it at 40
    made = s.render(stacks(4, 0.5, samples=64, passes=[*PASSES, "Mist"], mist=mist))
    solid = s.render(stacks(1, 1.0, samples=64, passes=PASSES))
    alone = s.render(stacks(4, 0.5, samples=64, passes=["Combined"]))
    assert np.array_equal(made["combined"], alone["combined"])
    color, expected = (frame["passes"]["Diffuse Color"].sum() for frame in (made, solid))
    assert color == pytest.approx((1 - 0.5**4) * expected, rel=0.002)
    light = made["passes"]["Diffuse Direct"] * made["passes"]["Diffuse Color"]
    assert light == pytest.approx(made["combined"][..., :3], abs=1e-5)
    covered = solid["combined"][..., 3].sum()
    clear = sum(0.5 ** (k + 1) * (1 - (20.0 + k) / 40.0) for k in range(4))
    assert (1.0 - made["passes"]["Mist"]).sum() == pytest.approx(clear * covered, rel=0.005)


@pytest.mark.parametrize("ends", [1.0, 0.4])
@pytest.mark.parametrize("opacities, first", [([0.3, 0.3, 0.6, 0.9], 2), ([0.9, 0.3], 0)])
def test_passes_show_the_first_layer_that_is_solid_enough(opacities, first, ends):
    """Whichever the sample takes, behind the end of its list too; .9 is reached by .9, however it is rounded."""
    limits = {"opacity_threshold": ends, "pass_alpha_threshold": opacities[first]}
    passes = ["Combined", "Position", "Normal", "Object Index"]
    made = s.render(stacks_of(opacities, samples=64, passes=passes, **limits))["passes"]
    solid = s.render(stacks_of([1.0], samples=64, passes=passes))["passes"]
    assert np.abs(solid["Normal"]).max() > 0.4
    assert made["Normal"] == pytest.approx(solid["Normal"], abs=1e-5)
    shown = np.abs(solid["Position"]).max(axis=-1) > 0.0
    assert 100 < shown.sum() < 1500
    depth = made["Position"][shown][:, 2] - solid["Position"][shown][:, 2]
    assert np.abs(depth) == pytest.approx(np.full(shown.sum(), first), abs=1e-4)


def test_bits_do_not_depend_on_buckets_threads_or_crop():
    def picture(**options):
        snapshot = stacks(3, 0.4, samples=16, bounces=2, **options)
        s.constant_world(snapshot, 1.0)
        snapshot["world"]["lights_scene"] = True
        return s.render(snapshot)["combined"]

    whole = picture()
    assert np.array_equal(whole, picture(bucket_size=16, threads=1))
    assert np.array_equal(whole, picture(bucket_size=48, threads=3))
    crop = np.int32([8, 6, 40, 30])
    assert np.array_equal(whole[6:30, 8:40], picture(crop=crop))
