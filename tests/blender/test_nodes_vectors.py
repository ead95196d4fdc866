# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that turn and bend vectors, colours of spectra, tangents, and what stands in for nodes that are not
evaluated; against Cycles' own output (node_comparison.py)."""

import math

import bpy
import numpy as np
import pytest
import scene_parts
from node_comparison import LIMIT, Tree, board, check, enum_values, render_both, rmse, socket


@pytest.mark.parametrize("invert", [False, True])
@pytest.mark.parametrize("kind", enum_values("ShaderNodeVectorRotate", "rotation_type"))
def test_vector_rotate(scene, render, kind, invert):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeVectorRotate", rotation_type=kind, invert=invert)
    for name, target in (("A", "Vector"), ("B", "Center"), ("C", "Axis"), ("C", "Rotation")):
        tree.link(tree.attribute(name), socket(node.inputs, target))
    tree.link(tree.attribute("B", "Fac"), socket(node.inputs, "Angle"))
    tree.emit(node.outputs[0])
    check(scene, render)


def test_nothing_turns_about_no_axis(scene, render):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeVectorRotate")
    tree.link(tree.attribute("A"), socket(node.inputs, "Vector"))
    node.inputs["Axis"].default_value, node.inputs["Angle"].default_value = (0, 0, 0), 1.0
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("kind", enum_values("ShaderNodeVectorTransform", "vector_type"))
@pytest.mark.parametrize("way", ["WORLD OBJECT", "OBJECT CAMERA", "CAMERA WORLD", "OBJECT WORLD"])
def test_vector_transform(scene, render, kind, way):
    thing = board(scene)
    # Turned and scaled so that squares still end between pixels.
    thing.scale, thing.location = (2.0, 1.0, 1.5), (0.125, 0.0, -0.2)
    scene.camera.rotation_euler.z = math.pi / 2
    tree = Tree(thing)
    start, end = way.split()
    node = tree.add(
        "ShaderNodeVectorTransform", vector_type=kind, convert_from=start, convert_to=end
    )
    tree.link(tree.attribute("A"), node.inputs[0])
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("output", ["Normal", "Dot"])
def test_normal(scene, render, output):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeNormal")
    node.outputs["Normal"].default_value = (0.48, 0.6, 0.64)
    tree.link(tree.attribute("A"), node.inputs[0])
    tree.emit(node.outputs[output])
    theirs, ours = render_both(scene, render)
    assert theirs.std() > 0.05
    assert rmse(theirs, ours) < LIMIT


def _bend(mapping):
    for curve, height in zip(mapping.curves, (0.8, -0.3, 0.5)):
        curve.points.new(0.3, height)
    mapping.update()


@pytest.mark.parametrize("kind", ["ShaderNodeVectorCurve", "ShaderNodeFloatCurve"])
def test_curves_of_vectors_and_numbers(scene, render, kind):
    tree = Tree(board(scene, -0.9, 0.9))
    node = tree.add(kind)
    _bend(node.mapping)
    value = next(
        s
        for s in node.inputs
        if s.type in ("VECTOR", "VALUE") and s.identifier != "Fac" and s.name != "Factor"
    )
    tree.link(tree.attribute("A", "Vector" if value.type == "VECTOR" else "Fac"), value)
    tree.link(tree.attribute("B", "Fac"), node.inputs[0])
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("value", [-1.0, 2.0])
def test_a_number_beyond_a_float_curve(scene, render, value):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeFloatCurve")
    node.inputs[0].default_value, node.inputs[1].default_value = 1.0, value
    tree.emit(node.outputs[0])
    theirs, ours = render_both(scene, render)
    np.testing.assert_allclose(ours, theirs, atol=1e-4)


@pytest.mark.parametrize(
    "kind, span, lowest", [("Blackbody", 9000.0, 1500.0), ("Wavelength", 400.0, 360.0)]
)
def test_spectra(scene, render, kind, span, lowest):
    """Of kelvins and nanometres."""
    tree = Tree(board(scene, 0.0, 1.0))
    node = tree.add(f"ShaderNode{kind}")
    scaled = tree.add("ShaderNodeMath", operation="MULTIPLY_ADD")
    tree.link(tree.attribute("A", "Fac"), scaled.inputs[0])
    scaled.inputs[1].default_value, scaled.inputs[2].default_value = span, lowest
    tree.link(scaled.outputs[0], node.inputs[0])
    tree.emit(node.outputs[0])
    check(scene, render, limit=LIMIT)


def test_a_lamp_is_as_warm_as_its_blackbody(scene, render):
    scene_parts.add_camera(scene, ortho_scale=2.0)
    scene.render.resolution_x = scene.render.resolution_y = 16
    tree = Tree(scene_parts.add_square(scene, size=3.0))
    tree.link(tree.add("ShaderNodeBsdfDiffuse").outputs[0], tree.output.inputs["Surface"])
    light = bpy.data.lights.new("Sun", "SUN")
    light.angle, light.use_nodes = 0.0, True
    nodes, links = light.node_tree.nodes, light.node_tree.links
    body = nodes.new("ShaderNodeBlackbody")
    body.inputs[0].default_value = 3000.0
    links.new(body.outputs[0], next(n for n in nodes if n.type == "EMISSION").inputs["Color"])
    scene_parts.add_object(scene, "Sun", light)
    theirs, ours = render_both(scene, render)
    assert theirs.mean() > 0.1
    assert np.allclose(ours.mean(axis=(0, 1)), theirs.mean(axis=(0, 1)), rtol=0.002, atol=0.001)


