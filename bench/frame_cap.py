# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory and time of a large frame: 3840x2160, dicing rate .4, 16 samples, everything moving 20 px.

    PYTHONPATH=<folder of granita_core> python bench/frame_cap.py [--threads N] [--scale .25]

Prints one JSON line: micropolygons at the hider, seconds, and peak resident bytes above those before the frame.
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


def scene(scale, threads):
    """A hilly sheet over the whole frame, 64 x 36 quads, seen obliquely enough that no bound is flat."""
    width, height = int(3840 * scale), int(2160 * scale)
    snapshot = s.orthographic(
        (width, height),
        samples=16,
        dicing_rate=0.4,
        motion_factor=0.0,
        threads=threads,
        pixel_filter="BLACKMAN_HARRIS",
        filter_width=1.5,
    )
    nx, ny = 64, 36
    x, y = np.meshgrid(np.linspace(-40, width + 40, nx + 1), np.linspace(-40, height + 40, ny + 1))
    z = 100 + 20 * np.sin(x / 300) * np.cos(y / 200)
    points = np.stack([x, y, z], -1).reshape(-1, 3)
    faces = [
        (j * (nx + 1) + i, j * (nx + 1) + i + 1, (j + 1) * (nx + 1) + i + 1, (j + 1) * (nx + 1) + i)
        for j in range(ny)
        for i in range(nx)
    ]
    transforms = [s.translation(-10, 0), s.translation(10, 0)]
    s.mesh(snapshot, points, faces, s.emission(snapshot, (0.8, 0.6, 0.4)), transforms=transforms)
    return snapshot


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--scale", type=float, default=1.0)
    arguments = parser.parse_args()
    snapshot = scene(arguments.scale, arguments.threads)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = time.perf_counter()
    result = s.render(snapshot)
    seconds = time.perf_counter() - start
    statistics = result["statistics"]
    print(
        json.dumps(
            {
                "threads": arguments.threads,
                "micropolygons": statistics["micropolygons"],
                "seconds": round(seconds, 2),
                "peak_bytes_above": (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
                * 1024,
                "peak_grid_bytes": statistics["peak_grid_bytes"],
                "stages": {
                    k: round(v, 2) for k, v in statistics.items() if k.startswith("seconds_")
                },
            }
        )
    )


if __name__ == "__main__":
    main()
