# SPDX-License-Identifier: GPL-3.0-or-later
"""Every light, the world and shadows against Cycles with all bounces at 0, of the same Blender.

A ball over a floor, 64 by 48 pixels.  The mean must agree within 1 %, and averages over 4 by 4 pixels to
an RMS error, relative to the picture's mean, of what both programs' noise and the edges of shadows make:
Cycles shades every one of its samples anew, Granita once a vertex a pixel apart.
"""

import math

import bpy
import numpy as np
import pytest
import scene_parts
from photometry import ies_file

# Measured over 3.4 and 4.5: diffuse scenes .003 to .012, a scaled spot's hard rim .035, glossy
# highlights of few pixels .05.
DIFFUSE, RIM, GLOSSY = 0.025, 0.06, 0.10

# A spot's rim and its shadows' are narrower than a pixel, and all of its picture is near them: .024 where
# it is shaded once a pixel, .009 from here on; the scaled one .062 and .032.
SPOT_RATE = 0.5


def lambert():
    return scene_parts.closure("Matte", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.6, 0.4, 1.0))


def set_stage(scene, material, ball=None):
    camera = scene_parts.add_camera(scene, (0.0, -6.0, 4.0))
    camera.rotation_euler = (math.radians(60.0), 0.0, 0.0)
    camera.data.lens = 35.0
    scene_parts.add_square(scene, "Floor", 12.0, (0.0, 0.0, 0.0), material)
    bpy.ops.mesh.primitive_uv_sphere_add(
        segments=48, ring_count=24, radius=1.0, location=(0, 0, 1.2)
    )
    sphere = bpy.context.object
    sphere.data.materials.append(ball or material)
    for polygon in sphere.data.polygons:
        polygon.use_smooth = True
    scene_parts.set_world(scene, (0.0, 0.0, 0.0))
    return sphere


def add_light(
    scene, kind, energy, location=(2.0, -2.0, 4.0), rotation=(0.5, 0.4, 0.0), **properties
):
    light = bpy.data.lights.new("Light", kind)
    light.energy = energy
    for name, value in properties.items():
        setattr(light, name, value)
    thing = scene_parts.add_object(scene, "Light", light, location)
    thing.rotation_euler = rotation
    return thing


def both(scene, render):
    """Linear RGB of Granita and of Cycles with direct light alone, [height, width, 3]."""
    pictures = []
    for channels in scene_parts.direct_light_of_both(scene, render, 144):
        combined = {name[-1]: values for name, values in channels.items() if ".Combined." in name}
        pictures.append(np.stack([combined[c] for c in "RGB"], axis=-1).astype(np.float64))
    return pictures


def expect_alike(scene, render, tolerance):
    ours, theirs = both(scene, render)
    assert theirs.mean() > 0.01
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.01)
    blocks = [p.reshape(12, 4, 16, 4, 3).mean(axis=(1, 3)) for p in (ours, theirs)]
    error = np.sqrt(np.mean((blocks[0] - blocks[1]) ** 2)) / theirs.mean()
    assert error < tolerance, error


LIGHTS = {
    "point": (("POINT", 500.0), dict(shadow_soft_size=0.0)),
    "soft point": (("POINT", 500.0), dict(shadow_soft_size=0.5)),
    "sun": (("SUN", 2.0), dict(angle=0.1)),
    "spot": (("SPOT", 2000.0), dict(spot_size=0.9, spot_blend=0.3, shadow_soft_size=0.1)),
    "square": (("AREA", 300.0), dict(shape="SQUARE", size=1.5)),
    "rectangle": (("AREA", 300.0), dict(shape="RECTANGLE", size=2.0, size_y=0.7)),
    "disk": (("AREA", 300.0), dict(shape="DISK", size=1.5)),
    "ellipse": (("AREA", 300.0), dict(shape="ELLIPSE", size=2.0, size_y=0.7)),
    "spread": (("AREA", 300.0), dict(shape="SQUARE", size=2.0, spread=1.0)),
}


@pytest.mark.parametrize("name", LIGHTS)
def test_light_on_diffuse(scene, render, name):
    arguments, properties = LIGHTS[name]
    set_stage(scene, lambert())
    add_light(scene, *arguments, **properties)
    if name == "spot":
        scene.granita.dicing_rate = SPOT_RATE
    expect_alike(scene, render, DIFFUSE)


def test_a_scaled_spot(scene, render):
    set_stage(scene, lambert())
    spot = add_light(scene, "SPOT", 2000.0, (0, 0, 5), (0, 0, 0), spot_size=0.9, spot_blend=0.3)
    spot.scale = (1.0, 0.5, 1.0)
    scene.granita.dicing_rate = SPOT_RATE
    expect_alike(scene, render, RIM)


def test_a_scaled_area_light(scene, render):
    set_stage(scene, lambert())
    light = add_light(scene, "AREA", 300.0, shape="ELLIPSE", size=1.0, size_y=0.7)
    light.scale = (2.0, 1.5, 1.0)
    expect_alike(scene, render, DIFFUSE)


