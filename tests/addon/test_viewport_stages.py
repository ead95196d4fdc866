# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D view makes first, and how its own projection is read."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest
from export.scene.camera import window_projection
from viewport.live_picture import LivePicture, coarse_crop
from viewport.same import is_same
from viewport.stages import Stage, next_divisor


def snapshot():
    return {
        "options": {
            "width": 101,
            "height": 64,
            "crop": np.array([3, 0, 101, 33], dtype=np.int32),
            "samples": 64,
            "light_samples": 16,
        },
        "camera": {"scale": (200.0, 100.0), "center": (50.5, 32.0)},
        "geometries": [object()],
    }


def test_the_last_stage_is_the_snapshot_itself():
    whole = snapshot()
    assert Stage(1).snapshot(whole) is whole


def test_the_first_stage_shows_the_same_in_fewer_pixels():
    whole = snapshot()
    first = Stage(4).snapshot(whole)
    options = first["options"]
    assert (options["width"], options["height"]) == (26, 16)
    assert options["crop"].tolist() == [0, 0, 26, 9]
    assert (options["samples"], options["light_samples"]) == (4, 2)
    assert options["refine_samples"] is False
    assert first["camera"] == {"scale": (50.0, 25.0), "center": (12.625, 8.0)}
    assert first["geometries"] is whole["geometries"]
    assert whole["options"]["width"] == 101 and whole["camera"]["scale"] == (200.0, 100.0)


def test_coarse_pixels_stand_where_they_belong():
    sight = SimpleNamespace(crop=(3, 1, 9, 4))
    x0, y0, x1, y1 = coarse_crop(sight.crop, 2)
    assert (x0, y0, x1, y1) == (1, 0, 5, 2)
    number = np.arange(y0, y1)[:, None] * 10 + np.arange(x0, x1)
    picture = LivePicture()
    picture.replace(sight, np.repeat(number[..., None], 4, axis=2).astype(np.float32), 2)
    expected = np.arange(1, 4)[:, None] // 2 * 10 + np.arange(3, 9) // 2
    np.testing.assert_array_equal(picture.pixels[..., 0], expected)
    picture.paste(4, 2, np.full((1, 2, 4), 99, dtype=np.float32))
    expected[1, 1:3] = 99
    np.testing.assert_array_equal(picture.pixels[..., 3], expected)


def test_pixels_go_to_the_window_once_and_when_they_have_changed(monkeypatch):
    sent = []
    gpu = SimpleNamespace(
        types=SimpleNamespace(
            Buffer=lambda kind, count, pixels: sent.append(pixels[0]),
            GPUTexture=lambda size, format, data: object(),
        ),
        state=SimpleNamespace(blend_set=lambda mode: None),
    )
    presets = SimpleNamespace(draw_texture_2d=lambda *place: None)
    monkeypatch.setitem(sys.modules, "gpu", gpu)
    monkeypatch.setitem(sys.modules, "gpu_extras", SimpleNamespace(presets=presets))
    monkeypatch.setitem(sys.modules, "gpu_extras.presets", presets)
    picture = LivePicture()

    def shown():
        picture.prepare()
        picture.draw()
        return sent

    assert shown() == []
    sight = SimpleNamespace(crop=(0, 0, 2, 1), place=(0, 0), pixel=1)
    picture.replace(sight, np.full((1, 2, 4), 1, dtype=np.float32))
    assert shown() == [1]
    assert shown() == [1]
    picture.paste(0, 0, np.full((1, 1, 4), 2, dtype=np.float32))
    picture.draw()
    assert sent == [1]  # not ready yet
    assert shown() == [1, 2]
    assert picture.expose(3.0)
    assert shown() == [1, 2, 6]
    assert not picture.expose(3.0)
    assert shown() == [1, 2, 6]


def test_the_first_picture_becomes_smaller_where_it_is_slow():
    assert [next_divisor(d, 1.0) for d in (2, 4, 8)] == [4, 8, 8]
    assert [next_divisor(d, 0.001) for d in (8, 4, 2)] == [4, 2, 2]
    assert next_divisor(4, 0.08) == 4
    assert next_divisor(4, 0.001, is_anew=False) == 4


@pytest.mark.parametrize("other", ["camera", "crop"])
def test_equal_snapshots_are_the_same_frame(other):
    assert is_same(snapshot()["options"], snapshot()["options"])
    changed = snapshot()
    if other == "camera":
        changed["camera"]["center"] = (50.0, 32.0)
    else:
        changed["options"]["crop"][0] += 1
    changed["geometries"] = same = [1]
    assert not is_same({**snapshot(), "geometries": same}, changed)


def test_what_is_no_number_is_the_same_as_itself():
    assert is_same({"a": np.array([np.nan])}, {"a": np.array([np.nan])})
    assert not is_same(np.zeros(2, dtype=np.float32), np.zeros(2, dtype=np.float64))


def test_a_window_shows_points_where_opengl_puts_them():
    """A frustum from l to r and b to t at n, as glFrustum defines it."""
    left, right, bottom, top, near, far = -0.3, 0.5, -0.2, 0.6, 0.1, 100.0
    frustum = np.array(
        [
            [2 * near / (right - left), 0, (right + left) / (right - left), 0],
            [0, 2 * near / (top - bottom), (top + bottom) / (top - bottom), 0],
            [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)],
            [0, 0, -1, 0],
        ]
    )
    scale, center, is_perspective = window_projection(frustum, 80, 40)
    assert is_perspective
    for x, y, pixel in ((left, bottom, (0, 0)), (right, top, (80, 40)), (0.1, 0.2, (40, 20))):
        seen = [
            center[0] + scale[0] * x / near,
            center[1] + scale[1] * y / near,
        ]
        np.testing.assert_allclose(seen, pixel, atol=1e-9)
    ortho = np.array(
        [
            [2 / (right - left), 0, 0, -(right + left) / (right - left)],
            [0, 2 / (top - bottom), 0, -(top + bottom) / (top - bottom)],
            [0, 0, -2 / (far - near), -(far + near) / (far - near)],
            [0, 0, 0, 1],
        ]
    )
    scale, center, is_perspective = window_projection(ortho, 80, 40)
    assert not is_perspective
    for x, y, pixel in ((left, bottom, (0, 0)), (right, top, (80, 40))):
        np.testing.assert_allclose(np.multiply(scale, (x, y)) + center, pixel, atol=1e-9)
