# SPDX-License-Identifier: GPL-3.0-or-later
"""What must work in every Blender: load, render, one closed form, border, error."""

import bpy
import numpy as np
import pytest
import scene_parts as parts

pytestmark = pytest.mark.smoke


@pytest.fixture
def half(scene):
    """An emissive square over the left half of an orthographic frame, black outside."""
    parts.add_camera(scene, ortho_scale=4.0)  # 64 pixels are 4 metres
    parts.add_square(
        scene,
        size=4.0,
        location=(-2.0, 0.0, 0.0),
        material=parts.emission("Glow", (0.25, 0.5, 0.75), 2.0),
    )
    scene.granita.pixel_filter = "BOX"
    scene.granita.filter_width = 1.0
    return scene


def test_registers():
    engine = bpy.types.RenderEngine.bl_rna_get_subclass_py("GRANITA")
    assert engine.bl_label == "Granita"
    assert bpy.context.scene.granita.samples == 64


def test_half_covered_frame(half, render):
    pixels = render(half)
    # The edge lies on a border of pixels: a box filter of one pixel sees all or nothing.
    expected = np.zeros((48, 64), np.float32)
    expected[:, :32] = 1.0
    for channel, value in zip("RGBA", (0.5, 1.0, 1.5, None), strict=True):
        plane = pixels[f"ViewLayer.Combined.{channel}"]
        if value is None:  # opaque everywhere: the film is not transparent
            np.testing.assert_array_equal(plane, 1.0)
        else:
            np.testing.assert_allclose(plane, value * expected, rtol=0, atol=1e-6)


def test_depth_is_in_metres(half, render):
    half.view_layers[0].use_pass_z = True
    depth = render(half)["ViewLayer.Depth.Z"]
    np.testing.assert_allclose(depth[:, :32], 5.0, rtol=1e-5)
    assert (depth[:, 32:] == np.float32(1e10)).all()


def test_border_holds_the_frames_pixels(half, render):
    full = render(half, "full")["ViewLayer.Combined.R"]
    half.render.use_border = half.render.use_crop_to_border = True
    half.render.border_min_x, half.render.border_max_x = 0.3, 0.72
    half.render.border_min_y, half.render.border_max_y = 0.25, 0.9
    cropped = render(half, "cropped")["ViewLayer.Combined.R"]
    np.testing.assert_array_equal(cropped, full[12:43, 19:46])


def test_failure_is_an_exception_of_the_operator(half, render):
    half.camera.data.type = "PANO"
    with pytest.raises(RuntimeError, match="Camera"):
        render(half)
