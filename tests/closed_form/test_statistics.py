# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds by stage add up to the processor time of the frame, on whatever threads they were spent."""

import os
import time

import numpy as np
import snapshots as s


def cage_in_the_sun(side):
    """Mostly work of threads that are not the frame's own: limit points, ray quads, Embree's tree."""
    snapshot = s.orthographic((32, 32), samples=4, threads=os.cpu_count())
    x, y = np.meshgrid(np.linspace(0, 32, side + 1), np.linspace(0, 32, side + 1))
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    corners = np.stack([first, first + 1, first + side + 2, first + side + 1], axis=1)
    points = np.stack([x, y, 1 + np.sin(x) * np.cos(0.8 * y)], axis=-1)
    snapshot["geometries"].append(
        {
            "name": "mesh 'Cage'",
            "points": points.astype(np.float32).reshape(1, -1, 3),
            "face_sizes": np.full(side * side, 4, np.int32),
            "corner_verts": corners.astype(np.int32).ravel(),
            "subdivision": {"scheme": "CATMULL_CLARK"},
        }
    )
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.5, 0.3, 1)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    sun = {"name": "Sun", "kind": "SUN", "world_from_light": np.diag([1.0, -1, -1, 1])[None]}
    snapshot["lights"] = [{**sun, "energy": 3.0}]
    s.instance(snapshot, len(snapshot["geometries"]) - 1, 0)
    return snapshot


def test_stages_add_up_to_the_processor_time():
    # Large, for a small frame is in its copies and threads: 300 x 300 faces account for .90, these for .96.
    snapshot = cage_in_the_sun(900)
    s.render(
        snapshot
    )  # loads the module; threads and memory that the system makes for it are there
    before = time.process_time()
    statistics = s.render(snapshot)["statistics"]
    spent = time.process_time() - before
    stages = {name: value for name, value in statistics.items() if name.startswith("seconds_")}
    accounted = sum(value for name, value in stages.items() if "device" not in name)
    assert stages["seconds_ray_build"] > 0.25 * spent
    # The tenth that is left: arrays that are checked and copied, threads that start and look for work.
    assert 0.9 * spent < accounted < 1.05 * spent