def test_a_sphere_of_light(scene, render):
    set_stage(scene, lambert())
    light = add_light(scene, "POINT", 500.0, shadow_soft_size=1.0)
    if not hasattr(light.data, "use_soft_falloff"):
        pytest.skip("this Blender has no spherical lights")
    light.data.use_soft_falloff = False
    expect_alike(scene, render, DIFFUSE)


def test_a_light_without_shadow(scene, render):
    set_stage(scene, lambert())
    light = add_light(scene, "POINT", 500.0, shadow_soft_size=0.0).data
    scene_parts.cast_no_shadow(light)
    expect_alike(scene, render, DIFFUSE)


def test_the_emission_node_of_a_light(scene, render):
    set_stage(scene, lambert())
    light = add_light(scene, "POINT", 500.0).data
    light.use_nodes = True
    emission = light.node_tree.nodes["Emission"]
    emission.inputs["Color"].default_value = (1.0, 0.5, 0.2, 1.0)
    emission.inputs["Strength"].default_value = 0.5
    expect_alike(scene, render, DIFFUSE)


def test_a_muted_emission_node_gives_no_light(scene, render):
    set_stage(scene, lambert())
    light = add_light(scene, "POINT", 500.0).data
    light.use_nodes = True
    light.node_tree.nodes["Emission"].mute = True
    pictures = scene_parts.direct_light_of_both(scene, render, 4)
    for channels in pictures:
        assert not any(values.any() for name, values in channels.items() if name[-1] in "RGB")


def test_constants_linked_to_the_emission_node_of_a_light(scene, render):
    set_stage(scene, lambert())
    light = add_light(scene, "POINT", 500.0).data
    light.use_nodes = True
    tree = light.node_tree
    color, falloff, times = (
        tree.nodes.new(kind)
        for kind in ("ShaderNodeRGB", "ShaderNodeLightFalloff", "ShaderNodeMath")
    )
    color.outputs[0].default_value = (1.0, 0.5, 0.2, 1.0)
    falloff.inputs["Strength"].default_value = 0.4
    times.operation = "MULTIPLY"
    times.inputs[1].default_value = 2.0
    tree.links.new(falloff.outputs["Quadratic"], times.inputs[0])
    tree.links.new(times.outputs[0], tree.nodes["Emission"].inputs["Strength"])
    tree.links.new(color.outputs[0], tree.nodes["Emission"].inputs["Color"])
    expect_alike(scene, render, DIFFUSE)


def test_exposure_temperature_and_power_of_a_unit_area(scene, render):
    set_stage(scene, lambert())
    light = add_light(scene, "AREA", 50.0, shape="DISK", size=1.5).data
    if not hasattr(light, "normalize"):
        pytest.skip("this Blender's lights have neither")
    light.normalize = False
    light.exposure = 1.5
    light.use_temperature, light.temperature = True, 3000.0
    expect_alike(scene, render, DIFFUSE)


@pytest.mark.parametrize("kind", ["POINT", "SUN", "SPOT"])
def test_power_of_a_unit_area_of_lights_that_are_no_area(scene, render, kind):
    set_stage(scene, lambert())
    light = add_light(scene, kind, 300.0).data
    if not hasattr(light, "normalize"):
        pytest.skip("this Blender's lights are always normalised")
    if kind == "SUN":
        light.angle = 0.2
    else:
        light.shadow_soft_size = 0.3
    if kind == "SPOT":
        scene.granita.dicing_rate = SPOT_RATE
    light.normalize = False
    expect_alike(scene, render, DIFFUSE)


def test_a_light_that_glossy_surfaces_do_not_see(scene, render):
    set_stage(scene, lambert(), scene_parts.closure("Shiny", "ShaderNodeBsdfGlossy", Roughness=0.6))
    add_light(scene, "AREA", 300.0, size=2.0).visible_glossy = False
    expect_alike(scene, render, DIFFUSE)


def test_a_world_of_one_colour_with_its_occlusion(scene, render):
    set_stage(scene, lambert())
    scene_parts.set_world(scene, (0.5, 0.7, 1.0))
    expect_alike(scene, render, DIFFUSE)


def test_rough_gloss_under_a_lamp_and_the_world(scene, render):
    set_stage(scene, scene_parts.closure("Shiny", "ShaderNodeBsdfGlossy", Roughness=0.5))
    add_light(scene, "AREA", 300.0, size=2.0)
    scene_parts.set_world(scene, (0.2, 0.3, 0.4))
    expect_alike(scene, render, GLOSSY)


