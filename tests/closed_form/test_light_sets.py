# SPDX-License-Identifier: GPL-3.0-or-later
"""Linked lights: whom they light, and who casts their shadows."""

import numpy as np
import pytest
import snapshots as s
from test_volumes import absorption, box, filled, lamp, scatter, world_of

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


def glowing(sheet_shadows=True, **sets):
    """The same under a mesh that shines (3) instead of the sun."""
    snapshot = stage()
    snapshot["lights"] = []
    s.quad(snapshot, s.rectangle(6, 4, 26, 12, 2.0), s.emission(snapshot, (3.0,) * 3))
    snapshot["instances"]["flags"] = [3, 3, 2 if sheet_shadows else 0, 8]
    snapshot["instances"] |= {name: [-1, -1, -1, bit] for name, bit in sets.items()}
    return snapshot


def picture(snapshot):
    return s.render(snapshot)["combined"][..., :3]


@pytest.mark.parametrize("bit", [0, 63])
def test_a_mesh_that_shines_lights_its_receivers_alone(bit):
    everywhere = picture(glowing())
    assert everywhere[:, 17:].mean() > 0.02
    snapshot = glowing(receiver_set=bit)
    snapshot["instances"]["receives"] = [1 << bit, 0, 0, 0]
    image = picture(snapshot)
    # A pixel on the seam is of both halves.
    np.testing.assert_array_equal(image[:, :15], everywhere[:, :15])
    np.testing.assert_array_equal(image[:, 17:], 0.0)


def test_others_than_its_blockers_cast_no_shadow_of_a_mesh_that_shines():
    snapshot = glowing(blocker_set=1)
    snapshot["instances"]["blocks"] = [2, 2, 0, 0]
    open_sky = picture(glowing(sheet_shadows=False))
    # Rays ask one by one or many at once, where corners of triangles may be met or missed.
    np.testing.assert_allclose(picture(snapshot), open_sky, rtol=1e-4)
    assert open_sky.mean() > 1.2 * picture(glowing()).mean()


@pytest.mark.parametrize("lit", [0, 1])
def test_what_fills_things_is_lit_by_its_own_mask(lit):
    def smoke(**light):
        snapshot = stage(**light)
        box(snapshot, (4, 4, 4), (12, 12, 8), filled(snapshot, scatter(0.1)))
        snapshot["instances"]["flags"].append(3)
        return snapshot

    linked = smoke(receiver_set=0)
    linked["instances"] |= {"receives": [0, 0, 0, lit], "receives_in_volumes": 1 - lit}
    image = picture(linked)
    assert (image[6:10, 6:10] > 0).all() == bool(lit)
    np.testing.assert_array_equal(image[:, 20:], 0.0)
    dark = smoke()
    dark["materials"][0]["nodes"][0]["inputs"]["Color"] = (0.0, 0.0, 0.0, 1.0)
    if lit:
        np.testing.assert_allclose(image[6:10, 6:10], picture(dark)[6:10, 6:10], rtol=1e-4)


@pytest.mark.parametrize("lit", [0, 1])
def test_what_fills_the_world_is_lit_by_a_mask_of_its_own(lit):
    """A lamp in what fills all, above a floor that it does not light."""
    foggy = stage()
    foggy["lights"] = []
    lamp(foggy, (4.0, 8.0, 5.0), receiver_set=0)
    world_of(foggy, scatter(0.05), background=0.0)
    foggy["instances"] |= {"receives": [0, 0, 0], "receives_in_volumes": lit}
    image = picture(foggy)
    # The sheet hides the lamp from what is behind it.
    assert (image[:, :6] > 0).all() == bool(lit)
    assert lit or (image == 0).all()


def test_things_that_overlap_are_lit_each_by_its_own_mask():
    """Two of half the density in one place, one of them linked: half the light that both would scatter."""

    def smoke(receives):
        snapshot = stage(receiver_set=0)
        for _ in range(2):
            box(snapshot, (4, 4, 4), (12, 12, 8), filled(snapshot, scatter(0.1)))
        snapshot["instances"]["flags"] += [3, 3]
        snapshot["instances"]["receives"] = [0, 0, 0, *receives]
        return picture(snapshot)[6:10, 6:10].mean()

    assert smoke([1, 0]) == pytest.approx(smoke([1, 1]) / 2, rel=0.03)


@pytest.mark.parametrize("blocks", [0, 1])
def test_what_fills_things_dims_lights_that_it_blocks(blocks):
    """A slab 5 deep above the left half of the floor, of which 0.2 a metre are lost."""
    snapshot = stage(blocker_set=0)
    box(snapshot, (-2, -2, 12), (16, 18, 17), filled(snapshot, absorption(0.2)))
    snapshot["instances"]["flags"] = [3, 3, 0, 2]
    snapshot["instances"]["blocks"] = [1, 1, 1, blocks]
    dim = LIT * np.exp(-0.2 * 5) if blocks else LIT
    np.testing.assert_allclose(quarters(snapshot), [dim, dim, LIT, LIT], rtol=1e-4)


@pytest.mark.parametrize("name", ["receiver_set", "blocker_set"])
def test_a_set_of_a_mesh_that_no_mask_can_hold_is_refused(name):
    with pytest.raises(Exception, match=f"'{name}'"):
        s.render(glowing(**{name: 64}))


def test_a_set_that_no_mask_can_hold_is_refused():
    with pytest.raises(Exception, match="Sun.*receiver_set"):
        s.render(stage(receiver_set=64))
