# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as they come from Blender: colour spaces against Cycles, what is copied, and what is said of movies."""

import os

import bpy
import numpy as np
import pytest
from node_comparison import Tree, board, check
from test_nodes_textures import saved_image, smooth_image, textured

SAMPLES = 64


def exported(scene):
    from granita.export import export_frame

    warnings = []
    snapshot = export_frame(
        None,
        bpy.context.evaluated_depsgraph_get(),
        scene.granita,
        lambda *said: warnings.append(said),
    )
    return snapshot["images"], warnings


def spaces(image):
    names = image.colorspace_settings.bl_rna.properties["name"].enum_items
    return {item.identifier for item in names}


def test_straight_alpha_of_painted_bytes(scene, render):
    tree, node = textured(scene, smooth_image("Image", alpha=True))
    tree.emit(node.outputs["Color"])
    check(scene, render, SAMPLES)


@pytest.mark.parametrize("strip", [1, 40, 1 << 14])  # pixels: a part of a row, some rows, all
def test_every_painted_byte_is_handed_over_as_it_is(scene, monkeypatch, strip):
    from granita.export.shading import image as images

    monkeypatch.setattr(images, "_STRIP", strip)
    record = exported_bytes(scene, every_byte(), "sRGB")
    assert record["colorspace"] == "sRGB" and "pixels" not in record
    assert record["bytes"].dtype == np.uint8
    assert (record["bytes"].reshape(-1, 4) == every_byte()).all()


@pytest.mark.parametrize("kept", ["set", "packed", "file"])
@pytest.mark.parametrize("is_float", [False, True])
@pytest.mark.parametrize("alpha_mode", ["STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"])
@pytest.mark.parametrize(
    "names", [("sRGB",), ("Non-Color",), ("Linear", "Linear Rec.709"), ("Rec.1886",)]
)
def test_colour_beside_alpha(scene, render, tmp_path, names, alpha_mode, is_float, kept):
    """Both at random; data are no colour, that alpha belongs to."""
    image = bpy.data.images.new("Image", 16, 16, alpha=True, float_buffer=is_float)
    space = next((name for name in names if name in spaces(image)), None)
    if space == "Rec.1886" and alpha_mode == "CHANNEL_PACKED" and bpy.app.version < (5, 0):
        pytest.skip("packed channels are divided by alpha")
    if space is None:
        pytest.skip("no such space")
    image.colorspace_settings.name, image.alpha_mode = space, alpha_mode
    values = np.random.default_rng(1).uniform(0.1, 1.0, (256, 4)).astype(np.float32)
    image.pixels.foreach_set(values.ravel())
    image.update()
    if kept == "packed":
        image.pack()
    elif kept == "file":
        suffix, image.file_format = ("exr", "OPEN_EXR") if is_float else ("png", "PNG")
        image.filepath_raw = str(tmp_path / f"Image.{suffix}")
        image.save()
        image = bpy.data.images.load(image.filepath_raw)
        image.colorspace_settings.name, image.alpha_mode = space, alpha_mode
    tree, node = textured(scene, image)
    node.interpolation = "Closest"
    mix = tree.add("ShaderNodeMixRGB")
    tree.link(node.outputs["Color"], mix.inputs["Color1"])
    tree.link(node.outputs["Alpha"], mix.inputs["Color2"])
    tree.emit(mix.outputs["Color"], 2.0)
    # Pixels that hold borders of texels: up to .019 of noise where they hardly vary.  Data divided by alpha: 6.
    check(scene, render, SAMPLES, limit=0.025)


def every_byte():
    """[256, 4], opaque."""
    values = np.repeat(np.arange(256), 4).reshape(-1, 4)
    values[:, 3] = 255
    return values


def exported_bytes(scene, values, space):
    """The record of a painted image of 16 by 16 pixels."""
    image = bpy.data.images.new("Image", 16, 16)
    image.colorspace_settings.name = space
    image.pixels.foreach_set((values / 255).astype(np.float32).ravel())
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    return exported(scene)[0][0]


