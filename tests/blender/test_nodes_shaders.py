# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders against Cycles' own output, and trees that have to be flattened."""

import bpy
import numpy as np
import pytest
import scene_parts
from node_comparison import LIMIT, Tree, board, check, render_both, rmse, socket

_HIGH = (0.4, 0.2, 0.0)


def sun(scene, turn=_HIGH):
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = 3.0, 0.0
    # Shadows of leaning squares would end inside pixels.
    scene_parts.cast_no_shadow(light)
    scene_parts.add_object(scene, "Sun", light).rotation_euler = turn


def shown(tree, shader):
    tree.link(shader.outputs[0], tree.output.inputs["Surface"])


def emission(tree, name):
    node = tree.add("ShaderNodeEmission")
    tree.link(tree.attribute(name), node.inputs["Color"])
    return node


@pytest.mark.parametrize("kind", ["ShaderNodeMixShader", "ShaderNodeAddShader"])
def test_mix_and_add_shader(scene, render, kind):
    tree = Tree(board(scene, 0, 1))
    node = tree.add(kind)
    shaders = [target for target in node.inputs if target.type == "SHADER"]
    for name, target in zip("AB", shaders):
        tree.link(emission(tree, name).outputs[0], target)
    if kind == "ShaderNodeMixShader":
        tree.link(tree.attribute("C", "Fac"), node.inputs[0])
    shown(tree, node)
    check(scene, render)


def test_a_shader_that_two_mixes_share(scene, render):
    tree = Tree(board(scene, 0, 1))
    shared = emission(tree, "A")
    mix, add = tree.add("ShaderNodeMixShader"), tree.add("ShaderNodeAddShader")
    tree.link(tree.attribute("C", "Fac"), mix.inputs[0])
    tree.link(shared.outputs[0], mix.inputs[1])
    tree.link(emission(tree, "B").outputs[0], mix.inputs[2])
    tree.link(mix.outputs[0], add.inputs[0])
    tree.link(shared.outputs[0], add.inputs[1])
    shown(tree, add)
    check(scene, render)


def _held_out(tree, clear):
    """By B of each square; `clear`: what else there is lets all light through."""
    mix, other = tree.add("ShaderNodeMixShader"), tree.add("ShaderNodeBsdfTransparent")
    if not clear:
        other = tree.add("ShaderNodeEmission")
    tree.link(tree.attribute("B", "Fac"), mix.inputs[0])
    tree.link(other.outputs[0], mix.inputs[1])
    tree.link(tree.add("ShaderNodeHoldout").outputs[0], mix.inputs[2])
    shown(tree, mix)


@pytest.mark.parametrize("transparent", [False, True])
def test_holdout(scene, render, transparent):
    """Whole and mixed with what is transparent, by turns, before a glowing wall that is smaller."""
    thing = board(scene, 0, 1)
    whole = Tree(thing, "Whole")
    shown(whole, whole.add("ShaderNodeHoldout"))
    _held_out(Tree(thing, "Mixed"), clear=True)
    which = np.arange(len(thing.data.polygons)) % 3 // 2
    thing.data.polygons.foreach_set("material_index", which.astype(np.int32))
    wall = scene_parts.add_square(scene, "Wall", 1.0, (0.3, 0.0, -1.0))
    tree = Tree(wall, "Wall")
    shown(tree, tree.add("ShaderNodeEmission"))
    scene.render.film_transparent = transparent
    theirs, ours = render_both(scene, render, 64, channels="RGBA")
    assert theirs[..., 3].std() > 0.1
    assert rmse(theirs, ours) < LIMIT


@pytest.mark.parametrize("socket", [0, 1])
def test_nothing_added_to_a_holdout(scene, render, socket):
    """Squares that glow by B beside others that cut, though a socket of their Add Shader is empty."""
    thing = board(scene, 0, 1)
    cut, glow = Tree(thing, "Cut"), Tree(thing, "Glow")
    add = cut.add("ShaderNodeAddShader")
    cut.link(cut.add("ShaderNodeHoldout").outputs[0], add.inputs[socket])
    shown(cut, add)
    shown(glow, emission(glow, "B"))
    which = np.arange(len(thing.data.polygons)) % 2
    thing.data.polygons.foreach_set("material_index", which.astype(np.int32))
    scene.render.film_transparent = True
    theirs, ours = render_both(scene, render, channels="RGBA")
    assert theirs[..., 3].std() > 0.1
    assert rmse(theirs, ours) < LIMIT


