# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of Blender 5 that say how a tree is made, and those of integers, booleans and time that are left when it
is; against Cycles."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from node_comparison import Tree, board, check, enum_values, render_both

pytestmark = pytest.mark.skipif(
    not hasattr(bpy.types, "InlineShaderNodes"), reason="trees are made by nodes since Blender 5"
)

is_newest = pytest.mark.skipif(
    not hasattr(bpy.types, "FunctionNodeIntegerMath") or bpy.app.version < (5, 3),
    reason="in shaders since Blender 5.3",
)


def numbers(tree, name, scale):
    """A number a square, of either sign."""
    scaled = tree.add("ShaderNodeMath", operation="MULTIPLY")
    tree.link(tree.attribute(name, "Fac"), scaled.inputs[0])
    scaled.inputs[1].default_value = scale
    return scaled.outputs[0]


def math_of(kind):
    return enum_values(kind, "operation") if hasattr(bpy.types, kind) else []


@is_newest
@pytest.mark.parametrize("operation", math_of("FunctionNodeIntegerMath"))
def test_integer_math(scene, render, operation):
    tree = Tree(board(scene))
    node = tree.add("FunctionNodeIntegerMath", operation=operation)
    for place, name in enumerate("ABC"[: len(node.inputs)]):
        tree.link(numbers(tree, name, 5.0), node.inputs[place])
    tree.emit(node.outputs[0])
    check(scene, render)


@is_newest
@pytest.mark.parametrize("operation", math_of("FunctionNodeBooleanMath"))
def test_boolean_math(scene, render, operation):
    tree = Tree(board(scene))
    node = tree.add("FunctionNodeBooleanMath", operation=operation)
    for place, socket in enumerate(node.inputs):
        if socket.enabled:
            tree.link(numbers(tree, "AB"[place], 1.0), socket)
    tree.emit(node.outputs[0])
    check(scene, render)


@is_newest
@pytest.mark.parametrize("index", [0, 1, 2, None])
def test_vector_component(scene, render, index):
    tree = Tree(board(scene, -0.5, 2.5))
    node = tree.add("FunctionNodeGetVectorComponent")
    tree.link(tree.attribute("A", "Vector"), node.inputs["Vector"])
    if index is None:
        tree.link(tree.attribute("B", "Fac"), node.inputs["Index"])
    else:
        node.inputs["Index"].default_value = index
    tree.emit(node.outputs[0])
    check(scene, render)


@is_newest
def test_scene_time(scene, render):
    scene.render.fps, scene.render.fps_base = 30, 1.25
    scene.frame_set(7)
    tree = Tree(board(scene))
    node, both = tree.add("GeometryNodeInputSceneTime"), tree.add("ShaderNodeCombineXYZ")
    for name, place in (("Seconds", 0), ("Frame", 1)):
        tree.link(node.outputs[name], both.inputs[place])
    tree.emit(both.outputs[0])
    theirs, ours = render_both(scene, render)
    np.testing.assert_allclose(ours[16, 16], (7 * 1.25 / 30, 7.0, 0.0), rtol=1e-5)
    np.testing.assert_allclose(theirs[16, 16], ours[16, 16], rtol=1e-5)


def repeat_zone(tree):
    """Three times + B / 3."""
    begin, end = tree.add("GeometryNodeRepeatInput"), tree.add("GeometryNodeRepeatOutput")
    begin.pair_with_output(end)
    end.repeat_items.clear()
    end.repeat_items.new("FLOAT", "Sum")
    begin.inputs["Iterations"].default_value = 3
    add = tree.add("ShaderNodeMath")
    tree.link(tree.attribute("A", "Fac"), begin.inputs["Sum"])
    tree.link(begin.outputs["Sum"], add.inputs[0])
    tree.link(numbers(tree, "B", 1 / 3), add.inputs[1])
    tree.link(add.outputs[0], end.inputs["Sum"])
    return end.outputs["Sum"]


def menu(tree):
    """B, of A and B."""
    node = tree.add("GeometryNodeMenuSwitch")
    node.data_type = "FLOAT"
    for name in "AB":
        tree.link(tree.attribute(name, "Fac"), node.inputs[name])
    node.inputs["Menu"].default_value = "B"
    return node.outputs["Output"]


def closure(tree):
    """A + B, where it is asked for."""
    begin, end = tree.add("NodeClosureInput"), tree.add("NodeClosureOutput")
    begin.pair_with_output(end)
    end.input_items.new("FLOAT", "In")
    end.output_items.new("FLOAT", "Out")
    add = tree.add("ShaderNodeMath")
    tree.link(begin.outputs["In"], add.inputs[0])
    tree.link(tree.attribute("B", "Fac"), add.inputs[1])
    tree.link(add.outputs[0], end.inputs["Out"])
    asked = tree.add("NodeEvaluateClosure")
    asked.input_items.new("FLOAT", "In")
    asked.output_items.new("FLOAT", "Out")
    tree.link(end.outputs[0], asked.inputs["Closure"])
    tree.link(tree.attribute("A", "Fac"), asked.inputs["In"])
    return asked.outputs["Out"]


