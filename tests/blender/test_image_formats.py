# SPDX-License-Identifier: GPL-3.0-or-later
"""Image files of each format that artists have, against Cycles: whoever reads them, Granita or Blender for it."""

import bpy
import numpy as np
import pytest
from node_comparison import check
from test_nodes_textures import smooth_image, textured

# By Blender's names.  Not DPX and Cineon: Granita shows Blender's pixels (test_images.py), Cycles takes logarithms for light.
WRITTEN = {
    "PNG": "png",
    "JPEG": "jpg",
    "TIFF": "tif",
    "OPEN_EXR": "exr",
    "HDR": "hdr",
    "TARGA": "tga",
    "TARGA_RAW": "tga",
    "BMP": "bmp",
    "WEBP": "webp",
    "JPEG2000": "jp2",
    "IRIS": "rgb",
}


def bytes_of(image):
    """[height, width, 3] of 0 to 255, the lowest row first."""
    values = np.float32(image.pixels[:]).reshape(image.size[1], image.size[0], 4)
    return np.rint(np.clip(values[..., :3], 0, 1) * 255).astype(np.uint8)


def as_ppm(image):
    width, height = image.size
    return b"P6 %d %d 255\n" % (width, height) + bytes_of(image)[::-1].tobytes()


def as_dds(image):
    """Uncompressed, 32 bits a pixel."""
    width, height = image.size
    words = np.zeros(31, "<u4")
    words[:7] = 124, 0x100F, height, width, 4 * width, 0, 0
    words[18:26] = 32, 0x41, 0, 32, 0xFF0000, 0xFF00, 0xFF, 0xFF000000
    words[26] = 0x1000
    pixels = np.full((height, width, 4), 255, np.uint8)
    pixels[..., :3] = bytes_of(image)[::-1, :, ::-1]
    return b"DDS " + words.tobytes() + pixels.tobytes()


def shown(scene, path):
    image = bpy.data.images.load(str(path))
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    return image


@pytest.mark.parametrize("kind", WRITTEN)
def test_formats_that_blender_writes(scene, render, tmp_path, capfd, kind):
    if kind == "IRIS" and bpy.app.version < (4, 2):
        pytest.skip("Blender does not read what it writes")
    settings = scene.render.image_settings
    try:
        settings.file_format = kind
    except TypeError:
        pytest.skip("this Blender does not write it")
    settings.color_mode = "RGB"
    path = tmp_path / f"Image.{WRITTEN[kind]}"
    smooth_image("Made", size=64).save_render(str(path), scene=scene)
    settings.file_format = "OPEN_EXR"
    shown(scene, path)
    check(scene, render, 16)
    assert "image" not in capfd.readouterr().out


@pytest.mark.parametrize("kind", ["ppm", "dds"])
def test_formats_that_blender_only_reads(scene, render, tmp_path, capfd, kind):
    path = tmp_path / f"Image.{kind}"
    path.write_bytes({"ppm": as_ppm, "dds": as_dds}[kind](smooth_image("Made", size=64)))
    shown(scene, path)
    check(scene, render, 16)
    assert "image" not in capfd.readouterr().out