def test_formats_that_blender_reads_come_as_pixels(scene, tmp_path):
    made = smooth_image("Made")
    path = str(tmp_path / "Image.dpx")
    scene.render.image_settings.file_format = "DPX"
    made.save_render(path, scene=scene)
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    records, warnings = exported(scene)
    assert not warnings
    before = np.float32(image.pixels[:]).reshape(*image.size, 4)
    # Until 4.2 its 10 bits are floats there.
    given = records[0]["pixels"] if image.is_float else records[0]["bytes"] / 255
    assert given == pytest.approx(before, abs=1e-6)


def test_an_image_that_is_a_pipe_is_left_out_by_name(scene, render, tmp_path, capfd, impatient):
    image = saved_image(tmp_path, "Image")
    os.remove(tmp_path / "Image.png")
    os.mkfifo(tmp_path / "Image.png")
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    render(scene)
    said = capfd.readouterr().out
    assert f"image '{image.name}'" in said and "it is no file" in said


def test_a_movie_that_is_a_pipe_is_left_out_by_name(scene, render, tmp_path, capfd, impatient):
    os.mkfifo(tmp_path / "Movie.mp4")
    image = bpy.data.images.new("Movie", 4, 4)
    image.source, image.filepath = "MOVIE", str(tmp_path / "Movie.mp4")
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    render(scene)
    said = capfd.readouterr().out
    assert "image 'Movie'" in said and "it is no file" in said


def test_a_movie_is_reported(scene, tmp_path):
    image = smooth_image("Image")
    tree, node = textured(scene, image)
    image.source = "MOVIE"
    tree.emit(node.outputs["Color"])
    _, warnings = exported(scene)
    assert any(name == f"image '{image.name}'" and "movie" in text for name, text in warnings)


def udim(tmp_path, tiles=(1001, 1002, 1011, 1022), pattern="<UDIM>"):
    """An image of a turned copy of smooth_image() each."""
    for number in tiles:
        tile = smooth_image("Tile")
        pixels = np.float32(tile.pixels[:]).reshape(16, 16, 4)
        turned = np.rot90(pixels, number % 10) * (0.5 if number > 1010 else 1.0)
        tile.pixels.foreach_set(np.ascontiguousarray(turned).ravel())
        u, v = (number - 1001) % 10 + 1, (number - 1001) // 10 + 1
        place = {"<UDIM>": str(number), "<UVTILE>": f"u{u}_v{v}"}[pattern]
        tile.filepath_raw = str(tmp_path / f"Image.{place}.png")
        tile.file_format = "PNG"
        tile.save()
        bpy.data.images.remove(tile)
    first = {"<UDIM>": "1001", "<UVTILE>": "u1_v1"}[pattern]
    image = bpy.data.images.load(str(tmp_path / f"Image.{first}.png"))
    image.source = "TILED"
    image.filepath = str(tmp_path / f"Image.{pattern}.png")
    known = {tile.number for tile in image.tiles}
    for number in tiles:
        if number not in known:
            image.tiles.new(number)
    return image


@pytest.mark.parametrize("pattern", ["<UDIM>", "<UVTILE>"])
@pytest.mark.parametrize("projection", ["FLAT", "BOX", "SPHERE"])
def test_tiles(scene, render, tmp_path, projection, pattern):
    """A place a square, before the first tile, in one each, and where there is none."""
    image = udim(tmp_path, pattern=pattern)
    tree, node = textured(scene, image, projection=projection, interpolation="Closest")
    place = tree.add("ShaderNodeVectorMath", operation="MULTIPLY_ADD")
    tree.link(tree.attribute("A", "Vector"), place.inputs[0])
    place.inputs[1].default_value = (3.2, 3.2, 3.2)
    place.inputs[2].default_value = (-0.6, -0.6, -0.6)
    tree.link(place.outputs[0], node.inputs["Vector"])
    tree.emit(node.outputs["Color"])
    check(scene, render)
    assert not exported(scene)[1]


