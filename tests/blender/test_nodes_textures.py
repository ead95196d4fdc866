# SPDX-License-Identifier: GPL-3.0-or-later
"""Images, coordinates and normals against Cycles' own output."""

import bpy
import numpy as np
import pytest
import scene_parts
from mathutils import Matrix
from node_comparison import LIMIT, Tree, board, check, enum_values, render_both, rmse

SAMPLES = 64  # what varies inside a pixel is averaged by both


def smooth_image(name, float_buffer=False, alpha=False, size=16):
    """Low frequencies only: filters of both renderers see the same thing."""
    image = bpy.data.images.new(name, size, size, alpha=alpha, float_buffer=float_buffer)
    y, x = np.mgrid[0:size, 0:size] * (2 * np.pi / size)
    pixels = np.stack([np.sin(x), np.cos(y), np.sin(x + y), np.cos(x - y)], axis=-1) * 0.4 + 0.5
    if not alpha:
        pixels[..., 3] = 1.0
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    image.update()
    return image


def saved_image(tmp_path, name, **options):
    image = smooth_image(name, **options)
    image.filepath_raw = str(tmp_path / f"{name}.png")
    image.file_format = "PNG"
    image.save()
    return bpy.data.images.load(str(tmp_path / f"{name}.png"))


def textured(scene, image, **properties):
    tree = Tree(board(scene))
    return tree, tree.add("ShaderNodeTexImage", image=image, **properties)


@pytest.mark.parametrize("interpolation", ["Linear", "Cubic"])
@pytest.mark.parametrize("source", ["byte", "float", "file", "packed"])
def test_image(scene, render, tmp_path, interpolation, source):
    if source in ("byte", "float"):
        image = smooth_image("Image", float_buffer=source == "float")
    else:
        image = saved_image(tmp_path, "Image")
        if source == "packed":
            image.pack()
    tree, node = textured(scene, image, interpolation=interpolation)
    tree.emit(node.outputs["Color"])
    check(scene, render, SAMPLES)


