# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of the chapter's figures as snapshots, with geometry of our own."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "closed_form"))
import snapshots as s  # noqa: E402
from snapshot_scenes import unit_sphere  # noqa: E402

FILTER = {"pixel_filter": "MITCHELL", "filter_width": 4.0}


def regular(samples, time_samples=1, executor="RASTER"):
    """The chapter's sampling: a lattice, and passes for the whole picture."""
    options = {"sampling": "REGULAR", "samples": samples, "time_samples": time_samples}
    return {**options, "executor": executor, "opacity_threshold": 0.996}


def independent(samples, executor="SIMD"):
    """A place, a time and a lens point for each sample."""
    return {"samples": samples, "executor": executor, "opacity_threshold": 0.996}


def shaded(snapshot, color, alpha=None):
    """Emission that looks lit from the camera's side: colour times a ramp of the normal."""
    geometry = {"type": "ShaderNodeNewGeometry", "inputs": {}}
    dot = {
        "type": "ShaderNodeVectorMath",
        "inputs": {"Vector": ("LINK", 0, "Normal"), "Vector_001": (-0.4, 0.5, -0.76)},
        "properties": {"operation": "DOT_PRODUCT"},
    }
    ramp = {
        "type": "ShaderNodeMath",
        "inputs": {"Value": ("LINK", 1, "Value"), "Value_001": 0.5, "Value_002": 0.5},
        "properties": {"operation": "MULTIPLY_ADD"},
    }
    glow = {
        "type": "ShaderNodeEmission",
        "inputs": {"Color": (*color, 1.0), "Strength": ("LINK", 2, "Value")},
    }
    nodes, surface = [geometry, dot, ramp, glow], (3, "Emission")
    if alpha is not None:
        nodes.append({"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1, 1, 1, 1)}})
        mix = {"Fac": alpha, "Shader": ("LINK", 4, "BSDF"), "Shader_001": ("LINK", 3, "Emission")}
        nodes.append({"type": "ShaderNodeMixShader", "inputs": mix})
        surface = (5, "Shader")
    index = len(snapshot["materials"])
    snapshot["materials"].append({"name": f"Shaded {index}", "nodes": nodes, "surface": surface})
    return index


def affine(scale, place, turn=0.0):
    matrix = s.translation(*place)
    c, n = np.cos(turn), np.sin(turn)
    matrix[:3, :3] = np.array([[c, -n, 0], [n, c, 0], [0, 0, 1]]) * scale
    return matrix


def particles(count, options):
    """9.4: transparent spheres that overlap, a puff of smoke lit from one side."""
    random = np.random.default_rng(4)
    snapshot = s.perspective((240, 240), 320.0, **FILTER, **options)
    points = random.normal(0, 1, (count, 3)) * (0.9, 0.7, 0.9) + (0, 0, 9)
    rank = np.argsort(np.argsort(points[:, 0] - 0.6 * points[:, 1]))
    for part in range(6):
        share = 0.25 + 0.14 * part
        material = s.emission(snapshot, (share, 0.96 * share, 0.9 * share), 0.12)
        chosen = points[rank * 6 // count == 5 - part]
        index = len(snapshot["geometries"])
        snapshot["geometries"].append(
            {
                "name": f"points 'Puff {part}'",
                "kind": "POINTS",
                "points": chosen[None].astype(np.float32),
                "radius": random.uniform(0.05, 0.2, (1, len(chosen))).astype(np.float32),
            }
        )
        s.instance(snapshot, index, material)
    return snapshot


def planes(threshold, size, options, z_batch_size=26):
    """9.5: a stack of camera-facing planes of opacity .1, each a little smaller than the one behind it."""
    options = {**options, "opacity_threshold": threshold, "z_batch_size": z_batch_size}
    snapshot = s.orthographic((size, size), **FILTER, **options)
    for i in range(8):
        colour = np.array([(1, 0.1, 0.1), (0.1, 1, 0.1), (0.15, 0.3, 1)][i % 3])
        edge = size * (0.06 + 0.11 * (7 - i) * 0.5)
        s.quad(
            snapshot,
            s.rectangle(edge, edge * 0.5, size - edge * 0.4, size - edge, 1.0 + i),
            s.emission(snapshot, tuple(3 * colour), 0.1),
        )
    return snapshot


def triangles_in_motion(options):
    """9.6: moving triangles."""
    snapshot = s.orthographic((72, 48), pixel_filter="BOX", filter_width=1.0, **options)
    for i, (x, y, move) in enumerate([(4, 6, (34, 6)), (10, 22, (22, 14)), (40, 8, (10, 24))]):
        colour = [(1, 0.25, 0.1), (0.2, 0.8, 0.3), (0.25, 0.45, 1)][i]
        points = [(x, y, 3.0 - i), (x + 16, y + 3, 3.0 - i), (x + 6, y + 15, 3.0 - i)]
        s.mesh(
            snapshot,
            points,
            [(0, 1, 2)],
            s.emission(snapshot, colour),
            transforms=[s.translation(0), s.translation(*move)],
        )
    return snapshot


def radial_pattern(options):
    """9.7: a quarter of a star of 180 wedges."""
    snapshot = s.orthographic((150, 150), **FILTER, **options)
    angles = np.arange(180) * 2 * np.pi / 180
    points, faces = [], []
    for i, angle in enumerate(angles):
        for a, r in (
            (angle, 4),
            (angle, 240),
            (angle + np.pi / 180, 240),
            (angle + np.pi / 180, 4),
        ):
            points.append((r * np.cos(a), r * np.sin(a), 1.0))
        faces.append(tuple(range(4 * i, 4 * i + 4)))
    s.mesh(snapshot, points, faces, s.emission(snapshot))
    return snapshot


def creature(options, motion=40.0, size=(150, 110)):
    """9.8 to 9.10: a figure of 26 balls that runs `motion` pixels along x."""
    random = np.random.default_rng(11)
    snapshot = s.perspective(size, 200.0 * size[1] / 110, **FILTER, **options)
    points, faces = unit_sphere(32, 16)
    colors = [(0.9, 0.6, 0.3), (0.5, 0.7, 0.9), (0.8, 0.3, 0.3)]
    materials = [shaded(snapshot, color) for color in colors]
    path = motion * 5.0 / (200.0 * size[1] / 110) / 2
    for i in range(26):
        place = random.normal(0, 1, 3) * (0.55, 0.5, 0.4) + (0, 0, 5)
        scale = random.uniform(0.12, 0.42)
        ends = [affine(scale, place + (x, 0, 0)) for x in (-path, path)]
        if i == 0:
            s.mesh(
                snapshot, points, faces, materials[0], ends, smooth=np.ones(len(faces), np.uint8)
            )
        else:
            s.instance(snapshot, 0, materials[i % 3], ends)
    return snapshot


def army(count, options):
    """9.11: figures of four balls each, in ranks to the horizon."""
    snapshot = s.perspective((320, 160), 260.0, (160, 125), **FILTER, **options)
    points, faces = unit_sphere(24, 12)
    materials = [shaded(snapshot, c) for c in ((0.75, 0.65, 0.5), (0.6, 0.3, 0.25))]
    row = int(np.ceil(np.sqrt(count / 2)))
    parts = [(0, 0.0, 0.3), (0, 0.45, 0.22), (0.22, 0.1, 0.12), (-0.22, 0.1, 0.12)]
    for i in range(count):
        x, z = (i % (2 * row) - row + 0.5) * 0.8, 4 + (i // (2 * row)) * 0.9
        for k, (dx, dy, radius) in enumerate(parts):
            matrix = affine(radius, (x + dx, -1.7 + dy, z))
            if i == 0 and k == 0:
                smooth = np.ones(len(faces), np.uint8)
                s.mesh(snapshot, points, faces, materials[0], [matrix], smooth=smooth)
            else:
                s.instance(snapshot, 0, materials[k % 2], [matrix])
    return snapshot


def feathers(options, moving, size=128, count=550):
    """9.12: a ball of feathers: strips whose texture cuts them out, stacked, and turning."""
    random = np.random.default_rng(12)
    snapshot = s.perspective((size, size), 1.6 * size, **FILTER, **options)
    coordinate = {"type": "ShaderNodeTexCoord", "inputs": {}}
    noise = {
        "type": "ShaderNodeTexNoise",
        "inputs": {"Vector": ("LINK", 0, "UV"), "Scale": 9.0, "Detail": 2.0},
    }
    alpha = {
        "type": "ShaderNodeMath",
        "inputs": {"Value": ("LINK", 1, "Fac"), "Value_001": 2.2, "Value_002": -0.75},
        "properties": {"operation": "MULTIPLY_ADD", "use_clamp": True},
    }
    materials = []
    for color in ((0.9, 0.5, 0.2), (0.8, 0.75, 0.6), (0.5, 0.25, 0.15)):
        glow = {"type": "ShaderNodeEmission", "inputs": {"Color": (*color, 1), "Strength": 1.0}}
        clear = {"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1, 1, 1, 1)}}
        mix = {
            "type": "ShaderNodeMixShader",
            "inputs": {
                "Fac": ("LINK", 2, "Value"),
                "Shader": ("LINK", 4, "BSDF"),
                "Shader_001": ("LINK", 3, "Emission"),
            },
        }
        materials.append(len(snapshot["materials"]))
        snapshot["materials"].append(
            {
                "name": "Feather",
                "nodes": [coordinate, noise, alpha, glow, clear, mix],
                "surface": (5, "Shader"),
            }
        )
    turn = np.deg2rad(14.0) if moving else 0.0
    for i in range(count):
        out = random.normal(0, 1, 3)
        out /= np.linalg.norm(out)
        along = np.cross(out, random.normal(0, 1, 3))
        along = along / np.linalg.norm(along) + 0.4 * out
        across = 0.05 * np.cross(out, along)
        root = 0.8 * out
        points = [
            root - across,
            root + across,
            root + across + 0.5 * along,
            root - across + 0.5 * along,
        ]
        uv = np.array([(0, 0), (0.2, 0), (0.2, 1), (0, 1)], np.float32) + random.uniform(0, 9, 2)
        ends = [affine(1.0, (0, 0, 4.0), a) for a in ((-turn, turn) if moving else (0.0,))]
        s.quad(
            snapshot,
            points,
            materials[i % 3],
            transforms=ends,
            attributes=[
                {"name": "UV", "domain": "CORNER", "kind": "UV", "values": uv.astype(np.float32)}
            ],
        )
    return snapshot
