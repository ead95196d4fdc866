# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural textures against Cycles' own output: all types, all dimensions, all outputs."""

import itertools
import os

import bpy
import numpy as np
import pytest
import scene_parts
from node_comparison import PIXELS, Tree, board, check, enum_values, render_both, socket
from photometry import LAYOUTS, ies_file

DIMENSIONS = ["1D", "2D", "3D", "4D"]
METRICS = enum_values("ShaderNodeTexVoronoi", "distance")


def textured(scene, kind, inputs=(), low=-1.5, high=1.5, **properties):
    """A tree with a texture at the attribute A, its w the first coordinate of B."""
    tree = Tree(board(scene, low, high))
    node = tree.add(kind, **properties)
    vector = next((s for s in node.inputs if s.identifier == "Vector"), None)
    if vector is not None and vector.enabled:
        tree.link(tree.attribute("A"), vector)
    w = next((s for s in node.inputs if s.identifier == "W" and s.enabled), None)
    if w is not None:
        tree.link(tree.attribute("B", "Fac"), w)
    for name, value in dict(inputs).items():
        socket(node.inputs, name).default_value = value
    return tree, node


def show(scene, render, tree, node, output, contrast=None):
    """With a contrast, the values around .5 are spread; positions are shrunk into what a picture holds."""
    source = next(s for s in node.outputs if s.enabled and s.name in (output, output + "tor"))
    contrast = 0.5 if output == "Position" else contrast
    if contrast is not None:
        spread = tree.add("ShaderNodeVectorMath", operation="MULTIPLY_ADD")
        tree.link(source, spread.inputs[0])
        spread.inputs[1].default_value = (contrast,) * 3
        spread.inputs[2].default_value = (max(0.5 - 0.5 * contrast, 0.5 * contrast),) * 3
        source = spread.outputs[0]
    tree.emit(source)
    check(scene, render)


def snap(tree, node):
    """Rounds what is linked: of white noise the last bit of a coordinate decides all, and it is rounding's."""
    for target in [s for s in node.inputs if s.enabled and s.is_linked]:
        kind = "ShaderNodeMath" if target.identifier == "W" else "ShaderNodeVectorMath"
        rounded = tree.add(kind, operation="SNAP")
        grid = 2**-8
        rounded.inputs[1].default_value = grid if kind == "ShaderNodeMath" else (grid,) * 3
        tree.link(target.links[0].from_socket, rounded.inputs[0])
        tree.link(rounded.outputs[0], target)


@pytest.mark.parametrize("output", ["Fac", "Color"])
@pytest.mark.parametrize("dimensions", DIMENSIONS)
def test_noise(scene, render, dimensions, output):
    inputs = {"Scale": 3.0, "Detail": 3.4, "Roughness": 0.7, "Distortion": 0.8}
    tree, node = textured(scene, "ShaderNodeTexNoise", inputs, noise_dimensions=dimensions)
    show(scene, render, tree, node, output, contrast=2.0)


def test_noise_by_default(scene, render):
    tree, node = textured(scene, "ShaderNodeTexNoise")
    show(scene, render, tree, node, "Color", contrast=2.0)


@pytest.mark.skipif(bpy.app.version < (4, 0, 0), reason="lacunarity and normalize are of Blender 4")
@pytest.mark.parametrize("normalize", [True, False])
def test_noise_lacunarity(scene, render, normalize):
    inputs = {"Scale": 3.0, "Detail": 4.0, "Roughness": 1.3, "Lacunarity": 2.7}
    tree, node = textured(scene, "ShaderNodeTexNoise", inputs, normalize=normalize)
    show(scene, render, tree, node, "Fac", contrast=2.0 if normalize else 1.0)


MULTIFRACTALS = (
    "MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "FBM", "HETERO_TERRAIN"
)  # fmt: skip
# Detail: part of an octave, one, and several with and without a part.
DETAILS = [0.4, 1.0, 3.0, 4.6]


def set_offsets(node):
    """Of the types that have them."""
    for name, value in (("Offset", 0.7), ("Gain", 1.6)):
        for found in node.inputs:
            if found.identifier == name:
                found.default_value = value