def test_a_node_without_an_image(scene, render):
    """Glaring, as a file that is missing, and opaque."""
    tree, node = textured(scene, None)
    seen = tree.add("ShaderNodeVectorMath", operation="MULTIPLY")
    for output, target in zip(node.outputs, seen.inputs):
        tree.link(output, target)
    tree.emit(seen.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("extension", ["REPEAT", "EXTEND"])
@pytest.mark.parametrize("mapped", [False, True], ids=["without a map", "along borders of texels"])
def test_closest_texel_on_a_border_is_the_one_above(scene, render, extension, mapped):
    """Where v is not negative: below 0 Cycles rounds away from it."""
    tree = Tree(board(scene, 0.0, 1.5))
    node = tree.add("ShaderNodeTexImage", image=smooth_image("Image"))
    node.interpolation, node.extension = "Closest", extension
    # Without a map all is at (0, 0).
    mesh = bpy.data.objects["Board"].data
    mesh.uv_layers.remove(mesh.uv_layers[0])
    place = tree.add("ShaderNodeCombineXYZ")
    if mapped:
        rounded = tree.add("ShaderNodeMath", operation="SNAP")
        tree.link(tree.attribute("A", "Fac"), rounded.inputs[0])
        rounded.inputs[1].default_value = 1 / 16
        place.inputs[0].default_value = 0.4
        tree.link(rounded.outputs[0], place.inputs[1])
        tree.link(place.outputs[0], node.inputs[0])
    tree.emit(node.outputs["Color"])
    theirs, ours = render_both(scene, render)
    assert theirs.max() > 0.2
    assert rmse(theirs, ours) < LIMIT


def test_tiles_that_were_never_saved(scene, render):
    """The first is shown, as Blender made it.  (Cycles looks for files.)"""
    image = bpy.data.images.new("Tiles", 8, 8, tiled=True, float_buffer=True)
    image.pixels.foreach_set(np.tile(np.float32([0.25, 0.5, 0.75, 1.0]), 64))
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    seen = render(scene)
    middle = [seen[f"ViewLayer.Combined.{c}"][16, 16] for c in "RGB"]
    assert middle == pytest.approx([0.25, 0.5, 0.75], abs=1e-3)


@pytest.mark.parametrize("interpolation", ["Closest", "Linear", "Cubic"])
@pytest.mark.parametrize("extension", enum_values("ShaderNodeTexImage", "extension"))
def test_extension(scene, render, interpolation, extension):
    image = smooth_image("Image")
    tree, node = textured(scene, image, interpolation=interpolation, extension=extension)
    tree.link(tree.attribute("A"), node.inputs[0])
    tree.emit(node.outputs["Color"])
    check(scene, render)


@pytest.mark.parametrize("space", ["sRGB", "Non-Color", "Linear"])
def test_colour_spaces(scene, render, tmp_path, space):
    image = saved_image(tmp_path, "Image")
    names = [i.identifier for i in image.colorspace_settings.bl_rna.properties["name"].enum_items]
    if space not in names and space == "Linear":
        space = "Linear Rec.709"
    image.colorspace_settings.name = space
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    check(scene, render, SAMPLES)


@pytest.mark.parametrize("mode", ["STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"])
@pytest.mark.parametrize("output", ["Color", "Alpha", "both"])
def test_alpha(scene, render, tmp_path, mode, output):
    if mode == "NONE" and output == "Alpha":
        pytest.skip("alpha is 1 everywhere")
    image = saved_image(tmp_path, "Image", alpha=True)
    image.alpha_mode = mode
    tree, node = textured(scene, image)
    if output == "both":
        mix = tree.add("ShaderNodeMixRGB")
        tree.link(node.outputs["Alpha"], mix.inputs[0])
        tree.link(node.outputs["Color"], mix.inputs[2])
        tree.emit(mix.outputs[0])
    else:
        tree.emit(node.outputs[output])
    # Colours that were never multiplied are divided by alphas down to .1, of which a byte's step is 4 %.
    divided = mode == "PREMUL" and output == "both" and bpy.app.version >= (5, 1)
    check(scene, render, SAMPLES, limit=0.02 if divided else LIMIT)


@pytest.mark.parametrize("projection", ["BOX", "SPHERE", "TUBE"])
def test_projection(scene, render, projection):
    tree = Tree(board(scene, tilt=3.0))
    node = tree.add("ShaderNodeTexImage", image=smooth_image("Image"), projection=projection)
    node.projection_blend = 0.4
    tree.link(tree.attribute("A"), node.inputs[0])
    tree.emit(node.outputs["Color"])
    check(scene, render)


@pytest.mark.parametrize(
    "output", ["Generated", "Normal", "UV", "Object", "Camera", "Window", "Reflection"]
)
def test_texture_coordinate(scene, render, output):
    tree = Tree(board(scene, tilt=1.0 if output in ("Normal", "Reflection") else 0.0))
    node = tree.add("ShaderNodeTexCoord")
    tree.emit(node.outputs[output])
    check(scene, render, SAMPLES)


def test_object_coordinate_of_another(scene, render):
    tree = Tree(board(scene))
    empty = bpy.data.objects.new("Empty", None)
    empty.matrix_world = Matrix.Translation((0.3, -0.2, 0.5)) @ Matrix.Rotation(0.7, 4, "Z")
    scene.collection.objects.link(empty)
    node = tree.add("ShaderNodeTexCoord", object=empty)
    tree.emit(node.outputs["Object"])
    check(scene, render, SAMPLES)


@pytest.mark.parametrize("output", ["Position", "Normal", "True Normal", "Incoming", "Backfacing"])
def test_geometry(scene, render, output):
    seen_along = output in ("Position", "Incoming")
    thing = board(scene, tilt=0.0 if seen_along else 1.0, both_sides=not seen_along)
    if seen_along:
        _perspective(scene, thing)
    tree = Tree(thing)
    tree.emit(tree.add("ShaderNodeNewGeometry").outputs[output])
    check(scene, render, SAMPLES if seen_along else 1)


def _perspective(scene, thing):
    scene.camera.data.type = "PERSP"
    scene.camera.data.angle = 0.36
    thing.matrix_world = Matrix.Rotation(0.5, 4, (0.6, 0.64, 0.48)) @ Matrix.Scale(2.0, 4)


def normal_map_conventions():
    has_two = "convention" in bpy.types.ShaderNodeNormalMap.bl_rna.properties
    return enum_values("ShaderNodeNormalMap", "convention") if has_two else ["OPENGL"]


@pytest.mark.parametrize("space", enum_values("ShaderNodeNormalMap", "space"))
@pytest.mark.parametrize("leaning", [False, True])
@pytest.mark.parametrize("convention", normal_map_conventions())
def test_normal_map(scene, render, space, leaning, convention):
    """Blue above 1/2: what points into the surface is bent back, differently in every Blender."""
    thing = board(scene, 0.55, 1, tilt=0.5 * leaning, both_sides=leaning)
    thing.matrix_world = Matrix.Rotation(np.pi / 2, 4, "Z")
    tree = Tree(thing)
    node = tree.add("ShaderNodeNormalMap", space=space, uv_map="UVMap")
    if convention != "OPENGL":
        node.convention = convention
    tree.link(tree.attribute("A", "Color"), node.inputs["Color"])
    tree.link(tree.attribute("B", "Fac"), node.inputs["Strength"])
    tree.emit(node.outputs[0])
    check(scene, render)


def test_color_attribute(scene, render):
    thing = board(scene)
    for name, kind in (("Byte", "BYTE_COLOR"), ("Float", "FLOAT_COLOR")):
        colors = thing.data.color_attributes.new(name, kind, "CORNER")
        values = np.random.default_rng(3).uniform(0, 1, (len(colors.data) // 4, 4))
        colors.data.foreach_set("color", np.repeat(values, 4, axis=0).astype(np.float32).ravel())
    tree = Tree(thing)
    mix = tree.add("ShaderNodeMixRGB")
    for name, target in (("Byte", mix.inputs[1]), ("Float", mix.inputs[2])):
        tree.link(tree.add("ShaderNodeVertexColor", layer_name=name).outputs["Color"], target)
    tree.link(tree.add("ShaderNodeVertexColor", layer_name="Float").outputs["Alpha"], mix.inputs[0])
    tree.emit(mix.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
@pytest.mark.parametrize("kind", ["BYTE_COLOR", "FLOAT_COLOR"])
def test_colors_of_a_cage(scene, render, kind, domain):
    """The Subdivision modifier blends bytes as they are stored: half way from black to white is .21.  It stores bytes
    again, the third of a step away (.0029 of the brightest)."""
    x, y = np.meshgrid(np.linspace(-1, 1, 5), np.linspace(-1, 1, 5))
    vertices = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    first = (np.arange(4)[:, None] * 5 + np.arange(4)).ravel()
    thing = scene_parts.add_mesh(
        scene, "Cage", vertices.tolist(), (first[:, None] + np.array([0, 1, 6, 5])).tolist()
    )
    thing.data.polygons.foreach_set("use_smooth", [True] * len(first))  # else Blender subdivides it
    modifier = thing.modifiers.new("Subdivision", "SUBSURF")
    modifier.boundary_smooth, modifier.render_levels = "PRESERVE_CORNERS", 5
    colors = thing.data.color_attributes.new("Colors", kind, domain)
    values = np.random.default_rng(3).integers(0, 2, (len(colors.data), 4))
    colors.data.foreach_set("color", values.astype(np.float32).ravel())
    scene_parts.add_camera(scene, ortho_scale=2.0)
    tree = Tree(thing)
    tree.emit(tree.add("ShaderNodeVertexColor", layer_name="Colors").outputs["Color"])
    check(scene, render, samples=16, limit=0.004)


@pytest.mark.parametrize("output", ["View Vector", "View Z Depth", "View Distance"])
def test_camera_data(scene, render, output):
    thing = board(scene)
    _perspective(scene, thing)
    tree = Tree(thing)
    tree.emit(tree.add("ShaderNodeCameraData").outputs[output])
    check(scene, render, SAMPLES)


@pytest.mark.parametrize("output", ["Color", "Fac"])
def test_checker(scene, render, output):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeTexChecker")
    tree.link(tree.attribute("A"), node.inputs["Vector"])
    tree.emit(node.outputs[output])
    check(scene, render)


@pytest.mark.parametrize("kind", enum_values("ShaderNodeTexGradient", "gradient_type"))
def test_gradient(scene, render, kind):
    tree = Tree(board(scene, -0.6, 0.6))
    node = tree.add("ShaderNodeTexGradient", gradient_type=kind)
    tree.link(tree.attribute("A"), node.inputs["Vector"])
    tree.emit(node.outputs["Color"])
    check(scene, render)


@pytest.mark.parametrize("kind", ["Location", "Object Index", "Random"])
def test_object_info(scene, render, kind):
    thing = board(scene)
    thing.pass_index = 3
    thing.location.z = -0.7
    tree = Tree(thing)
    node, mix = tree.add("ShaderNodeObjectInfo"), tree.add("ShaderNodeVectorMath")
    tree.link(node.outputs[kind], mix.inputs[0])
    tree.link(tree.attribute("A"), mix.inputs[1])
    tree.emit(mix.outputs[0])
    check(scene, render)


def test_generated_is_what_textures_use_when_nothing_is_linked(scene, render):
    tree = Tree(board(scene))
    tree.emit(tree.add("ShaderNodeTexGradient").outputs["Color"])
    check(scene, render, SAMPLES)


@pytest.mark.parametrize("interpolation", ["Linear", "Cubic", "Smart"])
@pytest.mark.parametrize("projection", enum_values("ShaderNodeTexEnvironment", "projection"))
def test_environment_texture(scene, render, projection, interpolation):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeTexEnvironment", image=smooth_image("Image", size=8))
    node.projection, node.interpolation = projection, interpolation
    direction = tree.add("ShaderNodeVectorMath", operation="NORMALIZE")
    tree.link(tree.attribute("A"), direction.inputs[0])
    tree.link(direction.outputs[0], node.inputs[0])
    tree.emit(node.outputs["Color"])
    check(scene, render)


@pytest.mark.parametrize("projection", enum_values("ShaderNodeTexEnvironment", "projection"))
def test_environment_texture_by_place(scene, render, projection):
    """Without a vector it is read in the direction of the point from the world's origin."""
    thing = board(scene)
    thing.location = (0.3, -0.2, 0.4)
    tree = Tree(thing)
    node = tree.add("ShaderNodeTexEnvironment", image=smooth_image("Image"), projection=projection)
    tree.emit(node.outputs["Color"])
    check(scene, render, SAMPLES)


@pytest.mark.parametrize("damage", ["missing", "truncated", "empty"])
def test_broken_image_is_magenta_and_named(scene, render, tmp_path, damage):
    from granita.export import export_frame

    granita_core = pytest.importorskip("granita_core")
    image = saved_image(tmp_path, "Broken", size=64)
    path = tmp_path / "Broken.png"
    data = path.read_bytes()
    path.unlink()
    if damage != "missing":
        path.write_bytes(data[: len(data) // 2] if damage == "truncated" else b"")
    tree, node = textured(scene, image)
    tree.emit(node.outputs["Color"])
    snapshot = export_frame(None, bpy.context.evaluated_depsgraph_get(), scene.granita, print)
    result = granita_core.render(snapshot)
    assert result["combined"][5, 7, :3].tolist() == pytest.approx([1, 0, 1], abs=1e-5)
    assert [name for name, *_ in result["warnings"]] == [f"image '{image.name}'"]
