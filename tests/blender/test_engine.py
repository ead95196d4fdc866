# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist asked of Blender arrives in Blender's result, bit for bit, on every path."""

import bpy
import exr
import numpy as np
import pytest
import render_host
import scene_parts as parts


def assert_same_bits(a, b):
    assert a.keys() == b.keys()
    for name in a:
        np.testing.assert_array_equal(a[name].view(np.uint32), b[name].view(np.uint32), name)


@pytest.fixture
def busy(scene):
    """Slanted edges, two depths, a moving thing: every pixel of the middle differs."""
    scene.render.resolution_x, scene.render.resolution_y = 101, 67
    scene.view_layers[0].use_pass_z = True
    scene.granita.bucket_size = 32
    parts.add_camera(scene)
    glow = parts.emission("Glow", (0.8, 0.4, 0.1))
    for i in range(5):
        square = parts.add_square(scene, f"Square{i}", 0.7, (i - 2.0, 0.3 * i - 0.6, -i), glow)
        square.rotation_euler = (0.1 * i, 0.2, 0.3 + i)
    moving = parts.add_square(scene, "Moving", 0.8, (0, 0, 1), parts.emission("Blue", (0, 0, 1)))
    for frame, x in ((1, -1.0), (4, 1.0)):
        moving.location.x = x
        moving.keyframe_insert("location", frame=frame)
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.5
    scene.frame_set(2)
    return scene


BORDERS = [
    (0.26, 0.75, 0.25, 0.713),
    (0.0, 0.5, 0.5, 1.0),
    (0.49, 0.51, 0.3, 0.32),
]


@pytest.mark.parametrize("border", BORDERS)
@pytest.mark.parametrize("crop", [False, True])
def test_border_holds_the_frames_bits(busy, render, border, crop):
    full = render(busy, "full")
    r = busy.render
    r.use_border, r.use_crop_to_border = True, crop
    r.border_min_x, r.border_max_x, r.border_min_y, r.border_max_y = border
    part = render(busy, "part")
    # Blender truncates, in single precision.
    x0, x1 = (int(np.float32(v) * np.float32(101)) for v in border[:2])
    y0, y1 = (int(np.float32(v) * np.float32(67)) for v in border[2:])
    if not crop:
        assert part["ViewLayer.Combined.R"].shape == (67, 101)
        part = {name: plane[y0:y1, x0:x1] for name, plane in part.items()}
    assert_same_bits(part, {name: plane[y0:y1, x0:x1] for name, plane in full.items()})


@pytest.mark.parametrize("bucket_size", [16, 50, 128])
def test_buckets_change_no_bit(busy, render, bucket_size):
    reference = render(busy, "reference")
    busy.granita.bucket_size = bucket_size  # 50 is rounded up to whole tiles
    assert_same_bits(render(busy, "other"), reference)


def test_resolution_percentage(busy, render):
    busy.render.resolution_percentage = 50
    assert render(busy)["ViewLayer.Combined.R"].shape == (33, 50)


@pytest.mark.parametrize("border", [False, True])
def test_a_handler_sets_the_resolution_of_the_next_frame(busy, render, border):
    """As in Cycles: the render has its size by then."""
    busy.render.use_border = busy.render.use_crop_to_border = border
    busy.render.border_min_x, busy.render.border_max_x = 0.25, 0.75
    width, height = busy.render.resolution_x, busy.render.resolution_y
    expected = render(busy)

    def halve(scene, _depsgraph=None):
        scene.render.resolution_x, scene.render.resolution_y = width // 2, height // 2

    bpy.app.handlers.render_pre.append(halve)
    try:
        found = render(busy)
    finally:
        bpy.app.handlers.render_pre.remove(halve)
    for name, plane in expected.items():
        np.testing.assert_array_equal(found[name], plane)
    assert render(busy)["ViewLayer.Combined.R"].shape[0] == height // 2


def test_view_layers_have_their_own_pixels(busy, render):
    hidden = bpy.data.collections.new("Hidden")
    busy.collection.children.link(hidden)
    busy.collection.objects.unlink(bpy.data.objects["Moving"])
    hidden.objects.link(bpy.data.objects["Moving"])
    both = render(busy, "both")
    second = busy.view_layers.new("Second")
    second.use_pass_z = False
    second.layer_collection.children["Hidden"].exclude = True
    layers = render(busy, "layers")
    assert "Second.Depth.Z" not in layers
    first = {name: plane for name, plane in layers.items() if name.startswith("ViewLayer.")}
    assert_same_bits(first, both)
    assert layers["ViewLayer.Combined.B"].max() > 0.5
    assert layers["Second.Combined.B"].max() < 0.2
    assert layers["Second.Combined.R"].max() > 0.5


def test_film_transparent(busy, render):
    opaque = render(busy, "opaque")
    busy.render.film_transparent = True
    clear = render(busy, "clear")
    assert (opaque["ViewLayer.Combined.A"] == 1.0).all()
    corner = [clear[f"ViewLayer.Combined.{channel}"][0, 0] for channel in "RGBA"]
    assert corner == [0.0, 0.0, 0.0, 0.0]
    # Premultiplied, before a black world: the colours do not change.
    alpha = clear["ViewLayer.Combined.A"]
    assert 0.0 < alpha[alpha > 0].min() < 0.9 and alpha.max() <= 1.0 + 1e-6
    for channel in "RGB":
        name = f"ViewLayer.Combined.{channel}"
        np.testing.assert_allclose(clear[name], opaque[name], rtol=0, atol=1e-6)


def test_single_frames_animation_and_persistent_data_agree(busy, tmp_path):
    blend = tmp_path / "busy.blend"
    parts.multilayer_exr(busy)
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True)

    def frames(name, first, last, persistent):
        prepare = f"import bpy; bpy.context.scene.render.use_persistent_data = {persistent}"
        outcome = render_host.run(blend, tmp_path / name, prepare, first, last)
        assert outcome.code == 0, outcome.output
        return {path.name: exr.read(path) for path in outcome.files}

    animation = frames("animation", 1, 3, False)
    persistent = frames("persistent", 1, 3, True)
    alone = frames("alone", 2, 2, False) | frames("alone_persistent", 3, 3, True)
    assert list(animation) == ["frame_0001.exr", "frame_0002.exr", "frame_0003.exr"]
    assert animation["frame_0001.exr"]["ViewLayer.Combined.B"].max() > 0.3
    for name, pixels in animation.items():
        assert_same_bits(persistent[name], pixels)
        if name in alone:
            assert_same_bits(alone[name], pixels)


def test_scene_is_left_as_it_was(busy, render):
    busy.frame_set(2)
    matrix = bpy.data.objects["Moving"].matrix_world.copy()
    render(busy)
    assert (busy.frame_current, busy.frame_subframe) == (2, 0.0)
    assert bpy.data.objects["Moving"].matrix_world == matrix
