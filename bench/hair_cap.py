# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory and time of a million hairs of 8 segments, or of a million points, in motion.

    PYTHONPATH=<folder of granita_core> python bench/hair_cap.py [--kind CURVES|POINTS] [--count 1000000] [--threads N]

Hairs stand on a ball and are combed by the wind; points drift.  A sun casts their shadows.  Prints one JSON line: seconds by stage, points
shaded, and peak resident bytes in all and above those before the frame (the snapshot's arrays are in both).
"""

import argparse
import json
import pathlib
import resource
import sys
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "tests" / "closed_form"))
import snapshots as s  # noqa: E402

SEGMENTS = 8


def ball(count, radius):
    """Places on a sphere: the golden spiral."""
    i = np.arange(count) + 0.5
    z, angle = 1 - 2 * i / count, np.pi * (1 + 5**0.5) * i
    r = np.sqrt(1 - z * z)
    return radius * np.stack([r * np.cos(angle), r * np.sin(angle), z], 1)


def hairs(count):
    """Curves in two knots, the tips moving by about 20 pixels."""
    root = ball(count, 1.0)
    along = np.linspace(0, 1, SEGMENTS + 1)
    knots = []
    for wind in (0.0, 0.06):
        bend = np.array([wind, 0.02 + wind, 0.0])
        knots.append(root[:, None] * (1 + 0.15 * along[:, None]) + along[:, None] ** 2 * bend * 2.0)
    return {
        "name": "curves 'Hair'",
        "kind": "CURVES",
        "points": np.stack(knots).astype(np.float32).reshape(2, -1, 3),
        "curve_sizes": np.full(count, SEGMENTS + 1, np.int32),
        "radius": np.tile(0.0006 * (1 - 0.9 * along), count).astype(np.float32)[None],
    }


def points(count):
    place = ball(count, 1.0) * np.linspace(0.2, 1.2, count)[:, None] ** 0.5
    drift = np.array([0.05, 0.03, 0.0])
    return {
        "name": "point cloud 'Spray'",
        "kind": "POINTS",
        "points": np.stack([place, place + drift]).astype(np.float32),
        "radius": np.full((1, count), 0.002, np.float32),
    }


def scene(kind, count, threads, shadows, scale=1.0):
    snapshot = s.perspective(
        (int(960 * scale), int(540 * scale)), focal=900 * scale, samples=16, threads=threads
    )
    snapshot["options"].update(film_transparent=False)
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.4, 0.25, 0.1, 1)}}]
    snapshot["materials"].append({"name": "Hair", "nodes": nodes, "surface": (0, "BSDF")})
    sun = {"name": "Sun", "kind": "SUN", "world_from_light": np.diag([1.0, -1, -1, 1])[None]}
    snapshot["lights"] = [{**sun, "energy": 3.0, "casts_shadow": shadows}]
    snapshot["geometries"].append(hairs(count) if kind == "CURVES" else points(count))
    s.instance(snapshot, 0, 0, [s.translation(0, 0, 4.5)])
    return snapshot


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--kind", choices=("CURVES", "POINTS"), default="CURVES")
    parser.add_argument("--count", type=int, default=1_000_000)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--scale", type=float, default=1.0, help="1 = 960 by 540 pixels")
    parser.add_argument("--no-shadows", action="store_true")
    parser.add_argument("--out", help="write the picture as an .npy array")
    arguments = parser.parse_args()
    snapshot = scene(
        arguments.kind,
        arguments.count,
        arguments.threads,
        not arguments.no_shadows,
        arguments.scale,
    )
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start, cpu = time.perf_counter(), time.process_time()
    result = s.render(snapshot)
    figures = result["statistics"]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    if arguments.out:
        np.save(arguments.out, result["combined"])
    print(
        json.dumps(
            {
                "kind": arguments.kind,
                "count": arguments.count,
                "seconds": round(time.perf_counter() - start, 2),
                "cpu_seconds": round(time.process_time() - cpu, 2),
                "peak_bytes": peak * 1024,
                "peak_bytes_above": (peak - before) * 1024,
                **{k: figures[k] for k in ("grids_diced", "micropolygons", "points_shaded")},
                **{k: figures[k] for k in ("rays_shadow", "peak_ray_bytes", "peak_grid_bytes")},
                "stages": {k: round(v, 2) for k, v in figures.items() if k.startswith("seconds_")},
            }
        )
    )


if __name__ == "__main__":
    main()