@pytest.mark.skipif(
    bpy.app.version >= (4, 1, 0), reason="a part of Noise Texture since Blender 4.1"
)
@pytest.mark.parametrize("detail", DETAILS)
@pytest.mark.parametrize("kind", MULTIFRACTALS)
def test_musgrave(scene, render, kind, detail):
    inputs = {"Scale": 1.7, "Detail": detail, "Dimension": 0.6, "Lacunarity": 2.3}
    tree, node = textured(scene, "ShaderNodeTexMusgrave", inputs, musgrave_type=kind)
    set_offsets(node)
    show(scene, render, tree, node, "Fac", contrast=1.0)


@pytest.mark.skipif(
    bpy.app.version >= (4, 1, 0), reason="a part of Noise Texture since Blender 4.1"
)
@pytest.mark.parametrize("dimensions", DIMENSIONS)
def test_musgrave_dimensions(scene, render, dimensions):
    inputs = {"Scale": 1.7, "Detail": 3.5}
    tree, node = textured(scene, "ShaderNodeTexMusgrave", inputs, musgrave_dimensions=dimensions)
    show(scene, render, tree, node, "Fac", contrast=0.5)


@pytest.mark.skipif(bpy.app.version < (4, 1, 0), reason="types of noise are of Blender 4.1")
@pytest.mark.parametrize("detail", DETAILS)
@pytest.mark.parametrize("kind", MULTIFRACTALS)
def test_noise_types(scene, render, kind, detail):
    inputs = {
        "Scale": 1.7,
        "Detail": detail,
        "Roughness": 0.6,
        "Lacunarity": 2.3,
        "Distortion": 0.5,
    }
    tree, node = textured(scene, "ShaderNodeTexNoise", inputs, noise_type=kind)
    set_offsets(node)
    output = "Color" if detail == 3.0 else "Fac"
    show(scene, render, tree, node, output, contrast=2.0 if kind == "FBM" else 1.0)


@pytest.mark.skipif(bpy.app.version < (4, 3, 0), reason="Gabor Texture came with Blender 4.3")
@pytest.mark.parametrize("anisotropy", [0.0, 0.7, 1.0])
@pytest.mark.parametrize("output", ["Value", "Phase", "Intensity"])
@pytest.mark.parametrize("kind", ["2D", "3D"])
def test_gabor(scene, render, kind, output, anisotropy):
    inputs = {"Scale": 3.0, "Frequency": 1.7, "Anisotropy": anisotropy}
    inputs["Orientation" + (" 2D" if kind == "2D" else " 3D")] = (
        0.6 if kind == "2D" else (0.3, 0.9, 0.5)
    )
    tree, node = textured(scene, "ShaderNodeTexGabor", inputs, gabor_type=kind)
    show(scene, render, tree, node, output, contrast=2.0 if output == "Value" else None)


@pytest.mark.parametrize("output", ["Value", "Color"])
@pytest.mark.parametrize("dimensions", DIMENSIONS)
def test_white_noise(scene, render, dimensions, output):
    tree, node = textured(scene, "ShaderNodeTexWhiteNoise", noise_dimensions=dimensions)
    snap(tree, node)
    show(scene, render, tree, node, output)


@pytest.mark.parametrize("feature", ["F1", "F2", "SMOOTH_F1"])
@pytest.mark.parametrize("output", ["Distance", "Color", "Position"])
@pytest.mark.parametrize("dimensions", DIMENSIONS)
def test_voronoi(scene, render, dimensions, output, feature):
    if output == "Position" and dimensions == "1D":
        output = "W"
    inputs = {"Scale": 1.7, "Randomness": 0.8}
    tree, node = textured(
        scene, "ShaderNodeTexVoronoi", inputs, voronoi_dimensions=dimensions, feature=feature
    )
    show(scene, render, tree, node, output)


@pytest.mark.parametrize("metric", METRICS)
def test_voronoi_metric(scene, render, metric):
    tree, node = textured(scene, "ShaderNodeTexVoronoi", {"Scale": 1.7}, distance=metric)
    show(scene, render, tree, node, "Distance")


@pytest.mark.parametrize("feature", ["DISTANCE_TO_EDGE", "N_SPHERE_RADIUS"])
@pytest.mark.parametrize("dimensions", DIMENSIONS)
def test_voronoi_borders(scene, render, dimensions, feature):
    inputs = {"Scale": 1.7, "Randomness": 0.8}
    tree, node = textured(
        scene, "ShaderNodeTexVoronoi", inputs, voronoi_dimensions=dimensions, feature=feature
    )
    output = "Radius" if feature == "N_SPHERE_RADIUS" else "Distance"
    show(scene, render, tree, node, output, contrast=2.5)