def test_tiles_that_are_packed(scene, render, tmp_path):
    image = udim(tmp_path)
    image.pack()
    for file in tmp_path.iterdir():
        file.unlink()
    tree, node = textured(scene, image)
    place = tree.add("ShaderNodeVectorMath", operation="SCALE")
    tree.link(tree.attribute("A", "Vector"), place.inputs[0])
    place.inputs["Scale"].default_value = 2.0
    tree.link(place.outputs[0], node.inputs["Vector"])
    tree.emit(node.outputs["Color"])
    check(scene, render)


@pytest.mark.parametrize("name", ["Tiled 1001", "Tiled/1001", "Tiled/"])
@pytest.mark.parametrize("is_first", [True, False])
def test_no_image_takes_the_name_of_anothers_tile(scene, render, tmp_path, name, is_first):
    tiled, plain = udim(tmp_path), smooth_image("Other")
    tiled.name, plain.name = "Tiled", name
    tree, node = textured(scene, tiled)
    other = tree.add("ShaderNodeTexImage", image=plain)
    for shown in (node, other):
        shown.interpolation = "Closest"
        tree.link(tree.attribute("A", "Vector"), shown.inputs["Vector"])
    mix = tree.add("ShaderNodeMixRGB", blend_type="DIFFERENCE")
    mix.inputs["Fac"].default_value = 1.0
    order = (other, node) if is_first else (node, other)
    for socket, shown in zip(mix.inputs[1:], order, strict=True):
        tree.link(shown.outputs["Color"], socket)
    tree.emit(mix.outputs["Color"])
    check(scene, render)


def test_tiles_of_an_environment_are_named(scene, tmp_path):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeTexEnvironment", image=udim(tmp_path))
    tree.emit(node.outputs["Color"])
    assert any("only its tile 1001" in text for _, text in exported(scene)[1])


def test_packed_bytes_are_looked_at_once_a_job(scene, tmp_path, monkeypatch):
    from granita.export.shading import image as images

    image = saved_image(tmp_path, "Image")
    image.pack()
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    hashed = []
    sha1 = images.hashlib.sha1
    monkeypatch.setattr(images.hashlib, "sha1", lambda data: hashed.append(len(data)) or sha1(data))
    images.forget_images()
    first, _ = exported(scene)
    again, _ = exported(scene)
    assert first[0]["path"] == again[0]["path"] and len(hashed) == 1
    images.forget_images()
    exported(scene)
    assert len(hashed) == 2


def test_another_packed_file_is_seen(scene, tmp_path):
    image = saved_image(tmp_path, "Image")
    image.pack()
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    before, _ = exported(scene)
    saved_image(tmp_path, "Other", size=32)
    data = (tmp_path / "Other.png").read_bytes()
    image.pack(data=data, data_len=len(data))
    after, _ = exported(scene)
    assert before[0]["path"] != after[0]["path"]


def test_generated_pixels_are_read_once_and_painted_ones_each_time(scene):
    from granita.export.shading import image as images

    images.forget_images()
    image = bpy.data.images.new("Image", 8, 8)
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    first, _ = exported(scene)
    again, _ = exported(scene)
    assert first[0]["bytes"] is again[0]["bytes"]
    image.generated_color = (1, 0, 0, 1)
    assert exported(scene)[0][0]["bytes"][0, 0].tolist() == [255, 0, 0, 255]
    image.pixels.foreach_set(np.ones(8 * 8 * 4, dtype=np.float32))
    assert exported(scene)[0][0]["bytes"][0, 0].tolist() == [255, 255, 255, 255]
    image.pixels.foreach_set(np.zeros(8 * 8 * 4, dtype=np.float32))
    assert exported(scene)[0][0]["bytes"][0, 0].tolist() == [0, 0, 0, 0]
