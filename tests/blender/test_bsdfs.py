# SPDX-License-Identifier: GPL-3.0-or-later
"""BSDFs against Cycles' own: boards whose squares have a material each in turn, lean, show their fronts and backs,
and are lit by one sun from before or behind.  A sun has no size here, so that no engine draws anything by chance."""

import bpy
import numpy as np
import pytest
import scene_parts
from hair_parts import curve_through, give_material
from node_comparison import LIMIT, SQUARES, Tree, board, render_both, rmse
from test_nodes_shaders import shown, sun

_SINCE_4 = bpy.app.version >= (4, 0, 0)
# Before, Cycles walks at random between facets.
_MULTI = ("MULTI_GGX",) if _SINCE_4 else ()
BEFORE, BEHIND = (0.4, 0.2, 0.0), (0.4 + np.pi, 0.2, 0.0)
ASIDE = (np.pi - 1.2, 0.2, 0.0)  # behind
_RENAMED = {"Transmission": "Transmission Weight", "Sheen": "Sheen Weight"}


def node(tree, kind, values, **properties):
    """A shader whose sockets are given constants or attributes; (name, scale, offset) is one that is changed."""
    made = tree.add(kind, **properties)
    for name, value in values.items():
        target = made.inputs.get(name) or made.inputs[_RENAMED[name]]
        if isinstance(value, str):
            tree.link(tree.attribute(value, "Color" if target.type == "RGBA" else "Fac"), target)
        elif isinstance(value, tuple) and isinstance(value[0], str):
            math = tree.add("ShaderNodeMath", operation="MULTIPLY_ADD")
            tree.link(tree.attribute(value[0], "Fac"), math.inputs[0])
            math.inputs[1].default_value, math.inputs[2].default_value = value[1:]
            tree.link(math.outputs[0], target)
        else:
            target.default_value = value
    return made