@pytest.mark.parametrize("smoothness", [0.0, 0.1, 0.6])
@pytest.mark.parametrize("output", ["Distance", "Color"])
def test_voronoi_smoothness(scene, render, output, smoothness):
    inputs = {"Scale": 1.7, "Smoothness": smoothness}
    tree, node = textured(scene, "ShaderNodeTexVoronoi", inputs, feature="SMOOTH_F1")
    show(scene, render, tree, node, output)


@pytest.mark.skipif(bpy.app.version < (4, 0, 0), reason="one octave before 4.0")
@pytest.mark.parametrize("normalize", [False, True])
@pytest.mark.parametrize("detail", [0.0, 1.0, 2.4])
@pytest.mark.parametrize(
    ("feature", "output"),
    [
        ("F1", "Distance"),
        ("F1", "Color"),
        ("F1", "Position"),
        ("F2", "Distance"),
        ("SMOOTH_F1", "Distance"),
        ("DISTANCE_TO_EDGE", "Distance"),
    ],
)
def test_voronoi_octaves(scene, render, feature, output, detail, normalize):
    inputs = {"Scale": 1.3, "Detail": detail, "Roughness": 0.6, "Lacunarity": 2.2}
    tree, node = textured(
        scene, "ShaderNodeTexVoronoi", inputs, feature=feature, normalize=normalize
    )
    show(scene, render, tree, node, output, contrast=1.0 if output == "Color" else 6.0)


@pytest.mark.parametrize("profile", enum_values("ShaderNodeTexWave", "wave_profile"))
@pytest.mark.parametrize("direction", enum_values("ShaderNodeTexWave", "bands_direction"))
def test_wave_bands(scene, render, direction, profile):
    inputs = {"Scale": 0.4, "Phase Offset": 0.7}
    tree, node = textured(
        scene, "ShaderNodeTexWave", inputs, bands_direction=direction, wave_profile=profile
    )
    show(scene, render, tree, node, "Fac")


@pytest.mark.parametrize("direction", enum_values("ShaderNodeTexWave", "rings_direction"))
def test_wave_rings(scene, render, direction):
    inputs = {"Scale": 0.4, "Distortion": 2.0, "Detail Scale": 1.5, "Detail": 1.5}
    tree, node = textured(
        scene, "ShaderNodeTexWave", inputs, wave_type="RINGS", rings_direction=direction
    )
    show(scene, render, tree, node, "Color")


@pytest.mark.parametrize("depth", range(11))
def test_magic(scene, render, depth):
    inputs = {"Scale": 1.1, "Distortion": 1.3}
    tree, node = textured(scene, "ShaderNodeTexMagic", inputs, turbulence_depth=depth)
    show(scene, render, tree, node, "Color")


@pytest.mark.parametrize("low", [-31.3, 22.7, 300.2])
@pytest.mark.parametrize(
    "kind, output, contrast",
    [
        ("ShaderNodeTexMagic", "Color", None),
        ("ShaderNodeTexNoise", "Color", 2.0),
        ("ShaderNodeTexVoronoi", "Color", None),
        ("ShaderNodeTexVoronoi", "Position", None),
        ("ShaderNodeTexWave", "Fac", None),
        ("ShaderNodeTexChecker", "Fac", None),
        ("ShaderNodeTexBrick", "Color", None),
        ("ShaderNodeTexGabor", "Value", 2.0),
        ("ShaderNodeTexMusgrave", "Fac", None),
    ],
)
def test_far_from_the_origin(scene, render, kind, output, contrast, low):
    if not hasattr(bpy.types, kind):
        pytest.skip(f"no {kind} in this Blender")
    tree, node = textured(scene, kind, {"Scale": 1.1}, low=low, high=low + 3.0)
    show(scene, render, tree, node, output, contrast)


