# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours as Blender's configuration of OpenColorIO has them, against Cycles: every space that an image can be said to be
in, and every working space."""

import os

import bpy
import numpy as np
import pytest
from node_comparison import Tree, board, combined, render_both, rmse
from scene_parts import add_object, set_world
from test_images import exported, spaces
from test_nodes_textures import saved_image, smooth_image, textured

SAMPLES = 64
# Of how much a picture varies; half of it is Cycles' noise.
LIMIT = 0.004
# Of colours that no screen shows, which are most of a cube.
LIMIT_OF_A_CUBE = 0.03
# Pictures of view transforms are not known without OpenColorIO's module.
UNKNOWN = ("AgX", "Filmic sRGB", "Khronos", "False Color", "ACEScc")
# Of a studio's configuration (./dev runs these tests with one too) there is one.
STUDIOS = "the configuration's"
if "OCIO" in os.environ:
    WORKING_SPACES = [STUDIOS]
else:
    WORKING_SPACES = ["ACEScg", "Linear Rec.2020"] if bpy.app.version >= (5, 0) else []


def float_image(tmp_path, low=0.1, high=0.9):
    made = smooth_image("Made", float_buffer=True)
    pixels = np.array(made.pixels[:]).reshape(-1, 4)
    pixels[:, :3] = low + (pixels[:, :3] - 0.1) * ((high - low) / 0.8)
    made.pixels.foreach_set(pixels.astype(np.float32).ravel())
    made.file_format, made.filepath_raw = "OPEN_EXR", str(tmp_path / "Image.exr")
    made.save()
    return bpy.data.images.load(str(tmp_path / "Image.exr"))


def error_of(scene, render):
    """Of how much the picture varies."""
    theirs, ours = render_both(scene, render, SAMPLES)
    assert theirs.std() > 0.03
    return rmse(theirs, ours) / theirs.std()


@pytest.mark.parametrize("numbers", ["bytes", "floats", "below 0 and above 1"])
def test_every_space_of_files(scene, render, tmp_path, numbers):
    from granita.export.shading.color_space import in_color_spaces

    if numbers == "bytes":
        image = saved_image(tmp_path, "Image")
    else:
        image = float_image(tmp_path, *((-0.05, 1.3) if numbers != "floats" else ()))
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    errors, named = {}, []
    for space in sorted(spaces(image)):
        image.colorspace_settings.name = space
        records, warnings = exported(scene)
        if warnings:
            said = f"its colour space '{space}' is read as sRGB"
            assert warnings == [(f"image '{image.name}'", said)]
            named.append(space)
            continue
        described = in_color_spaces([{"name": "Image", "colorspace": space}], print)[1]
        has_cube = any("cube" in record for record in described)
        if has_cube and numbers == "below 0 and above 1":
            continue  # it ends there
        error = error_of(scene, render)
        if error > (LIMIT_OF_A_CUBE if has_cube else LIMIT):
            errors[space] = error
    assert not errors
    if bpy.app.version >= (4, 5):
        assert not named
    elif STUDIOS not in WORKING_SPACES:
        assert all(name.startswith(UNKNOWN) for name in named)


def test_each_image_of_a_space_that_is_not_known_is_named(scene, tmp_path, monkeypatch):
    """As where Blender has no module of OpenColorIO."""
    from granita.export.shading import color_space

    monkeypatch.setattr(color_space, "_configuration", lambda: None)
    tree = Tree(board(scene))
    mix = tree.add("ShaderNodeMixRGB")
    images = [saved_image(tmp_path, name) for name in ("One", "Two")]
    for image, name in zip(images, ("Color1", "Color2")):
        image.colorspace_settings.name = next(s for s in spaces(image) if s.startswith(UNKNOWN))
        node = tree.add("ShaderNodeTexImage", image=image)
        tree.link(node.outputs["Color"], mix.inputs[name])
    tree.emit(mix.outputs["Color"])
    records, warnings = exported(scene)
    assert sorted(name for name, _ in warnings) == [f"image '{image.name}'" for image in images]
    assert all("is read as sRGB" in said for _, said in warnings)
    if STUDIOS not in WORKING_SPACES:
        assert {record["colorspace"] for record in records} == {"sRGB"}


def test_a_space_that_cannot_be_converted_is_named(scene, tmp_path, monkeypatch):
    from granita.export.shading import color_space

    module = color_space._open_color_io()
    if module is None:
        pytest.skip("this Blender has no module of OpenColorIO")
    broken = module.Config()
    broken.addColorSpace(module.ColorSpace(name="Raw"))
    missing = module.FileTransform(str(tmp_path / "missing.cube"))
    broken.addColorSpace(module.ColorSpace(name="Broken", toReference=missing))
    broken.setRole("scene_linear", "Raw")
    monkeypatch.setattr(color_space, "_configuration", lambda: broken)
    told = []
    found, records = color_space.in_color_spaces(
        [{"name": "Image", "colorspace": "Broken"}], lambda *said: told.append(said)
    )
    assert found[0]["colorspace"] == "scene_linear" and not records
    assert told[0][0] == "image 'Image'" and "missing.cube" in told[0][1]


def painted(float_buffer):
    def of(tree, _path):
        image = smooth_image("Painted", float_buffer=float_buffer)
        return tree.add("ShaderNodeTexImage", image=image).outputs["Color"]

    return of


def of_file(make, *names):
    """`names`: of one space in Blender's configuration and in studios'."""

    def of(tree, path):
        image = make(path)
        image.colorspace_settings.name = next(name for name in names if name in spaces(image))
        return tree.add("ShaderNodeTexImage", image=image).outputs["Color"]

    return of


def number_of(kind, socket, scale, offset):
    """A node that makes a colour of a number."""

    def of(tree, _path):
        scaled = tree.add("ShaderNodeMath", operation="MULTIPLY_ADD")
        scaled.inputs[1].default_value, scaled.inputs[2].default_value = scale, offset
        tree.link(tree.attribute("A"), scaled.inputs[0])
        node = tree.add(kind)
        tree.link(scaled.outputs[0], node.inputs[socket])
        return node.outputs[0]

    return of


def grey_of_colors(tree, _path):
    node = tree.add("ShaderNodeRGBToBW")
    tree.link(tree.attribute("A", "Color"), node.inputs[0])
    return node.outputs[0]


def number_of_colors(tree, _path):
    node = tree.add("ShaderNodeMath", operation="MULTIPLY")
    node.inputs[1].default_value = 1.0
    tree.link(tree.attribute("A", "Color"), node.inputs[0])
    return node.outputs[0]


def sky(kind):
    def of(tree, _path):
        node = tree.add("ShaderNodeTexSky", sky_type=kind)
        scaled = tree.add("ShaderNodeVectorMath", operation="SCALE")
        scaled.inputs["Scale"].default_value = 0.3
        up = tree.add("ShaderNodeVectorMath", operation="NORMALIZE")
        tree.link(tree.attribute("A"), up.inputs[0])
        if "Vector" in node.inputs:  # else of Generated, over the board
            tree.link(up.outputs[0], node.inputs["Vector"])
        tree.link(node.outputs["Color"], scaled.inputs[0])
        return scaled.outputs[0]

    return of


def bytes_of_corners(tree, _path):
    mesh = bpy.context.scene.objects["Board"].data
    colors = mesh.color_attributes.new("Bytes", "BYTE_COLOR", "CORNER")
    values = np.random.default_rng(3).random((len(colors.data) // 4, 4)).repeat(4, axis=0)
    values[:, 3] = 1.0
    colors.data.foreach_set("color", values.astype(np.float32).ravel())
    return tree.attribute("Bytes", "Color")


SOURCES = {
    "painted bytes": painted(False),
    "painted floats": painted(True),
    "bytes": of_file(lambda path: saved_image(path, "Image"), "sRGB", "sRGB - Texture"),
    "linear bytes": of_file(
        lambda path: saved_image(path, "Image"), "Linear Rec.709", "Linear Rec.709 (sRGB)"
    ),
    "floats": of_file(float_image, "ACEScg"),
    "data": of_file(float_image, "Non-Color", "Raw"),
    "Blackbody": number_of("ShaderNodeBlackbody", "Temperature", 2000.0, 4000.0),
    "embers": number_of("ShaderNodeBlackbody", "Temperature", 700.0, 850.0),
    "Wavelength": number_of("ShaderNodeWavelength", "Wavelength", 230.0, 390.0),
    "RGB to BW": grey_of_colors,
    "a number": number_of_colors,
    "Preetham": sky("PREETHAM"),
    "a sky": sky("SINGLE_SCATTERING" if bpy.app.version >= (5, 0) else "NISHITA"),
    "byte attribute": bytes_of_corners,
}


def work_in(space):
    if space != STUDIOS:
        bpy.ops.wm.set_working_color_space(working_space=space)


@pytest.mark.smoke
@pytest.mark.parametrize("space", WORKING_SPACES)
@pytest.mark.parametrize("source", SOURCES.values(), ids=SOURCES.keys())
def test_working_spaces(scene, render, tmp_path, space, source):
    work_in(space)
    tree = Tree(board(scene, low=0.0))
    tree.emit(source(tree, tmp_path))
    assert error_of(scene, render) < LIMIT


@pytest.mark.smoke
@pytest.mark.parametrize("space", WORKING_SPACES)
def test_a_film_in_a_working_space(scene, render, space):
    work_in(space)
    tree = Tree(board(scene, low=0.0, tilt=0.4))
    film = tree.add("ShaderNodeMath", operation="MULTIPLY_ADD")
    film.inputs[1].default_value, film.inputs[2].default_value = 400.0, 150.0
    tree.link(tree.attribute("B"), film.inputs[0])
    shader = tree.add("ShaderNodeBsdfPrincipled")
    shader.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    shader.inputs["IOR"].default_value, shader.inputs["Roughness"].default_value = 2.2, 0.6
    tree.link(film.outputs[0], shader.inputs["Thin Film Thickness"])
    tree.link(shader.outputs[0], tree.output.inputs["Surface"])
    set_world(scene, (0.0, 0.0, 0.0))
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 9.0, 0.0
    if bpy.app.version >= (4, 5):
        sun.use_temperature, sun.temperature = True, 3000.0
    add_object(scene, "Sun", sun)
    assert error_of(scene, render) < 0.01


@pytest.mark.parametrize("space", [s for s in WORKING_SPACES if s != STUDIOS])
def test_what_is_kept_between_frames_follows_the_working_space(scene, render, tmp_path, space):
    tree = Tree(board(scene, low=0.0))
    mix = tree.add("ShaderNodeMixRGB")
    tree.link(bytes_of_corners(tree, tmp_path), mix.inputs["Color1"])
    # Blender changes no space while an image is painted on.
    image = bpy.data.images.new("Grid", 64, 64, float_buffer=True)
    image.generated_type = "COLOR_GRID"
    grid = tree.add("ShaderNodeTexImage", image=image)
    tree.link(grid.outputs["Color"], mix.inputs["Color2"])
    tree.emit(mix.outputs["Color"])
    scene.granita.samples = 1
    scene.render.use_persistent_data = True

    def picture():
        return combined(render(scene))

    before = picture()
    work_in(space)
    kept = picture()
    scene.render.use_persistent_data = False
    assert np.abs(kept - before).max() > 0.05
    np.testing.assert_array_equal(kept, picture())
