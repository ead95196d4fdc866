# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights with Ray Visibility > Camera are seen, beside Cycles in the same Blender."""

import math

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts as parts


@pytest.fixture
def stage(scene):
    """A glowing wall on the left half, the world on the right."""
    scene.render.resolution_x = scene.render.resolution_y = 48
    parts.add_camera(scene, ortho_scale=4.0)
    parts.add_square(scene, "Wall", 4.0, (-2.0, 0.0, -1.0), parts.emission("Wall", (0.2, 0.3, 0.4)))
    parts.set_world(scene, (0.3, 0.2, 0.1))
    for name in ("z", "emit", "environment", "object_index"):
        setattr(scene.view_layers[0], f"use_pass_{name}", True)
    return scene


def seen_light(scene, kind, **settings):
    light = bpy.data.lights.new("Lamp", kind)
    light.energy = 10.0
    light.color = (1.0, 0.5, 0.25)
    for name, value in settings.items():
        setattr(light, name, value)
    thing = parts.add_object(scene, "Lamp", light, (0.1, 0.2, 1.0))
    thing.rotation_euler = (math.pi, 0.0, 0.3)  # faces the camera
    thing.visible_camera = True
    return thing


def assert_as_in_cycles(scene, render):
    ours, theirs = parts.direct_light_of_both(scene, render, 64)
    for name, plane in theirs.items():
        # What one sample a pixel decides is another at edges; light there has the noise of 64 samples.
        if name.endswith((".Z", ".X")):
            assert (np.abs(ours[name] - plane) > 1e-4 * np.abs(plane)).mean() < 0.03, name
        else:
            assert abs(ours[name].mean() - plane.mean()) < 0.01 * abs(plane.mean()) + 1e-4, name
            assert np.abs(ours[name] - plane).mean() < 0.02 * plane.max() + 1e-4, name
    return ours


def brightest(channels):
    return max(channels[f"ViewLayer.Combined.{c}"].max() for c in "RGB")


@pytest.mark.parametrize("transparent", [False, True])
@pytest.mark.parametrize("shape", ["SQUARE", "RECTANGLE", "DISK", "ELLIPSE"])
def test_area_lights_are_seen(stage, render, shape, transparent):
    stage.render.film_transparent = transparent
    lamp = seen_light(stage, "AREA", shape=shape, size=1.5, size_y=0.8)
    lamp.scale = (1.0, 1.5, 1.0)
    assert brightest(assert_as_in_cycles(stage, render)) > 0.8


def test_from_behind_they_are_not(stage, render):
    lamp = seen_light(stage, "AREA", size=1.5)
    lamp.rotation_euler = (0.3, 0.0, 0.0)
    assert brightest(assert_as_in_cycles(stage, render)) < 0.5


def test_point_lights_are_seen_whatever_their_scale(stage, render):
    lamp = seen_light(stage, "POINT", shadow_soft_size=0.7)
    lamp.scale = (2.0, 1.0, 0.5)
    assert brightest(assert_as_in_cycles(stage, render)) > 0.5


def test_what_is_before_them_hides_them_and_they_shine(stage, render):
    seen_light(stage, "AREA", size=2.0)
    parts.add_square(
        stage, "Before", 1.0, (0.0, 0.0, 2.0), parts.emission("Dark", (0.05, 0.05, 0.05))
    )
    assert_as_in_cycles(stage, render)


def emission_of(lamp):
    """(tree, Emission) of the lamp's nodes."""
    lamp.data.use_nodes = True
    tree = lamp.data.node_tree
    return tree, tree.nodes["Emission"]


@pytest.mark.parametrize(
    "kind, output", [("AREA", "Quadratic"), ("AREA", "Linear"), ("POINT", "Quadratic")]
)
def test_by_what_their_nodes_make_of_the_distance(stage, render, kind, output):
    shape = {"size": 1.5} if kind == "AREA" else {"shadow_soft_size": 0.7}
    tree, emission = emission_of(seen_light(stage, kind, **shape))
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value = 3.0
    falloff.inputs["Smooth"].default_value = 1.5
    emission.inputs["Color"].default_value = (0.5, 1.0, 0.8, 1.0)
    tree.links.new(falloff.outputs[output], emission.inputs["Strength"])
    assert brightest(assert_as_in_cycles(stage, render)) > 0.8