@pytest.mark.parametrize("axis", ["X", "Y", "Z", "UV_MAP", "Geometry"])
def test_tangents(scene, render, axis):
    thing = board(scene, tilt=0.6)
    tree = Tree(thing)
    if axis == "Geometry":
        output = tree.add("ShaderNodeNewGeometry").outputs["Tangent"]
    elif axis == "UV_MAP":
        output = tree.add("ShaderNodeTangent", direction_type="UV_MAP").outputs[0]
    else:
        output = tree.add("ShaderNodeTangent", axis=axis).outputs[0]
    half = tree.add("ShaderNodeVectorMath", operation="MULTIPLY_ADD")
    tree.link(output, half.inputs[0])
    half.inputs[1].default_value = half.inputs[2].default_value = (0.5, 0.5, 0.5)
    tree.emit(half.outputs[0])
    # Within a square the way about the axis turns, around its end by half a turn: of 16 places a pixel.
    theirs, ours = render_both(scene, render, samples=16)
    assert theirs.std() >= 0.02
    assert rmse(theirs, ours) < 0.02, rmse(theirs, ours)


def _said(capfd):
    out = capfd.readouterr().out
    return "\n".join(line for line in out.splitlines() if "Warning" in line)


@pytest.mark.parametrize(
    "kind, given, output",
    [
        ("ShaderNodeBevel", "Normal", "Normal"),
    ],
)
def test_a_node_that_is_not_evaluated_hands_on_what_it_would_change(
    scene, render, capfd, kind, given, output
):
    tree = Tree(board(scene, 0.1, 0.9))
    node = tree.add(kind)
    value = tree.attribute("A", "Fac" if given == "Strength" else "Vector")
    tree.link(value, node.inputs[given])
    tree.emit(node.outputs[output])
    through = render(scene)
    assert f"node '{node.name}'" in _said(capfd)
    tree.emit(value)
    plain = render(scene)
    assert "is not supported" not in _said(capfd)
    assert all(np.array_equal(through[name], plain[name]) for name in plain)


@pytest.mark.parametrize("modifier", [None, "SUBSURF", "EDGE_SPLIT"])
def test_pointiness(scene, render, modifier):
    """Of what Blender's vertices make, of a subdivision surface too, and of places that are split."""
    bpy.ops.mesh.primitive_monkey_add(size=1.6)
    thing = bpy.context.object
    if modifier:
        made = thing.modifiers.new("Modifier", modifier)
        if modifier == "SUBSURF":
            made.levels = made.render_levels = 2
    tree = Tree(thing)
    seen = tree.add("ShaderNodeMath", operation="MULTIPLY_ADD")
    seen.inputs[1].default_value, seen.inputs[2].default_value = 4.0, -1.5
    tree.link(tree.add("ShaderNodeNewGeometry").outputs["Pointiness"], seen.inputs[0])
    tree.emit(seen.outputs[0])
    scene_parts.add_camera(scene, ortho_scale=2.0)
    scene.render.resolution_x = scene.render.resolution_y = 64
    # Faces are a pixel wide: what varies within is sampled.
    check(scene, render, 64, limit=0.006)


def test_values_on_edges_of_what_blender_subdivides(scene, render):
    """Edges that it makes between those of the cage have none: 0, in means at vertices too."""
    vertices = [(x / 2, y / 2, 0.0) for y in (-2, -1, 0, 1, 2) for x in (-2, -1, 0, 1, 2)]
    faces = [(i, i + 1, i + 6, i + 5) for i in range(19) if i % 5 < 4]
    thing = scene_parts.add_mesh(scene, "Grid", vertices, faces)
    scene_parts.add_subsurf(thing)
    values = thing.data.attributes.new("Wanted", "FLOAT", "EDGE").data
    values.foreach_set("value", np.linspace(0.0, 2.0, len(values), dtype=np.float32))
    tree = Tree(thing)
    tree.emit(tree.attribute("Wanted", "Fac"))
    scene_parts.add_camera(scene, ortho_scale=1.5)
    scene.render.resolution_x = scene.render.resolution_y = 48
    # What varies within a pixel is sampled.
    check(scene, render, 64, limit=0.01)


def test_an_output_that_is_not_evaluated_is_named_where_it_is_linked(scene, render, capfd):
    output = "Parametric"
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeNewGeometry")
    tree.emit(node.outputs["Backfacing"])
    render(scene)
    assert output not in _said(capfd)
    tree.emit(node.outputs[output])
    render(scene)
    assert output in _said(capfd)


@pytest.mark.parametrize("output", ["Pointiness", "Parametric"])
def test_it_is_named_in_worlds_too(scene, render, capfd, output):
    board(scene)
    world = bpy.data.worlds.new("World")
    scene.world, world.use_nodes = world, True
    tree = world.node_tree
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(geometry.outputs[output], tree.nodes["Background"].inputs["Color"])
    render(scene)
    assert output in _said(capfd)