@pytest.mark.parametrize(
    "smooth, output",
    [*itertools.product([0.0, 0.6, 1.0], ["Fac", "Color"]), (-0.5, "Color")],
)
def test_brick(scene, render, smooth, output):
    inputs = {"Scale": 1.5, "Mortar Size": 0.1, "Bias": 0.1}
    tree, node = textured(
        scene, "ShaderNodeTexBrick", inputs, offset=0.3, squash=1.6, squash_frequency=3
    )
    value = tree.add("ShaderNodeValue")  # a socket of its own takes nothing below 0
    value.outputs[0].default_value = smooth
    tree.link(value.outputs[0], node.inputs["Mortar Smooth"])
    node.inputs["Color1"].default_value = (0.9, 0.2, 0.1, 1)
    node.inputs["Color2"].default_value = (0.1, 0.7, 0.3, 1)
    show(scene, render, tree, node, output)


SCATTERED = [
    model
    for model in ("NISHITA", "SINGLE_SCATTERING", "MULTIPLE_SCATTERING")
    if model in enum_values("ShaderNodeTexSky", "sky_type")
]
DUST = "dust_density" if bpy.app.version < (5, 0, 0) else "aerosol_density"
SKIES = {
    "as it comes": {},
    "high sun": {"sun_elevation": 1.2, "sun_rotation": 2.0},
    "sunset": {"sun_elevation": 0.02, "sun_rotation": -1.0, "ozone_density": 3.0},
    "below the horizon": {"sun_elevation": -0.01, "altitude": 100.0},
    "over the zenith": {"sun_elevation": 2.2, "altitude": 5000.0, "air_density": 0.5},
    "dusty": {"sun_elevation": 0.5, DUST: 4.0, "altitude": 1500.0},
    "nothing but air": {"sun_elevation": 0.8, DUST: 0.0, "ozone_density": 0.0},
}


def sky_world(scene, **properties):
    scene.world = bpy.data.worlds.new("Sky")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    tree = scene.world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    for name, value in properties.items():
        setattr(sky, name, value)
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    tree.links.new(sky.outputs["Color"], background.inputs["Color"])


@pytest.mark.parametrize("sky", SKIES)
@pytest.mark.parametrize("model", SCATTERED)
def test_sky_of_scattered_light(scene, render, model, sky):
    tree = Tree(board(scene, -1.0, 1.0))
    node = tree.add("ShaderNodeTexSky", sky_type=model, sun_disc=False, **SKIES[sky])
    unit = tree.add("ShaderNodeVectorMath", operation="NORMALIZE")
    tree.link(tree.attribute("A"), unit.inputs[0])
    tree.link(unit.outputs["Vector"], node.inputs["Vector"])
    tree.emit(node.outputs["Color"])
    check(scene, render, limit=5e-4, relative=True)


FITTED = {
    "Preetham": ("PREETHAM", {}),
    "Preetham, low and hazy": ("PREETHAM", {"sun_direction": (0.8, -0.55, 0.1), "turbidity": 6.0}),
    "Preetham, clear noon": ("PREETHAM", {"sun_direction": (0.1, 0.2, 0.97), "turbidity": 2.0}),
    "Hosek": ("HOSEK_WILKIE", {}),
    "Hosek, low and hazy": (
        "HOSEK_WILKIE",
        {"sun_direction": (0.8, -0.55, 0.1), "turbidity": 6.3, "ground_albedo": 0.0},
    ),
    "Hosek, clearest over snow": (
        "HOSEK_WILKIE",
        {"sun_direction": (0.5, 0.2, 0.6), "turbidity": 1.0, "ground_albedo": 1.0},
    ),
    "Hosek, haziest, sun at the zenith": (
        "HOSEK_WILKIE",
        {"sun_direction": (0.0, 0.0, 1.0), "turbidity": 10.0, "ground_albedo": 0.7},
    ),
    "Hosek, sun below the horizon": (
        "HOSEK_WILKIE",
        {"sun_direction": (-0.3, 0.6, -0.4), "turbidity": 3.5},
    ),
}