def compare(scene, render, kinds, turn, tilt=0.3, low=0.15):
    """Per kind (RMSE, deviation) over its squares.

    `kinds`: {name: function of a tree that returns a shader}.
    """
    sun(scene, turn)
    # Cycles leaves out some faint light, by chance.
    scene.cycles.light_sampling_threshold = 0.0
    thing = board(scene, low, 1, tilt=tilt, both_sides=True)
    for name, build in kinds.items():
        tree = Tree(thing, name)
        shown(tree, build(tree))
    # By turns over fronts and backs alike, which change each square.
    which = (np.arange(SQUARES * SQUARES) // 2) % len(kinds)
    thing.data.polygons.foreach_set("material_index", which)
    theirs, ours = render_both(scene, render)
    rows = which.reshape(SQUARES, SQUARES).repeat(2, axis=0).repeat(2, axis=1)
    report = {}
    for k, name in enumerate(kinds):
        mine = rows == k
        report[name] = (rmse(theirs[mine], ours[mine]), float(theirs[mine].std()))
    return report


def check(report, limits=None):
    """Errors are relative to the deviation where that is more than 1."""
    limits = limits or {}
    weak = {name: pair for name, pair in report.items() if pair[1] < 0.005}
    assert not weak, weak
    wrong = {
        name: pair
        for name, pair in report.items()
        if pair[0] > limits.get(name, LIMIT) * max(pair[1], 1.0)
    }
    assert not wrong, "\n" + "\n".join(f"{n} {p}" for n, p in report.items())


def _glasses():
    kinds = {}
    values = {"Color": "A", "Roughness": ("B", 0.8, 0.2), "IOR": ("C", 0.85, 1.02)}
    for distribution in ("GGX", "BECKMANN") + _MULTI:
        kinds[f"Glass {distribution}"] = lambda tree, d=distribution: node(
            tree, "ShaderNodeBsdfGlass", values, distribution=d
        )
    for distribution in ("GGX", "BECKMANN"):
        kinds[f"Refraction {distribution}"] = lambda tree, d=distribution: node(
            tree, "ShaderNodeBsdfRefraction", values, distribution=d
        )
    principled = {
        "Base Color": "A",
        "Roughness": ("B", 0.8, 0.2),
        "IOR": ("C", 0.8, 1.05),
        "Transmission": ("C", -0.5, 1.0),
    }
    for distribution in ("GGX",) + _MULTI:
        kinds[f"Principled {distribution}"] = lambda tree, d=distribution: node(
            tree, "ShaderNodeBsdfPrincipled", principled, distribution=d
        )
    if not _SINCE_4:
        rough = {**principled, "Transmission Roughness": "B", "Specular Tint": 0.5, "Metallic": 0.2}
        kinds["Principled, rough inside"] = lambda tree: node(
            tree, "ShaderNodeBsdfPrincipled", rough, distribution="GGX"
        )
    return kinds


@pytest.mark.parametrize("turn", [BEFORE, BEHIND], ids=["before", "behind"])
def test_glass_and_refraction(scene, render, turn):
    report = compare(scene, render, _glasses(), turn)
    if turn is BEFORE:  # where refraction has nothing to show
        report = {name: pair for name, pair in report.items() if "Refraction" not in name}
    check(report)


def test_more_than_facets_can_refract(scene, render):
    """Frosted glass of a low index passes on light from far aside, in Cycles: little, but from all around.  Of all
    that there is here nothing was there (RMSE .07)."""
    values = {"Color": (1.0, 1.0, 1.0, 1.0), "Roughness": ("B", 0.8, 0.2), "IOR": ("C", 0.1, 1.02)}
    kinds = {
        name: lambda tree, kind=kind: node(tree, kind, values, distribution="GGX")
        for name, kind in (
            ("Glass", "ShaderNodeBsdfGlass"),
            ("Refraction", "ShaderNodeBsdfRefraction"),
        )
    }
    for name, (error, deviation) in compare(scene, render, kinds, ASIDE, tilt=0.1).items():
        assert deviation > 0.001
        assert error < 0.02 * deviation, name


def test_the_world_behind_one_sharp_surface(scene, render):
    """Each square bends the view its own way."""
    thing = board(scene, 0.15, 1, tilt=0.3, both_sides=True)
    tree = Tree(thing)
    shown(
        tree,
        node(
            tree,
            "ShaderNodeBsdfRefraction",
            # White: Cycles ends darker paths by chance.
            {"Color": (1.0, 1.0, 1.0, 1.0), "Roughness": 0.0, "IOR": ("B", 0.8, 0.9)},
        ),
    )
    world = bpy.data.worlds.new("World")
    if world.node_tree is None:
        world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    place = nodes.new("ShaderNodeTexCoord")
    away = nodes.new("ShaderNodeVectorMath")
    away.operation = "ADD"
    away.inputs[1].default_value = (1.5, 1.5, 1.5)
    links.new(place.outputs["Generated"], away.inputs[0])
    links.new(away.outputs[0], nodes["Background"].inputs["Color"])
    scene.world = world
    theirs, ours = render_both(scene, render)
    # On the squares' diagonals Cycles' rays meet the square's other triangle; close to an edge a ray meets the next
    # square, and each engine has its own place in a pixel.
    free = theirs.any(axis=-1) & ours.any(axis=-1)
    assert ours.any(axis=-1).mean() > 0.99
    assert free.mean() > 0.9
    assert theirs[free].std() > 0.05
    assert rmse(theirs[free], ours[free]) < LIMIT


def _cloths_and_cartoons():
    grey = {"Color": "A"}
    kinds = {
        "Translucent": lambda tree: node(tree, "ShaderNodeBsdfTranslucent", grey),
        "Toon": lambda tree: node(
            tree,
            "ShaderNodeBsdfToon",
            {**grey, "Size": ("B", 0.4, 0.1), "Smooth": ("C", 0.4, 0.05)},
        ),
        "Glossy Toon": lambda tree: node(
            tree,
            "ShaderNodeBsdfToon",
            # Together less than a right angle: past it Blender 3.4 cuts nothing off.
            {**grey, "Size": ("B", 0.4, 0.1), "Smooth": ("C", 0.4, 0.05)},
            component="GLOSSY",
        ),
    }
    if _SINCE_4:
        kinds["Velvet"] = lambda tree: node(
            tree, "ShaderNodeBsdfSheen", {**grey, "Roughness": "B"}, distribution="ASHIKHMIN"
        )
        kinds["Sheen"] = lambda tree: node(
            tree, "ShaderNodeBsdfSheen", {**grey, "Roughness": ("B", 0.7, 0.3)}
        )
    else:
        kinds["Velvet"] = lambda tree: node(
            tree, "ShaderNodeBsdfVelvet", {**grey, "Sigma": ("B", 0.8, 0.2)}
        )
    kinds["Principled"] = lambda tree: node(
        tree,
        "ShaderNodeBsdfPrincipled",
        {
            "Base Color": "A",
            "Roughness": 0.4,
            "Sheen": "B",
            "Sheen Tint": ((0.9, 0.6, 0.3, 1.0) if _SINCE_4 else 0.6),
        },
        distribution="GGX",
    )
    return kinds


@pytest.mark.parametrize("turn", [BEFORE, BEHIND], ids=["before", "behind"])
def test_cloth_toon_and_translucent(scene, render, turn):
    # Squares that lean far: cloth shines where it is grazed.
    report = compare(scene, render, _cloths_and_cartoons(), turn, tilt=1.2)
    if turn is BEHIND:
        report = {"Translucent": report["Translucent"]}
    else:
        report.pop("Translucent")
    check(report)


@pytest.mark.skipif(not _SINCE_4, reason="velvet is not seen from below")
@pytest.mark.parametrize("kind", ["ShaderNodeBsdfSheen", "ShaderNodeBsdfPrincipled"])
def test_sheen_where_smooth_normals_turn_from_the_eye(scene, render, kind):
    """The ends of a coarse cone that is shaded smooth, seen at a slant, were dark."""
    corners = [(np.cos(a), np.sin(a), -1.0) for a in np.arange(6) * np.pi / 3]
    corners += [(0.4 * x, 0.4 * y, 0.6) for x, y, _ in corners]
    sides = [(i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i) for i in range(6)]
    thing = scene_parts.add_mesh(
        scene, "Cone", corners, [*sides, (5, 4, 3, 2, 1, 0), (6, 7, 8, 9, 10, 11)]
    )
    thing.rotation_euler = (1.4, 0.3, 0.2)
    thing.data.polygons.foreach_set("use_smooth", [True] * 8)
    tree = Tree(thing)
    values = {"Sheen Weight": 1.0, "Transmission Weight": 1.0} if "Principled" in kind else {}
    shown(tree, node(tree, kind, {**values, "Roughness": 0.5}))
    sun(scene, BEFORE)
    scene_parts.add_camera(scene, ortho_scale=3.0)
    theirs, ours = render_both(scene, render, samples=64)
    assert theirs.std() > 0.05
    assert rmse(theirs, ours) < LIMIT, rmse(theirs, ours)


@pytest.mark.skipif(_SINCE_4, reason="since Blender 4 tints are colours")
def test_tints_by_the_base_colour(scene, render):
    """Saturated ones, by whose luminance they are divided."""
    kinds = {}
    for color in ((0.8, 0.1, 0.1, 1.0), (0.1, 0.8, 0.1, 1.0), (0.1, 0.1, 0.8, 1.0)):
        values = {"Base Color": color, "Roughness": ("B", 0.5, 0.3)}
        for name, more in {
            "Specular": {"Specular": 1.0, "Specular Tint": "C"},
            "Sheen": {"Specular": 0.0, "Sheen": 1.0, "Sheen Tint": "C"},
        }.items():
            kinds[f"{name} of {color}"] = lambda tree, v={**values, **more}: node(
                tree, "ShaderNodeBsdfPrincipled", v, distribution="GGX"
            )
    check(compare(scene, render, kinds, BEFORE, tilt=0.8))


def _brushed():
    values = {"Color": "A", "Roughness": ("B", 0.6, 0.2), "Anisotropy": ("C", 1.6, -0.9)}
    principled = {
        "Base Color": "A",
        "Roughness": ("B", 0.6, 0.2),
        "Anisotropic": "C",
        "Anisotropic Rotation": 0.3,
        "Metallic": 0.5,
    }

    def along(kind, values, **properties):
        """Tangents that are one a square; by default they turn within."""

        def build(tree):
            made = node(tree, kind, values, **properties)
            tree.link(tree.attribute("B", "Vector"), made.inputs["Tangent"])
            return made

        return build

    glossy = "ShaderNodeBsdfAnisotropic"
    kinds = {"Plain": along(glossy, values, distribution="GGX")}
    for distribution in ("GGX", "BECKMANN", "ASHIKHMIN_SHIRLEY") + _MULTI:
        kinds[distribution] = along(glossy, {**values, "Rotation": 0.1}, distribution=distribution)
    kinds["Principled"] = along("ShaderNodeBsdfPrincipled", principled, distribution="GGX")
    if hasattr(bpy.types, "ShaderNodeBsdfMetallic"):
        metal = {"Roughness": ("B", 0.6, 0.2), "Anisotropy": "C"}
        for fresnel in ("F82", "PHYSICAL_CONDUCTOR"):
            for distribution in ("MULTI_GGX", "BECKMANN"):
                kinds[f"Metallic {fresnel} {distribution}"] = along(
                    "ShaderNodeBsdfMetallic",
                    metal,
                    fresnel_type=fresnel,
                    distribution=distribution,
                )
    return kinds


def _filmed():
    film = {"Thin Film Thickness": ("A", 700.0, 0.0), "Thin Film IOR": ("C", 0.8, 1.1)}
    principled = "ShaderNodeBsdfPrincipled"
    plain = {**film, "Base Color": (0.5, 0.3, 0.1, 1.0), "Roughness": ("B", 0.4, 0.2)}
    shapes = {
        "Dielectric": {},
        "Tinted": {"Specular Tint": (0.9, 0.6, 0.3, 1.0), "Specular IOR Level": 0.8},
        "Diamond": {"IOR": 2.4},
        "Without specular": {"IOR": 1.0},
        "Glass": {"Transmission Weight": 1.0, "IOR": 1.5},
        "Half a metal": {"Metallic": 0.5, "Specular Tint": (0.7, 0.8, 0.9, 1.0)},
    }
    kinds = {
        f"{name} {distribution}": lambda tree, d=distribution, v=values: node(
            tree, principled, {**plain, **v}, distribution=d
        )
        for name, values in shapes.items()
        for distribution in ("GGX", "MULTI_GGX")
    }
    if bpy.app.version >= (5, 0, 0):
        bare = {**film, "Roughness": ("B", 0.4, 0.2)}
        kinds["Glass's own"] = lambda tree: node(tree, "ShaderNodeBsdfGlass", {**bare, "IOR": 1.6})
        for fresnel in ("F82", "PHYSICAL_CONDUCTOR"):
            kinds[f"Metallic {fresnel}"] = lambda tree, f=fresnel: node(
                tree, "ShaderNodeBsdfMetallic", bare, fresnel_type=f
            )
    return kinds


@pytest.mark.skipif(bpy.app.version < (4, 2, 0), reason="Blender 4.2 brought thin films")
@pytest.mark.parametrize("turn", [BEFORE, BEHIND], ids=["before", "behind"])
def test_thin_films(scene, render, turn):
    report = compare(scene, render, _filmed(), turn)
    if turn is BEHIND:
        report = {name: pair for name, pair in report.items() if "Glass" in name}
    check(report)


def test_brushed_and_metallic(scene, render):
    check(compare(scene, render, _brushed(), BEFORE))


def test_brushed_around_the_axis_of_generated(scene, render):
    """The default tangent turns within a square, of which each engine has its own place: the mean of 64 of these."""
    sun(scene)
    tree = Tree(board(scene, 0.15, 1, tilt=0.3, both_sides=True))
    values = {"Color": "A", "Roughness": 0.5, "Anisotropy": 0.6}
    shown(tree, node(tree, "ShaderNodeBsdfAnisotropic", values, distribution="GGX"))
    theirs, ours = render_both(scene, render, samples=64)
    assert theirs.std() > 0.3
    assert rmse(theirs, ours) < 0.01


# Of the mean.  A tube's colours go linearly between a few places across it, where Fresnel's edge is steep.  Before
# Blender 4 Cycles tilts the inclination of the light by the cuticles' angle, since then that of the view: the same but
# far from the highlights, as here.
# Since Blender 5 it draws a polyline's pieces as cones, whose sides show, whatever the shape of curves.
_HAIR = {
    "ShaderNodeBsdfHair": 0.01 if bpy.app.version < (5, 0, 0) else 0.03,
    "ShaderNodeBsdfHairPrincipled": 0.15 if _SINCE_4 else 0.3,
}


@pytest.mark.parametrize("turn", [BEFORE, BEHIND], ids=["before", "behind"])
def test_hair(scene, render, turn):
    """Tubes side by side, of a material each, over blocks of pixels: each engine has its own samples of an edge."""
    sun(scene, (turn[0] + 0.6, 0.3, 0.0))
    scene.cycles.light_sampling_threshold = 0.0
    if hasattr(scene, "cycles_curves"):
        scene.cycles_curves.shape = "RIBBONS"
    hair, principled = _HAIR
    rough = {"RoughnessU": 0.3, "RoughnessV": 0.6, "Offset": 0.1}
    kinds = [
        (hair, {"Color": (0.8, 0.6, 0.3, 1.0), **rough}, {"component": "Reflection"}),
        (hair, {"Color": (0.8, 0.6, 0.3, 1.0), **rough}, {"component": "Transmission"}),
        (principled, {"Color": (0.6, 0.4, 0.2, 1.0)}, {}),
        (principled, {"Melanin": 0.4, "Coat": 0.5}, {"parametrization": "MELANIN"}),
    ]
    for place, (kind, values, properties) in enumerate(kinds):
        x = -0.75 + 0.5 * place
        path = [(x, y, 0.1 * np.sin(3 * y + place)) for y in np.linspace(-1.2, 1.2, 13)]
        thing = curve_through(scene, path, 0.2, f"Tube {place}")
        tree = Tree(thing, f"Tube {place}")
        made = tree.add(kind, **properties)
        for name, value in values.items():
            made.inputs[name].default_value = value
        shown(tree, made)
        give_material(thing, tree.material)
    scene_parts.add_camera(scene, ortho_scale=2.0)
    scene.render.resolution_x = scene.render.resolution_y = 64
    theirs, ours = (
        picture.reshape(8, 8, 4, 16, 3).mean(axis=(1, 3))
        for picture in render_both(scene, render, samples=64)
    )
    for k, (kind, _, _) in enumerate(kinds):
        error, mean = rmse(theirs[:, k], ours[:, k]), float(theirs[:, k].mean())
        if mean < 0.005:  # of the other side: nothing, or what is left of it
            assert ours[:, k].mean() < 0.01, (kind, k)
        else:
            assert error < _HAIR[kind] * mean, (kind, k, error, mean)