@pytest.mark.parametrize("shape", ["SQUARE", "ELLIPSE"])
@pytest.mark.parametrize(
    "coordinates",
    ["TexCoord Generated", "TexCoord UV", "TexCoord Object", "NewGeometry Position"]
    + ["NewGeometry Normal", "NewGeometry Incoming", "NewGeometry Parametric"],
)
def test_area_lights_by_what_their_nodes_make_of_places(stage, render, shape, coordinates):
    node, output = coordinates.split()
    lamp = seen_light(stage, "AREA", shape=shape, size=1.5, size_y=0.8)
    lamp.scale = (1.0, 1.5, 1.0)
    tree, emission = emission_of(lamp)
    shown = tree.nodes.new("ShaderNodeVectorMath")
    shown.operation = "MULTIPLY_ADD"
    shown.inputs[1].default_value = shown.inputs[2].default_value = (0.5, 0.5, 0.5)
    tree.links.new(tree.nodes.new(f"ShaderNode{node}").outputs[output], shown.inputs[0])
    tree.links.new(shown.outputs[0], emission.inputs["Color"])
    _, report = export_probe.through_script()
    assert report.entries() == []
    assert_as_in_cycles(stage, render)


@pytest.mark.parametrize("kind", ["TexImage", "TexNoise"])
def test_textures_of_area_lights_have_the_coordinates_of_these(stage, render, kind):
    """Without a link to their vectors; an image of eight by six colours."""
    tree, emission = emission_of(seen_light(stage, "AREA", size=1.5))
    texture = tree.nodes.new(f"ShaderNode{kind}")
    if kind == "TexImage":
        texture.image = bpy.data.images.new("Slide", 8, 6, float_buffer=True)
        texels = np.random.default_rng(1).random((6, 8, 4), dtype=np.float32)
        texture.image.pixels.foreach_set(texels.ravel())
        texture.image.update()
    tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
    assert_as_in_cycles(stage, render)


@pytest.mark.parametrize("kind, output", [("AREA", "Normal"), ("POINT", "Generated")])
def test_other_nodes_that_tell_places_apart_are_named(scene, kind, output):
    parts.add_camera(scene)
    shape = {"size": 1.5} if kind == "AREA" else {"shadow_soft_size": 0.7}
    tree, emission = emission_of(seen_light(scene, kind, **shape))
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs[output], emission.inputs["Color"])
    _, report = export_probe.through_script()
    (entry,) = report.entries()
    assert entry[0] == "light 'Lamp'" and "without its nodes" in entry[1]


def test_a_light_that_is_not_seen_changes_nothing(stage, render):
    expected = render(stage)
    seen_light(stage, "AREA", size=1.5).visible_camera = False
    for name, plane in render(stage).items():
        np.testing.assert_array_equal(plane, expected[name])


def test_beside_objects_whose_colour_is_asked_for(stage, render):
    """What shaders find on instances has a row for each of them."""
    seen_light(stage, "AREA", size=1.5)
    glow = parts.emission("Tinted", (1.0, 1.0, 1.0))
    nodes, links = glow.node_tree.nodes, glow.node_tree.links
    emit = next(node for node in nodes if node.type == "EMISSION")
    links.new(nodes.new("ShaderNodeObjectInfo").outputs["Color"], emit.inputs["Color"])
    parts.add_square(stage, "Tinted", 1.0, (-1.0, -1.0, 0.0), glow).color = (0.1, 0.7, 0.3, 1.0)
    assert_as_in_cycles(stage, render)


def test_they_move_with_the_light(stage):
    stage.render.use_motion_blur, stage.render.motion_blur_shutter = True, 1.0
    lamp = seen_light(stage, "AREA", size=1.5)
    for frame, x in ((0, -1.0), (2, 1.0)):
        lamp.location.x = x
        lamp.keyframe_insert("location", frame=frame)
    stage.view_layers[0].use_pass_vector = True
    stage.frame_set(1)
    snapshot, _, _ = export_probe.through_engine(stage)
    (light,) = snapshot["lights"]
    knots = export_probe.knots_of(snapshot, "Lamp")
    np.testing.assert_array_equal(knots, light["world_from_light"])
    assert len(knots) > 1
    assert len(snapshot["instances"]["adjacent"]) == 2 * len(snapshot["instances"]["name"])


@pytest.mark.parametrize("kind", ["SUN", "SPOT", "NARROW"])
def test_those_that_are_not_drawn_are_named(scene, kind):
    parts.add_camera(scene)
    if kind == "NARROW":
        seen_light(scene, "AREA", spread=1.0)
    elif kind == "SPOT":
        seen_light(scene, "SPOT", shadow_soft_size=0.5)
    else:
        seen_light(scene, "SUN", angle=0.1)
    _, report = export_probe.through_script()
    (entry,) = report.entries()
    assert entry[0] == "light 'Lamp'" and "not drawn to the camera" in entry[1]
