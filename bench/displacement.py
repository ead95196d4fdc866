# SPDX-License-Identifier: GPL-3.0-or-later
"""A displaced sheet against the same sheet with as many micropolygons that is not, on three graphs.

    ./dev bench displacement [--rounds 5]

Prints one JSON line a case: medians of the processor seconds of whole frames, taken in turns, by stage, and their
ratio to the sheet that is smooth.
"""

import argparse
import json
import statistics

import numpy as np
from measure import render
from snapshot_scenes import s

SIZE = (640, 360)


def link(node, output):
    return ("LINK", node, output)


def height_nodes(graph):
    """Nodes whose last gives a height in its output "Value" or "Fac"."""
    nodes = [{"type": "ShaderNodeTexCoord", "inputs": {}}]
    noise = {
        "type": "ShaderNodeTexNoise",
        "inputs": {"Vector": link(0, "Object"), "Scale": 0.05, "Detail": 2.0, "Roughness": 0.5},
        "properties": {"noise_dimensions": "3D"},
    }
    image = {
        "type": "ShaderNodeTexImage",
        "inputs": {"Vector": link(0, "Generated")},
        "properties": {"image": "Bumps", "interpolation": "Linear"},
    }
    if graph == "noise":
        return [*nodes, noise], link(1, "Fac")
    if graph == "image":
        return [*nodes, image], link(1, "Color")
    product = {
        "type": "ShaderNodeMath",
        "inputs": {"Value": link(1, "Fac"), "Value_001": link(2, "Color")},
        "properties": {"operation": "MULTIPLY"},
    }
    return [*nodes, noise, image, product], link(3, "Value")


def sheet(graph, moved):
    """A sheet that fills the frame, lit by a sun."""
    snapshot = s.orthographic(SIZE, samples=16, executor="SIMD")
    i, j = np.mgrid[:256, :256] * 2 * np.pi / 256
    bumps = np.float32(0.5 + 0.25 * np.sin(9 * i) * np.sin(7 * j) + 0.1 * np.sin(23 * i + 19 * j))
    bumps = bumps[..., None]
    pixels = np.concatenate([bumps, bumps, bumps, np.ones_like(bumps)], 2)
    snapshot["images"] = [{"name": "Bumps", "pixels": pixels, "colorspace": "Non-Color"}]
    nodes, height = height_nodes(graph)
    color = len(nodes)
    nodes.append({"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.8, 0.8, 1)}})
    material = {"name": "Matte", "nodes": nodes, "surface": (color, "BSDF")}
    if moved:
        inputs = {"Height": height, "Midlevel": 0.5, "Scale": 8.0}
        nodes.append({"type": "ShaderNodeDisplacement", "inputs": inputs})
        material |= {"displacement": (color + 1, "Displacement")}
    snapshot["materials"].append(material)
    width, depth = SIZE
    s.quad(snapshot, s.rectangle(0, 0, width, depth, 400.0)[::-1], 0)
    sun = {"name": "Sun", "kind": "SUN", "energy": 3.0, "sun_angle": 0.0}
    c, n = np.cos(0.7), np.sin(0.7)
    towards = np.array([[c, 0, n, 0], [0, 1, 0, 0], [-n, 0, c, 0], [0, 0, 0, 1]])
    snapshot["lights"] = [{**sun, "world_from_light": (towards @ np.diag([1.0, -1, -1, 1]))[None]}]
    return snapshot


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    for graph in ("noise", "image", "both"):
        taken = {False: [], True: []}
        stages = {}
        for _ in range(rounds):
            for moved in taken:
                result, seconds = render(sheet(graph, moved))
                taken[moved].append(seconds)
                stages[moved] = {
                    name: round(value, 2)
                    for name, value in result["statistics"].items()
                    if name.startswith("seconds") and value > 0.01
                }
        smooth, displaced = (statistics.median(taken[moved]) for moved in (False, True))
        line = {"graph": graph, "smooth": round(smooth, 3), "displaced": round(displaced, 3)}
        print(json.dumps({**line, "ratio": round(displaced / smooth, 2), "stages": stages}))


if __name__ == "__main__":
    main()
