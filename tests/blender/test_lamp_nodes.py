# SPDX-License-Identifier: GPL-3.0-or-later
"""What nodes of lamps are told of places, directions and coordinates, beside Cycles of the same Blender."""

import bpy
import numpy as np
import pytest
import scene_parts
from test_lights import (
    DIFFUSE,
    GLOSSY,
    SPOT_RATE,
    add_light,
    expect_alike,
    lambert,
    light_tree,
    set_stage,
)

# Turned, scaled and away from the world's origin, so that no two spaces are alike.
PLACE = (1.0, -1.5, 3.0), (0.5, 0.4, 0.7)
LAMPS = {
    "point": ("POINT", 300.0, dict(shadow_soft_size=0.4)),
    "spot": ("SPOT", 900.0, dict(shadow_soft_size=0.2, spot_size=1.6, spot_blend=0.3)),
    "sun": ("SUN", 3.0, dict(angle=0.2)),
    "rectangle": ("AREA", 200.0, dict(shape="RECTANGLE", size=2.0, size_y=1.2)),
    "ellipse": ("AREA", 200.0, dict(shape="ELLIPSE", size=2.0, size_y=1.2)),
    "spread": ("AREA", 200.0, dict(shape="SQUARE", size=1.6, spread=1.4)),
}
COORDINATES = {
    "TexCoord": ("Generated", "Normal", "UV", "Object", "Camera", "Window", "Reflection"),
    "NewGeometry": ("Position", "Normal", "True Normal", "Incoming", "Parametric"),
    "CameraData": ("View Vector",),
    "ObjectInfo": ("Location",),
    "UVMap": ("UV",),
}


def waves(tree, output, frequency=3.0):
    """Colours the light by sines of a vector."""
    vector = output
    for operation, numbers in (
        ("MULTIPLY", (frequency,)),
        ("SINE", ()),
        ("MULTIPLY_ADD", (0.5, 0.5)),
    ):
        node = tree.nodes.new("ShaderNodeVectorMath")
        node.operation = operation
        tree.links.new(vector, node.inputs[0])
        for k, number in enumerate(numbers):
            node.inputs[1 + k].default_value = (number,) * 3
        vector = node.outputs[0]
    tree.links.new(vector, tree.nodes["Emission"].inputs["Color"])


def byte_image(name, texels):
    image = bpy.data.images.new(name, texels.shape[1], texels.shape[0])
    image.colorspace_settings.name = "Non-Color"  # before it is drawn: it would be drawn anew
    image.pixels.foreach_set(texels.astype(np.float32).ravel())
    image.update()
    return image


def lamp_tree(scene, name):
    kind, energy, settings = LAMPS[name]
    light = add_light(scene, kind, energy, *PLACE, **settings)
    light.scale = (1.5, 1.5, 1.5)
    return light_tree(light)


def assert_alike(scene, render, name, tolerance=DIFFUSE):
    if name == "spot":
        scene.granita.dicing_rate = SPOT_RATE
    expect_alike(scene, render, tolerance)


@pytest.mark.parametrize("name", LAMPS)
@pytest.mark.parametrize(
    "node, output", [(node, output) for node, outputs in COORDINATES.items() for output in outputs]
)
def test_coordinates(scene, render, name, node, output):
    set_stage(scene, lambert())
    tree = lamp_tree(scene, name)
    if bpy.app.version < (4, 0, 0):
        if output == "Parametric" and name == "sun":
            pytest.skip("this Cycles tells random numbers")
        if (node, output) == ("TexCoord", "Normal") and tree_is_of_area(name):
            pytest.skip(
                "this Cycles tells lamps' normals that rays of lobes meet in the world's axes"
            )
    waves(tree, tree.nodes.new(f"ShaderNode{node}").outputs[output])
    assert_alike(scene, render, name)


@pytest.mark.parametrize("name", ["point", "rectangle", "sun"])
@pytest.mark.parametrize("output", ["Window", "Camera"])
def test_coordinates_under_a_parallel_view(scene, render, name, output):
    set_stage(scene, lambert())
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 6.0
    tree = lamp_tree(scene, name)
    waves(tree, tree.nodes.new("ShaderNodeTexCoord").outputs[output])
    assert_alike(scene, render, name)