def bundle(tree):
    together, apart = tree.add("NodeCombineBundle"), tree.add("NodeSeparateBundle")
    for node in (together, apart):
        for name in "AB":
            node.bundle_items.new("FLOAT", name)
    for name in "AB":
        tree.link(tree.attribute(name, "Fac"), together.inputs[name])
    tree.link(together.outputs[0], apart.inputs[0])
    return apart.outputs["B"]


def switch(tree):
    node = tree.add("GeometryNodeSwitch", input_type="FLOAT")
    for name, place in (("C", "Switch"), ("A", "False"), ("B", "True")):
        tree.link(tree.attribute(name, "Fac"), node.inputs[place])
    return node.outputs[0]


SINCE = {switch: (5, 3)}


def test_every_node_that_makes_trees_is_known():
    """By the beginning of its name; the others are of shaders, or what any tree has."""
    from granita.export.shading.inlined_tree import _MAKERS

    plain = "ShaderNode", "NodeGroup", "NodeReroute", "NodeFrame", "NodeComment"
    material = bpy.data.materials.new("Look")
    for name in dir(bpy.types):
        kind = getattr(bpy.types, name)
        if not isinstance(kind, type) or not issubclass(kind, bpy.types.Node):
            continue
        if name.startswith((*plain, *_MAKERS)):
            continue
        with pytest.raises(RuntimeError):
            material.node_tree.nodes.new(name)


@pytest.mark.parametrize("made", [repeat_zone, menu, closure, bundle, switch])
@pytest.mark.parametrize("grouped", [False, True])
def test_trees_that_nodes_make(scene, render, made, grouped):
    tree = Tree(board(scene, 0.1, 1.0))
    try:
        if grouped:
            inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
            inner.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketFloat")
            outer, tree.nodes, tree.links = (tree.nodes, tree.links), inner.nodes, inner.links
            shown = made(tree)
            tree.link(shown, tree.add("NodeGroupOutput").inputs[0])
            tree.nodes, tree.links = outer
            group = tree.add("ShaderNodeGroup", node_tree=inner)
            shown = group.outputs[0]
        else:
            shown = made(tree)
    except RuntimeError:
        # "Cannot add node of type ..." to a tree of shaders.
        assert bpy.app.version < SINCE.get(made, (5, 0)), made
        pytest.skip("later in shaders")
    tree.emit(shown)
    check(scene, render)
    assert export_probe.through_script()[1].entries() == []


@is_newest
def test_worlds_and_lights_of_such_trees(scene, render):
    """A world of .3 + .2, a sun of 1 + 1."""
    tree = Tree(board(scene))
    tree.links.new(tree.add("ShaderNodeBsdfDiffuse").outputs[0], tree.output.inputs["Surface"])
    scene_parts.set_world(scene, (1.0, 1.0, 1.0))
    lamp = bpy.data.lights.new("Sun", "SUN")
    lamp.energy, lamp.angle = 1.0, 0.0
    scene_parts.add_object(scene, "Sun", lamp)
    strengths = (
        (scene.world.node_tree, "Background", "ShaderNodeMath", (0.3, 0.2)),
        (lamp.node_tree, "Emission", "FunctionNodeIntegerMath", (1, 1)),
    )
    for made, name, kind, values in strengths:
        chosen, add = made.nodes.new("GeometryNodeSwitch"), made.nodes.new(kind)
        chosen.input_type = "FLOAT"
        chosen.inputs["Switch"].default_value = True
        for place, value in enumerate(values):
            add.inputs[place].default_value = value
        made.links.new(add.outputs[0], chosen.inputs["True"])
        made.links.new(chosen.outputs[0], made.nodes[name].inputs["Strength"])
    scene.granita.light_samples = 64
    theirs, ours = render_both(scene, render, samples=64)
    assert theirs.mean() == pytest.approx(0.8 * (0.5 + 2.0 / np.pi), rel=0.01)
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.01)


@is_newest
def test_the_time_in_a_lamp(scene, render):
    """Strength: the frame."""
    scene.frame_set(3)
    tree = Tree(board(scene, tilt=0.4))
    tree.links.new(tree.add("ShaderNodeBsdfDiffuse").outputs[0], tree.output.inputs["Surface"])
    lamp = bpy.data.lights.new("Sun", "SUN")
    lamp.energy, lamp.angle = 0.3, 0.0
    scene_parts.cast_no_shadow(lamp)
    scene_parts.add_object(scene, "Sun", lamp).rotation_euler = (0.7, 0.2, 0.0)
    time = lamp.node_tree.nodes.new("GeometryNodeInputSceneTime")
    lamp.node_tree.links.new(
        time.outputs["Frame"], lamp.node_tree.nodes["Emission"].inputs["Strength"]
    )
    theirs, ours = render_both(scene, render)
    assert theirs.mean() > 0.1
    np.testing.assert_allclose(ours, theirs, atol=0.002)
