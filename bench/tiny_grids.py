# SPDX-License-Identifier: GPL-3.0-or-later
"""A million separate quads of a pixel against one patch that dices into as many micropolygons.

    PYTHONPATH=<folder of granita_core> python bench/tiny_grids.py [--side 1000] [--rounds 3] [--quads-a-pixel 1]

Prints one JSON line a case: seconds of the frame, by stage, points shaded, micropolygons; and the ratios of medians.
"""

import argparse
import json
import pathlib
import statistics
import sys
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "tests" / "closed_form"))
import snapshots as s  # noqa: E402


def picture(side):
    snapshot = s.orthographic((side, side), samples=16, threads=1)
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.5, 0.3, 1)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    sun = {"name": "Sun", "kind": "SUN", "world_from_light": np.diag([1.0, -1, -1, 1])[None]}
    snapshot["lights"] = [{**sun, "energy": 3.0}]
    return snapshot


def one_patch(side):
    snapshot = picture(side)
    s.quad(snapshot, s.rectangle(0, 0, side, side), 0)
    return snapshot


def separate_quads(side, quads_a_pixel):
    """Rows of quads that share no vertex, so many a pixel."""
    snapshot = picture(side)
    n = int(side * quads_a_pixel**0.5)
    size = side / n
    x, y = np.meshgrid(np.arange(n) * size, np.arange(n) * size)
    corner = np.stack([x, y, np.full_like(x, 1.0)], -1).reshape(-1, 1, 3)
    offsets = np.array([(0, 0, 0), (size, 0, 0), (size, size, 0), (0, size, 0)])
    index = len(snapshot["geometries"])
    snapshot["geometries"].append(
        {
            "name": "mesh 'Quads'",
            "points": (corner + offsets).astype(np.float32).reshape(1, -1, 3),
            "face_sizes": np.full(n * n, 4, np.int32),
            "corner_verts": np.arange(4 * n * n, dtype=np.int32),
        }
    )
    s.instance(snapshot, index, 0)
    return snapshot


def measure(snapshot):
    start = time.process_time()
    result = s.render(snapshot)["statistics"]
    stages = {k: round(v, 3) for k, v in result.items() if k.startswith("seconds_")}
    counters = {k: result[k] for k in ("points_shaded", "micropolygons", "grids_diced")}
    return {"frame": round(time.process_time() - start, 3), **stages, **counters}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--side", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--quads-a-pixel", type=float, default=1.0)
    arguments = parser.parse_args()
    scenes = {
        "one patch": one_patch(arguments.side),
        "separate quads": separate_quads(arguments.side, arguments.quads_a_pixel),
    }
    rounds = {name: [] for name in scenes}
    for _ in range(arguments.rounds):
        for name, snapshot in scenes.items():
            rounds[name].append(measure(snapshot))
    median = {
        name: {key: statistics.median(r[key] for r in runs) for key in runs[0]}
        for name, runs in rounds.items()
    }
    for name, figures in median.items():
        print(json.dumps({"case": name, **figures}))
    one, many = median["one patch"], median["separate quads"]
    ratios = {key: round(many[key] / one[key], 2) for key in ("frame", "seconds_hide")}
    print(json.dumps({"ratio": ratios}))


if __name__ == "__main__":
    main()