@pytest.mark.skipif(
    "PREETHAM" not in enum_values("ShaderNodeTexSky", "sky_type"), reason="this Blender has none"
)
@pytest.mark.parametrize("unit", [True, False], ids=["unit", "of any length"])
@pytest.mark.parametrize("sky", FITTED)
def test_fits_to_daylight(scene, render, sky, unit):
    model, properties = FITTED[sky]
    tree = Tree(board(scene, -1.0, 1.0))
    node = tree.add("ShaderNodeTexSky", sky_type=model, **properties)
    direction = tree.attribute("A")
    if unit:
        normalize = tree.add("ShaderNodeVectorMath", operation="NORMALIZE")
        tree.link(direction, normalize.inputs[0])
        direction = normalize.outputs["Vector"]
    tree.link(direction, node.inputs["Vector"])
    tree.emit(node.outputs["Color"], strength=20.0)
    # One formula in floats; Blender 5 has another matrix from XYZ.
    check(scene, render, limit=1e-4 if bpy.app.version < (5, 0, 0) else 1e-3, relative=True)


@pytest.mark.parametrize("elevation", [0.3, 0.7])
@pytest.mark.parametrize("model", SCATTERED)
def test_the_disc_of_the_sun(scene, render, model, elevation):
    """A large one, that many pixels see; the lower one is cut by the horizon."""
    sky_world(scene, sky_type=model, sun_elevation=elevation, sun_size=0.9, sun_intensity=2.0)
    camera = scene_parts.add_camera(scene)
    camera.rotation_euler = (1.9, 0.0, 0.0)
    camera.data.lens = 18.0
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    theirs, ours = render_both(scene, render, samples=64)
    level = theirs.max(-1)
    assert np.mean(level > 50) > 0.1
    error = np.abs(theirs - ours).max(-1)[level > 1] / level[level > 1]
    assert np.quantile(error, 0.95) < 0.03


@pytest.mark.parametrize("model", SCATTERED)
def test_the_sun_of_a_sky_lights(scene, render, model):
    sky_world(scene, sky_type=model, sun_elevation=0.8, sun_rotation=1.0)
    tree = Tree(scene_parts.add_square(scene))
    tree.link(tree.add("ShaderNodeBsdfDiffuse").outputs[0], tree.output.inputs["Surface"])
    scene_parts.add_camera(scene, ortho_scale=1.0)
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    theirs, ours = render_both(scene, render, samples=64)
    assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=0.01)


def _ies(tree, text, **properties):
    file = bpy.data.texts.new("Luminaire.ies")
    file.write(text)
    return tree.add("ShaderNodeTexIES", ies=file, **properties)


# Blender 3.4 reads no others, or what lies outside of their angles.
_OLD_LAYOUTS = ("all around", "half around", "a quarter", "even around", "from 90")


@pytest.mark.parametrize("layout", _OLD_LAYOUTS if bpy.app.version < (4, 0, 0) else LAYOUTS)
def test_photometric_files(scene, render, layout):
    tree = Tree(board(scene, -1.0, 1.0))
    node = _ies(tree, ies_file(layout, "INCLUDE" if layout == "all around" else "NONE"))
    tree.link(tree.attribute("A"), node.inputs["Vector"])
    strength = tree.add("ShaderNodeMath", operation="MULTIPLY_ADD")
    tree.link(tree.attribute("B", "Fac"), strength.inputs[0])
    strength.inputs[1].default_value, strength.inputs[2].default_value = 0.01, 0.02
    tree.link(strength.outputs[0], node.inputs["Strength"])
    tree.emit(node.outputs["Fac"])
    check(scene, render)


@pytest.mark.parametrize("text", [ies_file("half around"), "not a table"], ids=["one", "none"])
def test_photometric_files_on_disk(scene, render, tmp_path, text):
    file = tmp_path / "luminaire.ies"
    file.write_text(text)
    tree = Tree(board(scene, -1.0, 1.0))
    node = tree.add("ShaderNodeTexIES", mode="EXTERNAL", filepath=str(file))
    tree.link(tree.attribute("A"), node.inputs["Vector"])
    tree.link(tree.attribute("B", "Fac"), node.inputs["Strength"])
    tree.emit(node.outputs["Fac"], strength=0.02)
    check(scene, render)


def test_a_photometric_file_that_is_a_pipe_is_named(scene, render, tmp_path, capfd, impatient):
    os.mkfifo(tmp_path / "luminaire.ies")
    tree = Tree(board(scene, -1.0, 1.0))
    path = str(tmp_path / "luminaire.ies")
    node = tree.add("ShaderNodeTexIES", mode="EXTERNAL", filepath=path)
    tree.emit(node.outputs["Fac"])
    render(scene)
    assert "has no photometric file that can be read" in capfd.readouterr().out