def test_holdout_among_other_shaders_is_named(scene, render, capfd):
    _held_out(Tree(board(scene, 0, 1), "Mixed"), clear=False)
    render(scene)
    said = capfd.readouterr().out
    assert "'Mixed'" in said and "Holdout is black" in said


def test_mixes_of_mixes_of_the_same_are_looked_at_once(scene, render):
    """Forty of them have 2^40 ways to the one that cuts."""
    tree = Tree(board(scene, 0, 1), "Ladder")
    last = tree.add("ShaderNodeHoldout")
    for _ in range(40):
        mix = tree.add("ShaderNodeMixShader")
        tree.link(last.outputs[0], mix.inputs[1])
        tree.link(last.outputs[0], mix.inputs[2])
        last = mix
    shown(tree, last)
    scene.render.film_transparent = True
    combined = next(v for k, v in render(scene, "GRANITA").items() if k.endswith("Combined.A"))
    assert combined.min() == 0.0


def test_transparent(scene, render):
    """In front of a glowing wall: what passes is the wall's light."""
    thing = board(scene, 0, 1)
    tree = Tree(thing)
    mix, clear = tree.add("ShaderNodeMixShader"), tree.add("ShaderNodeBsdfTransparent")
    tree.link(tree.attribute("B", "Color"), clear.inputs["Color"])
    tree.link(tree.attribute("C", "Fac"), mix.inputs[0])
    tree.link(clear.outputs[0], mix.inputs[1])
    tree.link(emission(tree, "A").outputs[0], mix.inputs[2])
    shown(tree, mix)
    wall = thing.copy()
    wall.data = thing.data.copy()
    wall.data.materials.clear()
    wall.location.z = -1
    scene.collection.objects.link(wall)
    behind = Tree(wall, "Wall")
    shown(behind, emission(behind, "B"))
    scene.cycles.transparent_max_bounces = 8
    scene.granita.opacity_threshold = 1.0
    check(scene, render)


@pytest.mark.parametrize("values", [{}, {"Roughness": "B"}])
def test_diffuse(scene, render, values):
    _lit(scene, render, "ShaderNodeBsdfDiffuse", {"Color": "A", **values})


@pytest.mark.parametrize("distribution", ["GGX", "BECKMANN", "MULTI_GGX"])
def test_glossy(scene, render, distribution):
    _skip_random_walks(distribution)
    kind = "ShaderNodeBsdfGlossy"
    if not hasattr(bpy.types, kind):
        kind = "ShaderNodeBsdfAnisotropic"
    _lit(scene, render, kind, {"Color": "A", "Roughness": "B"}, distribution=distribution)


@pytest.mark.parametrize(
    "values",
    [
        {"Base Color": "A"},
        {"Base Color": "A", "Roughness": "B"},
        {"Base Color": "A", "Metallic": "B"},
        {"Base Color": "A", "Metallic": "B", "Roughness": "C"},
        {"Base Color": "A", "Specular": "B"},
        {"Base Color": "A", "IOR": "B", "Specular": "C"},
    ],
    ids="+".join,
)
@pytest.mark.parametrize("distribution", ["GGX", "MULTI_GGX"])
def test_principled(scene, render, values, distribution):
    _skip_random_walks(distribution)
    _lit(scene, render, "ShaderNodeBsdfPrincipled", values, distribution=distribution)


def _metal(tree, tint, distribution):
    node = tree.add("ShaderNodeBsdfPrincipled", distribution=distribution)
    if node.inputs["Specular Tint"].type != "RGBA":
        pytest.skip("before Blender 4 it is a number, and tints what is no metal")
    node.inputs["Metallic"].default_value = 1.0
    node.inputs["Roughness"].default_value = 0.4
    node.inputs["Specular Tint"].default_value = tint
    shown(tree, node)
    return node


