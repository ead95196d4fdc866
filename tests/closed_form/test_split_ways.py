# SPDX-License-Identifier: GPL-3.0-or-later
"""What mirrors and clear glass show is a way of its own for each light sample of their points."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import ALBEDO, EMITTED, diffuse, inside, material, mirror, room


@pytest.mark.parametrize("seen_through", ["mirror", "glass"])
def test_light_samples_smooth_what_mirrors_and_glass_show(seen_through):
    """A wall under a sky is lit by chance: all light samples of the mirror's points go there, not one.  Noise falls as
    n^-.5, to a quarter; half of that is asked for."""

    def noise(light_samples):
        snapshot = s.orthographic((24, 24), bounces=4, samples=1, light_samples=light_samples)
        s.constant_world(snapshot, 1.0)
        snapshot["world"]["lights_scene"] = True
        if seen_through == "mirror":
            s.quad(snapshot, s.rectangle(-20, -20, 44, 44, 20.0), mirror(snapshot))
        else:
            nodes = [{"type": "ShaderNodeBsdfRefraction", "inputs": {"Roughness": 0.0, "IOR": 1.0}}]
            pane = material(snapshot, nodes, (0, "BSDF"))
            s.quad(snapshot, s.rectangle(-20, -20, 44, 44, 20.0), pane)
        wall = -60.0 if seen_through == "mirror" else 60.0
        s.quad(snapshot, s.rectangle(-50, -50, 74, 74, wall), diffuse(snapshot, 0.9))
        # What hides half of the sky from the wall.
        s.quad(snapshot, s.rectangle(-200, 30, 224, 80, wall / 2), diffuse(snapshot, 0.0))
        seen = s.render(snapshot)["combined"][4:-4, 4:-4, 0]
        return seen.std() / seen.mean()

    assert noise(16) < 0.5 * noise(1)


def test_what_is_sure_stays_so_where_a_mirror_shows_it():
    """A faint mirror among what may send light anywhere, seen in a mirror, under an even sky: each pixel is the same."""
    snapshot = s.orthographic((24, 24), bounces=4, samples=1, light_samples=16)
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    s.quad(snapshot, s.rectangle(-20, -20, 44, 44, 20.0), mirror(snapshot))
    nodes = [
        {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.0, 0.0, 0.0, 1.0)}},
        {"type": "ShaderNodeBsdfGlossy", "inputs": {"Color": (1.0,) * 4, "Roughness": 0.0}},
        {
            "type": "ShaderNodeMixShader",
            "inputs": {
                "Fac": 0.05,
                "Shader": ("LINK", 0, "BSDF"),
                "Shader_001": ("LINK", 1, "BSDF"),
            },
        },
    ]
    tilted = s.rectangle(-50, -50, 74, 74, -60.0) + np.array(
        [[0, 0, -40], [0, 0, -40], [0, 0, 40], [0, 0, 40]]
    )
    s.quad(snapshot, tilted, material(snapshot, nodes, (2, "Shader")))
    seen = s.render(snapshot)["combined"][4:-4, 4:-4, 0]
    assert seen == pytest.approx(np.full_like(seen, 0.05), rel=1e-4)


@pytest.mark.parametrize("options", [{"bucket_size": 16}, {"threads": 1}, {"light_samples": 16}])
def test_bits_of_what_mirrors_show_do_not_depend_on_buckets_or_threads(options):
    def picture(**more):
        options = {"light_samples": 4, **more} if "light_samples" not in more else more
        snapshot = inside(3, **options)
        room(snapshot, diffuse(snapshot, ALBEDO, EMITTED))
        s.quad(snapshot, s.rectangle(-0.5, -0.5, 0.5, 0.5, 0.8), mirror(snapshot))
        return s.render(snapshot)["combined"]

    same = np.array_equal(picture(**options), picture())
    assert same == ("light_samples" not in options)