def tree_is_of_area(name):
    return LAMPS[name][0] == "AREA"


@pytest.mark.parametrize("name", ["point", "rectangle", "sun"])
@pytest.mark.parametrize("kind", ["POINT", "VECTOR", "NORMAL"])
@pytest.mark.parametrize(
    "spaces", ["WORLD OBJECT", "CAMERA OBJECT", "OBJECT WORLD", "WORLD CAMERA"]
)
def test_transforms(scene, render, name, kind, spaces):
    if (4, 0) <= bpy.app.version < (4, 5) and "OBJECT" in spaces and kind != "NORMAL":
        pytest.skip("this Cycles has a space of lamps for normals alone")
    set_stage(scene, lambert())
    tree = lamp_tree(scene, name)
    geometry, turn = (tree.nodes.new(f"ShaderNode{n}") for n in ("NewGeometry", "VectorTransform"))
    turn.vector_type = kind
    turn.convert_from, turn.convert_to = spaces.split()
    tree.links.new(
        geometry.outputs["Position" if kind == "POINT" else "Incoming"], turn.inputs["Vector"]
    )
    waves(tree, turn.outputs[0])
    assert_alike(scene, render, name)


@pytest.mark.parametrize("name", LAMPS)
@pytest.mark.parametrize("linked", [False, True], ids=["its own vector", "Object"])
def test_images(scene, render, name, linked):
    """Of a few texels, with an edge between black and white: lamps' textures are not blurred.  Such edges are narrower
    than a pixel, as a spot's rim: of a rectangle .021 are seen where it is shaded once a pixel, .012 from here on."""
    set_stage(scene, lambert())
    scene.granita.dicing_rate = SPOT_RATE
    tree = lamp_tree(scene, name)
    texture = tree.nodes.new("ShaderNodeTexImage")
    texels = np.random.default_rng(1).random((6, 8, 4))
    texels[:, 4:] = np.round(texels[:, 4:])
    texture.image = byte_image("Slide", texels)
    if linked:
        place = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(place.outputs["Object"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Emission"].inputs["Color"])
    assert_alike(scene, render, name)


@pytest.mark.parametrize("name", LAMPS)
@pytest.mark.parametrize("output", ["Generated", "Object", "Normal"])
def test_uneven_scales(scene, render, name, output):
    """Of each axis another, one of them mirrored."""
    if bpy.app.version < (4, 0, 0) and output == "Normal" and tree_is_of_area(name):
        pytest.skip("this Cycles tells lamps' normals that rays of lobes meet in the world's axes")
    set_stage(scene, lambert())
    tree = lamp_tree(scene, name)
    lamp = next(thing for thing in scene.objects if thing.type == "LIGHT")
    lamp.scale = (0.8, -1.6, 1.2)
    waves(tree, tree.nodes.new("ShaderNodeTexCoord").outputs[output])
    assert_alike(scene, render, name)


@pytest.mark.parametrize("output", ["Is Camera Ray", "Is Shadow Ray", "Is Diffuse Ray"])
def test_light_path(scene, render, output):
    set_stage(scene, lambert())
    tree = lamp_tree(scene, "rectangle")
    path, add = tree.nodes.new("ShaderNodeLightPath"), tree.nodes.new("ShaderNodeMath")
    add.inputs[1].default_value = 0.5
    tree.links.new(path.outputs[output], add.inputs[0])
    tree.links.new(add.outputs[0], tree.nodes["Emission"].inputs["Strength"])
    assert_alike(scene, render, "rectangle")


@pytest.mark.parametrize("roughness", [0.0, 0.2])
def test_what_glosses_show_of_a_texture(scene, render, roughness):
    """Rays of lobes meet the lamp where its nodes are asked."""
    set_stage(scene, scene_parts.closure("Shiny", "ShaderNodeBsdfGlossy", Roughness=roughness))
    shape = dict(shape="RECTANGLE", size=4.0, size_y=2.0)
    light = add_light(scene, "AREA", 200.0, (0.0, 5.0, 3.0), (-1.0, 0.0, 0.0), **shape)
    tree = light_tree(light)
    waves(tree, tree.nodes.new("ShaderNodeNewGeometry").outputs["Parametric"], 8.0)
    expect_alike(scene, render, GLOSSY)