@pytest.mark.parametrize("bright", [False, True])
@pytest.mark.parametrize("distribution", ["GGX", "MULTI_GGX"])
def test_tint_of_metals(scene, render, distribution, bright):
    """Squares that lean far under a low sun: light and view meet them near 82 degrees."""
    tree = Tree(_lit_scene(scene, 1.2, (1.3, 0.2, 0.0)))
    node = _metal(tree, (1.0, 1.0, 1.0, 1.0), distribution)
    tree.link(tree.attribute("B", "Color"), node.inputs["Specular Tint"])
    color = tree.attribute("A", "Color")
    if bright:  # colours beyond 1 reflect no more than all
        scaled = tree.add("ShaderNodeVectorMath", operation="SCALE")
        scaled.inputs["Scale"].default_value = 1.5
        tree.link(color, scaled.inputs[0])
        color = scaled.outputs[0]
    tree.link(color, node.inputs["Base Color"])
    check(scene, render)


@pytest.mark.parametrize("distribution", ["GGX", "MULTI_GGX"])
def test_a_sphere_of_tinted_metal(scene, render, distribution):
    """Lit from behind along its rim, all angles at once."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=0.9)
    ball = bpy.context.object
    ball.data.polygons.foreach_set("use_smooth", [True] * len(ball.data.polygons))
    node = _metal(Tree(ball), (0.2, 0.6, 1.0, 1.0), distribution)
    node.inputs["Base Color"].default_value = (0.9, 0.6, 0.3, 1.0)
    sun(scene, (2.2, 0.3, 0.0))
    scene_parts.add_camera(scene, ortho_scale=2.0)
    scene.render.resolution_x = scene.render.resolution_y = 48
    # Blocks of pixels: along the outline each engine has its own 64 places a pixel.
    theirs, ours = (
        picture.reshape(12, 4, 12, 4, 3).mean(axis=(1, 3))
        for picture in render_both(scene, render, samples=64)
    )
    assert theirs.std() > 0.1
    assert rmse(theirs, ours) < 0.01 * theirs.std()


@pytest.mark.parametrize("roughness", [{}, {"Clearcoat Roughness": "B"}], ids=["even", "varying"])
def test_coat(scene, render, roughness):
    """On black, of strength and roughness that vary; squares lean so far that masking matters."""
    tree = Tree(_lit_scene(scene, 1.2))
    node = _coated(tree, {"Clearcoat": "A", **roughness})
    _input(node, "Base Color").default_value = (0.0, 0.0, 0.0, 1.0)
    _input(node, "Specular").default_value = 0.0
    if bpy.app.version >= (4, 0, 0):
        node.inputs["IOR"].default_value = 1.0
    bpy.data.lights["Sun"].energy = 1000.0
    check(scene, render, relative=True)


@pytest.mark.parametrize("below", ["Emission", "Metallic", "Base Color"])
@pytest.mark.parametrize("tinted", [False, True], ids=["clear", "tinted"])
def test_coat_over_layers(scene, render, below, tinted):
    """Since Blender 4 what the coat reflects does not reach those, and its tint colours them."""
    # In Cycles squares that lean and shine light each other, bounces or not, and lamps are drawn.
    tree = Tree(board(scene, 0.15, 1) if below == "Emission" else _lit_scene(scene, 1.2))
    node = _coated(tree, {"Clearcoat": "A", "Clearcoat Roughness": "B"})
    if tinted:
        if "Coat Tint" not in node.inputs:
            pytest.skip("before Blender 4 coats have no tint")
        node.inputs["Coat Tint"].default_value = (0.8, 0.5, 0.2, 1.0)
    if below == "Emission":
        _input(node, "Emission").default_value = (0.5, 1.0, 2.0, 1.0)
        node.inputs["Emission Strength"].default_value = 1.0
    elif below == "Metallic":
        node.inputs["Metallic"].default_value = 1.0
    tree.link(tree.attribute("C", "Color"), node.inputs["Base Color"])
    check(scene, render)


def _coated(tree, values):
    node = tree.add("ShaderNodeBsdfPrincipled")
    _input(node, "Clearcoat Roughness").default_value = 0.3
    for name, attribute in values.items():
        tree.link(tree.attribute(attribute, "Fac"), _input(node, name))
    shown(tree, node)
    return node


def _skip_random_walks(distribution):
    if distribution == "MULTI_GGX" and bpy.app.version < (4, 0, 0):
        pytest.skip("before Blender 4 Cycles walks at random between facets, since then as we do")


def test_principled_alpha_and_emission(scene, render):
    """Unlit: Cycles chooses at random between the lit surface and what is behind it."""
    tree = Tree(board(scene, 0.15, 1))
    node = tree.add("ShaderNodeBsdfPrincipled")
    tree.link(tree.attribute("A", "Color"), _input(node, "Emission"))
    tree.link(tree.attribute("B", "Fac"), node.inputs["Emission Strength"])
    tree.link(tree.attribute("C", "Fac"), node.inputs["Alpha"])
    shown(tree, node)
    check(scene, render)


_RENAMED = {
    "Specular": "Specular IOR Level",
    "Clearcoat": "Coat Weight",
    "Clearcoat Roughness": "Coat Roughness",
    "Emission": "Emission Color",
}


def _input(node, name):
    """By its name before Blender 4."""
    return node.inputs.get(name) or node.inputs[_RENAMED[name]]


def _lit_scene(scene, tilt, turn=_HIGH):
    sun(scene, turn)
    return board(scene, 0.15, 1, tilt=tilt)


def _lit(scene, render, kind, values, **properties):
    tree = Tree(_lit_scene(scene, 0.3))
    node = tree.add(kind, **properties)
    for name, attribute in values.items():
        target = _input(node, name)
        output = "Color" if target.type == "RGBA" else "Fac"
        tree.link(tree.attribute(attribute, output), target)
    shown(tree, node)
    check(scene, render)


def nested(tree, depth, hide_value=False):
    """`depth` groups in one another; the innermost inverts what comes in, which sockets may not show."""
    inner = None
    for level in range(depth):
        group = bpy.data.node_groups.new(f"Level {level}", "ShaderNodeTree")
        if hasattr(group, "interface"):
            sockets = [
                group.interface.new_socket(name, in_out=way, socket_type="NodeSocketColor")
                for name, way in (("In", "INPUT"), ("Out", "OUTPUT"))
            ]
        else:
            sockets = [group.inputs.new("NodeSocketColor", "In")]
            group.outputs.new("NodeSocketColor", "Out")
        sockets[0].hide_value = hide_value
        start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
        if inner is None:
            node = group.nodes.new("ShaderNodeInvert")
            target = node.inputs["Color"]
        else:
            node = group.nodes.new("ShaderNodeGroup")
            node.node_tree = inner
            target = node.inputs[0]
        group.links.new(start.outputs[0], target)
        group.links.new(node.outputs[0], end.inputs[0])
        inner = group
    node = tree.add("ShaderNodeGroup")
    node.node_tree = inner
    return node


@pytest.mark.parametrize("hide_value", [False, True])
@pytest.mark.parametrize("linked", [False, True])
def test_groups(scene, render, linked, hide_value):
    tree = Tree(board(scene))
    group, mix = nested(tree, 3, hide_value), tree.add("ShaderNodeMixRGB", blend_type="MULTIPLY")
    group.inputs[0].default_value = (0.1, 0.4, 0.7, 1.0)
    if linked:
        tree.link(tree.attribute("A"), group.inputs[0])
    tree.link(group.outputs[0], mix.inputs[1])
    tree.link(tree.attribute("B"), mix.inputs[2])
    tree.emit(mix.outputs[0])
    check(scene, render)


def test_1600_nested_groups_do_not_exhaust_the_stack(scene):
    from granita.export.shading.material import material_record

    tree = Tree(board(scene))
    group = nested(tree, 1600)
    tree.link(tree.attribute("A"), group.inputs[0])
    tree.emit(group.outputs[0])
    record = material_record(tree.material, {}, lambda *warning: pytest.fail(str(warning)))
    kinds = [node["type"] for node in record["nodes"]]
    assert kinds == ["ShaderNodeAttribute", "ShaderNodeInvert", "ShaderNodeEmission"]


@pytest.mark.parametrize(
    "kind", ["ShaderNodeNormalMap", "ShaderNodeGamma", "ShaderNodeMapping", "ShaderNodeCombineXYZ"]
)
def test_a_muted_node_hands_on_no_constant(scene, render, kind):
    """From Blender 5 on it is as if there were no link, before all is black."""
    tree = Tree(board(scene))
    muted = tree.add(kind, mute=True)
    muted.inputs[0].default_value = (
        0.3
        if isinstance(muted.inputs[0].default_value, float)
        else [0.3] * len(muted.inputs[0].default_value)
    )
    tree.emit(muted.outputs[0])
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    emission.inputs["Color"].default_value = (0.2, 0.5, 0.9, 1.0)
    theirs, ours = render_both(scene, render)
    assert theirs.any() == (bpy.app.version >= (5, 0, 0))
    assert rmse(theirs, ours) < LIMIT


def test_mutes_and_reroutes(scene, render):
    tree = Tree(board(scene))
    reroute, muted = tree.add("NodeReroute"), tree.add("ShaderNodeMixRGB", blend_type="MULTIPLY")
    muted.mute = True
    tree.link(tree.attribute("A"), reroute.inputs[0])
    tree.link(reroute.outputs[0], muted.inputs[1])
    tree.link(tree.attribute("B"), muted.inputs[2])
    tree.emit(muted.outputs[0])
    check(scene, render)


def test_conversions_between_sockets(scene, render):
    """Colour to number and vector to number, each its own way."""
    tree = Tree(board(scene))
    node = tree.add("ShaderNodeMath", operation="SUBTRACT")
    tree.link(tree.attribute("A", "Color"), node.inputs[0])
    tree.link(tree.attribute("A", "Vector"), node.inputs[1])
    mix = tree.add("ShaderNodeMath", operation="MULTIPLY_ADD")
    tree.link(node.outputs[0], mix.inputs[0])
    mix.inputs[1].default_value = 3.0
    tree.link(tree.attribute("B"), mix.inputs[2])
    tree.emit(mix.outputs[0])
    check(scene, render)


def test_material_without_nodes_and_no_material(scene, render):
    sun(scene)
    thing = board(scene, tilt=1.0)
    material = bpy.data.materials.new("Plain")
    material.use_nodes = False
    material.diffuse_color = (0.9, 0.3, 0.1, 1.0)
    if not material.use_nodes:  # Blender 5 has nodes always
        thing.data.materials.append(material)
    check(scene, render)


def test_empty_slots_among_others(scene, render):
    """A slot without a material, and things without a slot, beside one that has its own."""
    sun(scene)
    thing = board(scene, 0, 1)
    Tree(thing)
    glow = Tree(thing, "Glow")
    shown(glow, emission(glow, "A"))
    thing.data.materials[0] = None
    thing.data.polygons.foreach_set("material_index", [i % 2 for i in range(256)])
    bare = scene_parts.add_square(scene, "Bare", 0.5, (0.0, 0.0, 2.0))
    bare.rotation_euler = (0.0, 0.2, 0.0)
    theirs, ours = render_both(scene, render, samples=16)
    assert theirs.std() > 0.1
    # The edges of the bare square, of which each engine has its own samples.
    assert np.median(np.abs(theirs - ours)) < 1e-4
    assert rmse(theirs, ours) < 0.02


def test_unknown_node_is_told_once(scene, render):
    from granita.export import export_frame

    granita_core = pytest.importorskip("granita_core")
    tree = Tree(board(scene))
    tree.emit(tree.add("ShaderNodeBevel", name="Swirl").outputs["Normal"])
    snapshot = export_frame(None, bpy.context.evaluated_depsgraph_get(), scene.granita, print)
    warnings = granita_core.render(snapshot)["warnings"]
    about = [w for w in warnings if "Swirl" in w[1]]
    assert len(about) == 1 and about[0][0] == "material 'Material'" and about[0][2] == 1


def test_render_both_sees_differences(scene, render):
    """The comparison itself can fail."""
    tree = Tree(board(scene))
    tree.emit(tree.attribute("A"))
    theirs, ours = render_both(scene, render)
    assert rmse(theirs, ours[::-1]) > 0.1
    assert socket(tree.output.inputs, "Surface").is_linked
