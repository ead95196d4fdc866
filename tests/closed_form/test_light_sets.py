# SPDX-License-Identifier: GPL-3.0-or-later
"""Linked lights: whom they light, and who casts their shadows."""

import numpy as np
import pytest
import snapshots as s

SUN = 3.0
RADIANCE = 0.8 * SUN / np.pi  # of the floor, where the sun stands straight above it


def stage(transparent=False, **light):
    """Two halves of a floor (instances 0, 1) under one sheet before the middle of both (2; no ray meets its diagonal), lit by a sun; the camera
    looks at the floor from above and does not see the sheet."""
    snapshot = s.orthographic(
        (32, 16), executor="SIMD", samples=16, pixel_filter="BOX", filter_width=1.0
    )
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.8, 0.8, 1)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    nodes = [{"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (0.25, 0.5, 0.75, 1)}}]
    snapshot["materials"].append({"name": "Glass", "nodes": nodes, "surface": (0, "BSDF")})
    s.quad(snapshot, s.rectangle(0, 0, 16, 16, 20.0), 0)
    s.quad(snapshot, s.rectangle(16, 0, 32, 16, 20.0), 0)
    s.quad(snapshot, s.rectangle(7.9, -8.3, 24.2, 24.7, 10.0), 1 if transparent else 0)
    snapshot["instances"]["flags"] = [3, 3, 2]
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    sun = {"name": "Sun", "kind": "SUN", "world_from_light": down[None], "energy": SUN}
    snapshot["lights"] = [{**sun, **light}]
    return snapshot


def quarters(snapshot):
    """[4, 3]: the means of the picture's quarters, left to right, without a pixel at each end."""
    image = s.render(snapshot)["combined"][2:-2, :, :3]
    return np.array([image[:, 8 * i + 1 : 8 * i + 7].mean(axis=(0, 1)) for i in range(4)])


LIT, DARK = np.full(3, RADIANCE), np.zeros(3)
TINT = RADIANCE * np.array([0.25, 0.5, 0.75])


def test_without_sets_all_are_lit_and_shadowed():
    np.testing.assert_allclose(quarters(stage()), [LIT, DARK, DARK, LIT], atol=1e-5)


@pytest.mark.parametrize("bit", [0, 63])
def test_a_light_lights_its_receivers_alone(bit):
    snapshot = stage(receiver_set=bit)
    snapshot["instances"]["receives"] = [1 << bit, 0, 0]
    np.testing.assert_allclose(quarters(snapshot), [LIT, DARK, DARK, DARK], atol=1e-5)


def test_another_lights_set_is_another_bit():
    snapshot = stage(receiver_set=3)
    snapshot["instances"]["receives"] = [~(1 << 3), 1 << 3, 0]
    np.testing.assert_allclose(quarters(snapshot), [DARK, DARK, DARK, LIT], atol=1e-5)


def test_others_than_its_blockers_cast_no_shadow_of_a_light():
    snapshot = stage(blocker_set=5)
    snapshot["instances"]["blocks"] = [1 << 5, 1 << 5, 0]
    np.testing.assert_allclose(quarters(snapshot), [LIT, LIT, LIT, LIT], atol=1e-5)


@pytest.mark.parametrize("blocks, middle", [(0, LIT), (1, TINT)])
def test_transparent_blockers_tint_or_are_not_there(blocks, middle):
    snapshot = stage(transparent=True, blocker_set=0)
    snapshot["instances"]["blocks"] = [1, 1, blocks]
    np.testing.assert_allclose(quarters(snapshot), [LIT, middle, middle, LIT], atol=1e-5)


def test_a_light_without_set_is_shadowed_by_all():
    snapshot = stage(blocker_set=0)
    snapshot["instances"]["blocks"] = [1, 1, 0]
    snapshot["lights"].append({**snapshot["lights"][0], "name": "Other", "blocker_set": -1})
    np.testing.assert_allclose(quarters(snapshot), [2 * LIT, LIT, LIT, 2 * LIT], atol=1e-5)


def test_a_set_that_no_mask_can_hold_is_refused():
    with pytest.raises(Exception, match="Sun.*receiver_set"):
        s.render(stage(receiver_set=64))
