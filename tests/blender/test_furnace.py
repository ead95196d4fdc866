# SPDX-License-Identifier: GPL-3.0-or-later
"""Every BSDF in a white furnace: what it reflects of a white sky, straight on, at a slant and grazed, as in Cycles."""

import math

import bpy
import numpy as np
import scene_parts
from node_comparison import Tree, render_both
from test_bsdfs import node
from test_nodes_shaders import shown

_SINCE_4 = bpy.app.version >= (4, 0, 0)
CELL = 8  # pixels
APART = 400.0
TILTS = (0.0, 0.7, 1.2)
ROUGHNESSES = (0.15, 0.5, 1.0)
WHITE = (1.0, 1.0, 1.0, 1.0)
# What Cycles evaluates, which lamps find, where it samples something else: what a sky gives is the integral here.
# Cycles turns half vectors that look away from the view round, but not the direction that they reflect: .342 in place
# of the last.  Until Blender 4 the rim of Toon fades by the part of the cone that was chosen, not by its angle (.857 in
# place of .759).
INTEGRALS = {"Glossy ASHIKHMIN_SHIRLEY 1.0": np.array([0.1381, 0.1839, 0.2933])}
if not _SINCE_4:
    INTEGRALS |= {
        "Toon DIFFUSE 0.15": np.array([0.5417, 0.5423, 0.5423]),
        "Toon DIFFUSE 0.5": np.array([0.7592, 0.7592, 0.7593]),
        "Toon GLOSSY 0.15": np.array([0.5417, 0.5423, 0.5180]),
        "Toon GLOSSY 0.5": np.array([0.7593, 0.7394, 0.5517]),
    }


def _kinds():
    """{name: function of a tree that returns a shader}"""
    kinds = {}

    def add(name, kind, values=(), **properties):
        values = {"Color": WHITE, **dict(values)}
        kinds[name] = lambda tree: node(tree, f"ShaderNodeBsdf{kind}", values, **properties)

    for roughness in ROUGHNESSES:
        for distribution in ("GGX", "BECKMANN", "ASHIKHMIN_SHIRLEY") + ("MULTI_GGX",) * _SINCE_4:
            add(
                f"Glossy {distribution} {roughness}",
                "Glossy",
                {"Roughness": roughness},
                distribution=distribution,
            )
        add(f"Diffuse {roughness}", "Diffuse", {"Roughness": roughness})
        add(f"Glass {roughness}", "Glass", {"Roughness": roughness}, distribution="GGX")
        add(f"Refraction {roughness}", "Refraction", {"Roughness": roughness}, distribution="GGX")
        for model in ("ASHIKHMIN", "MICROFIBER") if _SINCE_4 else ():
            add(f"Sheen {model} {roughness}", "Sheen", {"Roughness": roughness}, distribution=model)
        if not _SINCE_4:
            add(f"Velvet {roughness}", "Velvet", {"Sigma": roughness})
        for model in ("DIFFUSE", "GLOSSY"):
            toon = {"Size": roughness, "Smooth": 0.2}
            add(f"Toon {model} {roughness}", "Toon", toon, component=model)
        principled = {"Base Color": WHITE, "Roughness": roughness}
        kinds[f"Principled {roughness}"] = lambda tree, v=principled: node(
            tree, "ShaderNodeBsdfPrincipled", v
        )
        kinds[f"Principled metal {roughness}"] = lambda tree, v=principled: node(
            tree, "ShaderNodeBsdfPrincipled", {**v, "Metallic": 1.0}
        )
        kinds[f"Principled cloth {roughness}"] = lambda tree, v=principled: node(
            tree, "ShaderNodeBsdfPrincipled", {**v, "Sheen": 1.0}
        )
    add("Translucent", "Translucent")
    return kinds


def _leaning(scene, row):
    """A square of CELL pixels for each tilt, which leans about x and covers them all the same; so far below each
    other that none hides the sky from another."""
    corners, faces = [], []
    for column, tilt in enumerate(TILTS):
        x, y = CELL * column, CELL * row
        low = -APART * (row * len(TILTS) + column)
        high = low + CELL * math.tan(tilt)
        faces.append(tuple(range(len(corners), len(corners) + 4)))
        corners += [
            (x, y, low),
            (x + CELL, y, low),
            (x + CELL, y + CELL, high),
            (x, y + CELL, high),
        ]
    return scene_parts.add_mesh(scene, "Row", corners, faces)


def test_what_is_reflected_of_a_white_sky(scene, render):
    scene_parts.set_world(scene, (1.0, 1.0, 1.0))
    kinds = _kinds()
    for row, build in enumerate(kinds.values()):
        tree = Tree(_leaning(scene, row))
        shown(tree, build(tree))
    width, height = CELL * len(TILTS), CELL * len(kinds)
    camera = scene_parts.add_camera(scene, (width / 2, height / 2, 100.0), max(width, height))
    camera.data.clip_end = 1e6
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.granita.light_samples = 64
    theirs, ours = render_both(scene, render, samples=256)

    def means(image):
        cells = image[..., 0].reshape(len(kinds), CELL, len(TILTS), CELL)
        return cells[:, 1:-1, :, 1:-1].mean((1, 3))

    # Of 36 pixels with 256 samples: Cycles' noise is .3 % of them.
    wrong = {}
    for name, expected, seen in zip(kinds, means(theirs), means(ours), strict=True):
        expected = INTEGRALS.get(name, expected)
        if np.any(np.abs(seen - expected) > 0.01 * expected + 0.001):
            wrong[name] = expected, seen
    assert not wrong, "\n" + "\n".join(f"{name} {pair}" for name, pair in wrong.items())
