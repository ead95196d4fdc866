# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes of light where something is filled."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import material
from test_passes import everything
from test_volumes import SIGMA, absorption, box, emitted, filled, lamp, scatter, wall

LOBES = ("Diffuse", "Glossy", "Transmission")
LIGHT = [f"{lobe} {part}" for lobe in LOBES for part in ("Direct", "Indirect", "Color")]
LIGHT += ["Volume Direct", "Volume Indirect", "Emission", "Environment"]


def rendered(snapshot, names=LIGHT, **options):
    snapshot["options"] |= {"passes": list(names), **options}
    return s.render(snapshot)


def summed(passes):
    light = sum(
        (passes[f"{lobe} Direct"] + passes[f"{lobe} Indirect"]) * passes[f"{lobe} Color"]
        for lobe in LOBES
    )
    return light + sum(passes[name] for name in LIGHT[9:])


def smoky(bounces, executor="SIMD", scene=everything, **options):
    """All that passes have to tell apart, in coloured smoke that glows, before, between and behind layers."""
    snapshot = s.orthographic(
        (48, 32), executor=executor, film_transparent=False, bounces=bounces, **options
    )
    snapshot["options"]["volume_bounces"] = bounces
    scene(snapshot)
    smoke = scatter(0.3, 0.0)
    smoke["inputs"]["Color"] = (0.9, 0.6, 0.2, 1.0)
    box(
        snapshot,
        (-2, -2, 1),
        (22, 40, 3.5),
        filled(snapshot, smoke, absorption(0.1), emitted(0.05)),
    )
    return snapshot


@pytest.mark.parametrize("bounces", [0, 3])
def test_parts_sum_to_the_picture(executor, bounces):
    made = rendered(smoky(bounces, executor))
    combined = made["combined"][..., :3]
    assert (made["passes"]["Volume Direct"].max(axis=(0, 1)) > 0.01).all()
    assert (made["passes"]["Volume Indirect"].max() > 1e-3) == (bounces > 0)
    # float32 sums over a pixel's samples, relative.
    assert np.abs(summed(made["passes"]) - combined).max() < 1e-5 * combined.max()


def test_passes_do_not_change_the_picture():
    plain, all_passes = (rendered(smoky(3), names) for names in ([], LIGHT))
    assert np.array_equal(plain["combined"], all_passes["combined"])


def test_holdouts_keep_the_light_before_them():
    """Opaque, and a layer that lets half through: of what is filled, that before them is left."""

    def scene(snapshot):
        wall(snapshot, 9.0)
        s.quad(snapshot, s.rectangle(0, 0, 30, 32, 5), s.emission(snapshot))
        s.quad(snapshot, s.rectangle(0, 0, 15, 32, 2), s.emission(snapshot, alpha=0.5))
        snapshot["instances"]["flags"] = [3, 7, 7]

    snapshot = smoky(0, scene=scene)
    snapshot["instances"]["flags"] = [3, 7, 7, 3]
    lamp(snapshot, (20.0, 10.0, -10.0))
    made = rendered(snapshot)
    combined = made["combined"][..., :3]
    assert (combined[:, :12] > 0.005).all()
    assert np.abs(summed(made["passes"]) - combined).max() < 1e-5 * combined.max()


def test_surfaces_are_dimmed_and_what_is_filled_shines_in_emission():
    """A wall of 1 behind a slab that takes light of each channel and sends out .5 a metre."""
    snapshot = s.orthographic((8, 8), samples=4)
    wall(snapshot)
    node = absorption()
    node["inputs"]["Color"] = (0.0, 0.5, 0.9, 1.0)
    box(snapshot, (-1, -1, 2), (20, 20, 5), filled(snapshot, node, emitted(0.5)))
    emission = rendered(snapshot)["passes"]["Emission"]
    sigma = SIGMA * np.array([1.0, 0.5, 0.1])
    left = np.exp(-3 * sigma)
    assert emission == pytest.approx(
        np.broadcast_to(left + 0.5 * (1 - left) / sigma, emission.shape), rel=1e-5
    )


def test_the_environment_is_dimmed_and_colours_are():
    snapshot = s.orthographic((8, 8), samples=4, film_transparent=False)
    s.constant_world(snapshot, 0.7)
    diffuse = {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.8, 0.8, 1.0)}}
    s.quad(snapshot, s.rectangle(0, 0, 4, 8, 10), material(snapshot, [diffuse], (0, "BSDF")))
    box(snapshot, (-1, -1, 2), (20, 20, 5), filled(snapshot, absorption()))
    made = rendered(snapshot)["passes"]
    left = np.exp(-3 * SIGMA)
    assert made["Environment"][:, 5:] == pytest.approx(0.7 * left, rel=1e-5)
    assert made["Diffuse Color"][:, :3] == pytest.approx(0.8 * left, rel=1e-5)


def test_no_bit_depends_on_buckets_or_threads():
    one = rendered(smoky(2), threads=1, bucket_size=128)["passes"]
    many = rendered(smoky(2), threads=3, bucket_size=16)["passes"]
    for name, values in one.items():
        assert np.array_equal(values, many[name]), name
