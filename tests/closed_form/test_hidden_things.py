# SPDX-License-Identifier: GPL-3.0-or-later
"""What is hidden from rays of one kind: whatever goes through a surface is transmitted, and nothing else."""

import pytest
import snapshots as s
from test_bounces import diffuse, mean, mirror, reflecting
from test_bounces_hard_cases import white_world

FROM = {"diffuse": 8, "glossy": 16, "transmission": 32}
CAMERA = 1
EVERY_RAY = CAMERA | 2 | sum(FROM.values()) | 64


def before(snapshot, front):
    """Material of what is seen of a black wall far behind it."""
    if front == "mirror":
        return mirror(snapshot)
    if front == "diffuse":
        return diffuse(snapshot, 1.0)
    if front == "translucent":
        return reflecting(snapshot, "Translucent", 1.0)
    return reflecting(snapshot, "Refraction", 1.0, Roughness=float(front), IOR=1.2)


SENT_AS = {
    "diffuse": "diffuse",
    "mirror": "glossy",
    "translucent": "transmission",
    "0": "transmission",
    ".4": "transmission",
}


@pytest.mark.parametrize("hidden", [None, *FROM])
@pytest.mark.parametrize("front", SENT_AS)
def test_rays_pass_what_is_hidden_from_their_kind(front, hidden):
    """White world, and a black wall over the half that the surface sends light on from, without light itself."""
    snapshot = s.orthographic((16, 16), bounces=4, samples=16, light_samples=64)
    white_world(snapshot)
    s.quad(snapshot, s.rectangle(-90, -90, 106, 106, 100.0), before(snapshot, front))
    behind = 101.0 if SENT_AS[front] == "transmission" else -1.0
    black = diffuse(snapshot, 0.0)
    s.quad(snapshot, s.rectangle(-9e4, -9e4, 9e4, 9e4, behind), black)
    snapshot["instances"]["flags"] = [EVERY_RAY, EVERY_RAY & ~(CAMERA | FROM.get(hidden, 0))]
    assert mean(snapshot) == pytest.approx(1.0 if hidden == SENT_AS[front] else 0.0, abs=0.02)
