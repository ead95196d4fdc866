# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of numbers and colours against Cycles' own output (node_comparison.py): every value of their
enums, inputs that vary."""

from time import thread_time

import bpy
import pytest
import scene_parts
from node_comparison import Tree, board, check, enum_values, socket

RADIANS = {"low": -150.0, "high": 150.0}  # degrees that are worth converting


@pytest.mark.parametrize("clamp", [False, True])
@pytest.mark.parametrize("operation", enum_values("ShaderNodeMath", "operation"))
def test_math(scene, render, operation, clamp):
    if operation == "COSH" and clamp:
        pytest.skip("never below 1: clamped it is constant")
    tree = Tree(board(scene, **(RADIANS if operation == "RADIANS" else {})))
    node = tree.add("ShaderNodeMath", operation=operation, use_clamp=clamp)
    for name, target in zip("ABC", node.inputs):
        tree.link(tree.attribute(name, "Fac"), target)
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("operation", enum_values("ShaderNodeVectorMath", "operation"))
def test_vector_math(scene, render, operation):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeVectorMath", operation=operation)
    names = iter("ABC")
    for target in node.inputs:
        if target.enabled:
            name = "C" if target.identifier == "Scale" else next(names)
            tree.link(tree.attribute(name), target)
    tree.emit(next(output for output in node.outputs if output.enabled))
    check(scene, render)


@pytest.mark.parametrize("clamp", [False, True])
@pytest.mark.parametrize("blend", enum_values("ShaderNodeMixRGB", "blend_type"))
def test_mix_rgb(scene, render, blend, clamp):
    tree = Tree(board(scene, -0.2, 1.4))
    node = tree.add("ShaderNodeMixRGB", blend_type=blend, use_clamp=clamp)
    for name, output, target in zip("CAB", ("Fac", "Color", "Color"), node.inputs):
        tree.link(tree.attribute(name, output), target)
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("clamp", [False, True])
@pytest.mark.parametrize(
    "mode", ["FLOAT", "UNIFORM", "NON_UNIFORM", "MIX", "LINEAR_LIGHT", "EXCLUSION"]
)
def test_mix(scene, render, mode, clamp):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeMix", clamp_factor=clamp)
    suffix = "Float"
    if mode in ("UNIFORM", "NON_UNIFORM"):
        node.data_type, node.factor_mode, suffix = "VECTOR", mode, "Vector"
    elif mode != "FLOAT":
        if mode not in enum_values("ShaderNodeMix", "blend_type"):
            pytest.skip(f"this Blender has no {mode}")
        node.data_type, node.blend_type, node.clamp_result, suffix = "RGBA", mode, clamp, "Color"
    factor = "Factor_Vector" if mode == "NON_UNIFORM" else "Factor_Float"
    for name, target in zip("CAB", (factor, f"A_{suffix}", f"B_{suffix}")):
        tree.link(tree.attribute(name), socket(node.inputs, target))
    tree.emit(socket(node.outputs, f"Result_{suffix}"))
    check(scene, render)


@pytest.mark.parametrize("mode", ["RGB", "HSV", "HSL"])
@pytest.mark.parametrize("interpolation", ["EASE", "CARDINAL", "LINEAR", "B_SPLINE", "CONSTANT"])
def test_color_ramp(scene, render, mode, interpolation):
    if mode != "RGB" and interpolation != "LINEAR":
        pytest.skip("hue modes have interpolations of their own")
    tree = Tree(board(scene, -0.2, 1.2))
    node = tree.add("ShaderNodeValToRGB")
    _three_stops(node.color_ramp)
    node.color_ramp.color_mode = mode
    if mode == "RGB":
        node.color_ramp.interpolation = interpolation
    tree.link(tree.attribute("A", "Fac"), node.inputs[0])
    tree.emit(node.outputs["Color"])
    check(scene, render)


@pytest.mark.parametrize("hue", ["NEAR", "FAR", "CW", "CCW"])
@pytest.mark.parametrize("mode", ["HSV", "HSL"])
def test_color_ramp_hue(scene, render, mode, hue):
    tree = Tree(board(scene, -0.2, 1.2))
    node = tree.add("ShaderNodeValToRGB")
    _three_stops(node.color_ramp)
    node.color_ramp.color_mode = mode
    node.color_ramp.hue_interpolation = hue
    tree.link(tree.attribute("A", "Fac"), node.inputs[0])
    tree.emit(node.outputs["Color"])
    check(scene, render)


def test_color_ramp_alpha(scene, render):
    tree = Tree(board(scene, 0, 1))
    node = tree.add("ShaderNodeValToRGB")
    _three_stops(node.color_ramp)
    tree.link(tree.attribute("A", "Fac"), node.inputs[0])
    tree.emit(node.outputs["Alpha"])
    check(scene, render)


def _three_stops(ramp):
    ramp.elements[0].color = (0.9, 0.1, 0.2, 0.0)
    ramp.elements[1].color = (0.1, 0.7, 0.9, 1.0)
    ramp.elements.new(0.4).color = (0.2, 0.9, 0.1, 0.9)


def test_rgb_curves(scene, render):
    tree = Tree(board(scene, -0.3, 1.3))
    node = tree.add("ShaderNodeRGBCurve")
    for i, curve in enumerate(node.mapping.curves):
        curve.points.new(0.3 + 0.1 * i, 0.8 - 0.2 * i)
    node.mapping.update()
    tree.link(tree.attribute("A"), node.inputs["Color"])
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("kind", enum_values("ShaderNodeMapping", "vector_type"))
def test_mapping(scene, render, kind):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeMapping", vector_type=kind)
    tree.link(tree.attribute("A"), node.inputs["Vector"])
    tree.link(tree.attribute("B"), node.inputs["Rotation"])
    if kind in ("POINT", "TEXTURE"):
        tree.link(tree.attribute("C"), node.inputs["Location"])
    node.inputs["Scale"].default_value = (0.6, -1.3, 2.0)
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("mode", enum_values("ShaderNodeSeparateColor", "mode"))
@pytest.mark.parametrize("component", [0, 1, 2])
def test_separate_color(scene, render, mode, component):
    tree = Tree(board(scene, 0, 1))
    node = tree.add("ShaderNodeSeparateColor", mode=mode)
    tree.link(tree.attribute("A"), node.inputs[0])
    tree.emit(node.outputs[component])
    check(scene, render)


@pytest.mark.parametrize("mode", enum_values("ShaderNodeCombineColor", "mode"))
def test_combine_color(scene, render, mode):
    tree = Tree(board(scene, 0, 1))
    node = tree.add("ShaderNodeCombineColor", mode=mode)
    for name, target in zip("ABC", node.inputs):
        tree.link(tree.attribute(name, "Fac"), target)
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize(
    "separate, combine",
    [("SeparateXYZ", "CombineXYZ"), ("SeparateRGB", "CombineRGB"), ("SeparateHSV", "CombineHSV")],
)
def test_separate_then_combine_turned(scene, render, separate, combine):
    if not hasattr(bpy.types, f"ShaderNode{separate}"):
        pytest.skip("this Blender has no such node")
    tree = Tree(board(scene, 0, 1))
    apart, together = tree.add(f"ShaderNode{separate}"), tree.add(f"ShaderNode{combine}")
    tree.link(tree.attribute("A"), apart.inputs[0])
    for i in range(3):
        tree.link(apart.outputs[i], together.inputs[(i + 1) % 3])
    tree.emit(together.outputs[0])
    check(scene, render)


@pytest.mark.parametrize(
    "kind, numbers",
    [
        ("ShaderNodeGamma", {"Gamma": "B"}),
        ("ShaderNodeInvert", {"Fac": "B"}),
        ("ShaderNodeBrightContrast", {"Bright": "B", "Contrast": "C"}),
        ("ShaderNodeHueSaturation", {"Hue": "B", "Saturation": "C", "Fac": "B", "Value": "C"}),
        ("ShaderNodeRGBToBW", {}),
    ],
)
def test_color_adjustments(scene, render, kind, numbers):
    tree = Tree(board(scene, 0, 3 if kind == "ShaderNodeInvert" else 1))
    node = tree.add(kind)
    tree.link(tree.attribute("A"), node.inputs["Color"])
    for target, name in numbers.items():
        tree.link(tree.attribute(name, "Fac"), socket(node.inputs, target))
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("kind", enum_values("ShaderNodeMapRange", "interpolation_type"))
def test_map_range(scene, render, kind):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeMapRange", interpolation_type=kind)
    tree.link(tree.attribute("A", "Fac"), node.inputs["Value"])
    tree.link(tree.attribute("B", "Fac"), node.inputs["To Min"])
    node.inputs["From Min"].default_value = -0.4
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("clamp", [True, False])
@pytest.mark.parametrize("kind", enum_values("ShaderNodeMapRange", "interpolation_type"))
def test_map_range_of_vectors(scene, render, kind, clamp):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeMapRange", interpolation_type=kind, data_type="FLOAT_VECTOR")
    node.clamp = clamp
    inputs = {socket.identifier: socket for socket in node.inputs}
    tree.link(tree.attribute("A"), inputs["Vector"])
    tree.link(tree.attribute("B"), inputs["To_Min_FLOAT3"])
    inputs["From_Min_FLOAT3"].default_value = (-0.4, 0.2, 1.0)  # the last without length
    inputs["Steps_FLOAT3"].default_value = (3.0, 0.0, 5.0)
    tree.emit(next(socket for socket in node.outputs if socket.identifier == "Vector"))
    check(scene, render)


@pytest.mark.parametrize("kind", enum_values("ShaderNodeClamp", "clamp_type"))
def test_clamp(scene, render, kind):
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeClamp", clamp_type=kind)
    for name, target in zip("ABC", node.inputs):
        tree.link(tree.attribute(name, "Fac"), target)
    tree.emit(node.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("output", ["Color", "Vector", "Fac"])
def test_attribute(scene, render, output):
    tree = Tree(board(scene))
    tree.emit(tree.attribute("A", output))
    check(scene, render)


def test_value_and_rgb(scene, render):
    tree = Tree(board(scene))
    value, color = tree.add("ShaderNodeValue"), tree.add("ShaderNodeRGB")
    value.outputs[0].default_value = 0.7
    color.outputs[0].default_value = (0.2, 0.9, 0.4, 1.0)
    mix = tree.add("ShaderNodeMixRGB", blend_type="MULTIPLY")
    tree.link(value.outputs[0], mix.inputs[0])
    tree.link(tree.attribute("A"), mix.inputs[1])
    tree.link(color.outputs[0], mix.inputs[2])
    tree.emit(mix.outputs[0])
    check(scene, render)


@pytest.mark.parametrize("kind", ["Fresnel", "Facing", "IOR"])
def test_fresnel_and_layer_weight(scene, render, kind):
    tree = Tree(board(scene, -1, 1))
    normal = tree.add("ShaderNodeVectorMath", operation="NORMALIZE")
    tree.link(tree.attribute("A"), normal.inputs[0])
    if kind == "IOR":
        node = tree.add("ShaderNodeFresnel")
        node.inputs["IOR"].default_value = 4.0
    else:
        node = tree.add("ShaderNodeLayerWeight")
        tree.link(tree.attribute("B", "Fac"), node.inputs["Blend"])
    tree.link(normal.outputs[0], node.inputs["Normal"])
    tree.emit(node.outputs[0 if kind == "IOR" else kind])
    check(scene, render)


def test_long_chains_are_exported_in_proportion(scene):
    """Blender's own list of a socket's links walks over all links of the tree: four times the nodes took 14 times
    the seconds."""

    def seconds(count):
        material, nodes, links, output = scene_parts.node_material("Chain")
        previous = None
        for _ in range(count):
            node = nodes.new("ShaderNodeMath")
            if previous is not None:
                links.new(previous.outputs[0], node.inputs[0])
            previous = node
        emission = nodes.new("ShaderNodeEmission")
        links.new(previous.outputs[0], emission.inputs["Strength"])
        links.new(emission.outputs[0], output.inputs["Surface"])
        return min(_export_seconds(material) for _ in range(5))

    assert seconds(1200) < 8 * seconds(300)


def _export_seconds(material):
    from granita.export.shading.material import export_materials

    started = thread_time()  # what else runs on the machine does not count
    export_materials([material], print)
    return thread_time() - started