def test_a_mirror_sees_lamps_and_the_world(scene, render):
    set_stage(scene, lambert(), scene_parts.closure("Shiny", "ShaderNodeBsdfGlossy", Roughness=0.0))
    add_light(scene, "AREA", 300.0, (0.0, -3.0, 5.0), (0.4, 0.0, 0.0), size=2.0)
    scene_parts.set_world(scene, (0.2, 0.3, 0.4))
    expect_alike(scene, render, GLOSSY)


def test_glass_panes_let_light_through(scene, render):
    glass = scene_parts.closure("Glass", "ShaderNodeBsdfTransparent", Color=(0.9, 0.5, 0.3, 1.0))
    ball = set_stage(scene, lambert(), glass)
    assert ball.data.materials[0] is glass
    add_light(scene, "SUN", 3.0, angle=0.05)
    expect_alike(scene, render, DIFFUSE)


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA"])
@pytest.mark.parametrize("output", ["Quadratic", "Linear", "Constant"])
def test_falloff_of_lamps(scene, render, kind, output):
    set_stage(scene, lambert())
    shape = {"size": 0.6} if kind == "AREA" else {"shadow_soft_size": 0.2}
    tree = light_tree(add_light(scene, kind, 300.0, **shape))
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value = 0.6
    falloff.inputs["Smooth"].default_value = 1.5
    tree.links.new(falloff.outputs[output], tree.nodes["Emission"].inputs["Strength"])
    if kind == "SPOT":
        scene.granita.dicing_rate = SPOT_RATE
    expect_alike(scene, render, DIFFUSE)


@pytest.mark.parametrize("output", ["Quadratic", "Linear", "Constant"])
def test_falloff_of_suns(scene, render, output):
    """They are infinitely far; Cycles leaves them nothing by it, and since Blender 4.3 all."""
    set_stage(scene, lambert())
    tree = light_tree(add_light(scene, "SUN", 3.0, angle=0.1))
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value = 0.6
    tree.links.new(falloff.outputs[output], tree.nodes["Emission"].inputs["Strength"])
    if output == "Quadratic" or bpy.app.version >= (4, 3, 0):
        expect_alike(scene, render, DIFFUSE)
    else:
        assert not any(picture.any() for picture in both(scene, render))


def test_a_linked_strength_that_varies_is_named(scene):
    from granita.export.shading.light import light_record

    light = add_light(scene, "POINT", 10.0)
    light.data.use_nodes = True
    tree = light.data.node_tree
    camera = tree.nodes.new("ShaderNodeCameraData")
    tree.links.new(camera.outputs["View Distance"], tree.nodes["Emission"].inputs["Strength"])
    said = []
    light_record(light, np.eye(4)[None], lambda *words: said.append(words))
    assert said == [
        ("light 'Light'", "what is linked to Strength of 'Emission' varies and is not used")
    ]


def light_tree(light):
    light.data.use_nodes = True
    return light.data.node_tree


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA"])
@pytest.mark.parametrize("linked", [False, True], ids=["its own vector", "a turned vector"])
def test_photometric_lamps(scene, render, kind, linked):
    if kind == "AREA" and not linked and bpy.app.version < (4, 0, 0):
        pytest.skip("this Blender's area lights shine everywhere as straight ahead")
    set_stage(scene, lambert())
    spot = {"spot_size": 2.0} if kind == "SPOT" else {}
    light = add_light(scene, kind, 30.0, (1.0, -1.5, 3.0), (0.5, 0.4, 0.7), **spot)
    light.scale = (1.0, 1.0, 1.0) if kind == "AREA" else (2.0, 2.0, 2.0)
    tree = light_tree(light)
    file = bpy.data.texts.new("Luminaire.ies")
    file.write(ies_file("a quarter"))
    ies = tree.nodes.new("ShaderNodeTexIES")
    ies.ies = file
    ies.inputs["Strength"].default_value = 0.3
    if linked:
        place, turn = (tree.nodes.new(f"ShaderNode{n}") for n in ("TexCoord", "Mapping"))
        turn.inputs["Rotation"].default_value = (0.3, 0.0, 1.0)
        tree.links.new(place.outputs["Normal"], turn.inputs["Vector"])
        tree.links.new(turn.outputs[0], ies.inputs["Vector"])
    tree.links.new(ies.outputs["Fac"], tree.nodes["Emission"].inputs["Strength"])
    if kind == "SPOT":
        scene.granita.dicing_rate = SPOT_RATE
    expect_alike(scene, render, DIFFUSE)


def test_a_slide_in_a_lamp(scene, render):
    set_stage(scene, lambert())
    tree = light_tree(add_light(scene, "POINT", 500.0, (1.0, -1.5, 3.0), (0.5, 0.4, 0.7)))
    place, slide = (tree.nodes.new(f"ShaderNode{n}") for n in ("TexCoord", "TexGradient"))
    tree.links.new(place.outputs["Normal"], slide.inputs["Vector"])
    tree.links.new(slide.outputs["Color"], tree.nodes["Emission"].inputs["Color"])
    expect_alike(scene, render, DIFFUSE)
