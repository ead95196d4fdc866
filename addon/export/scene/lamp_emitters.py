# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that the camera sees (Ray Visibility > Camera of a light), as geometry that glows.

As in Cycles they add their radiance to what is behind them, have no opacity and no depth and cast no shadow.  An
area light is seen from its front, a point light as a sphere of its radius, whatever its scale.
"""

import math

import numpy as np

from ..base.snapshot import Geometry
from .emitter_nodes import area_coordinates, emission_nodes, link, node
from .instance import VISIBLE_CAMERA

_SIDES = 256  # of an ellipse: its outline is within 1e-4 of its radius


def add_emitters(snapshot, lamps, scan, report):
    """Adds geometry, material and instance of each light that is seen to a snapshot that is complete otherwise.

    Args:
        snapshot: Snapshot; changed in place.
        lamps: of `lamps.place_lamps`.
        scan: depsgraph.Visit of their things.
        report: called with (datablock, message).
    """
    emitters = []
    for thing, lamp in lamps:
        if lamp.pop("visible_camera") and _glows(lamp, report):
            emitters.append((thing, lamp))
    if not emitters:
        return
    instances, keys = snapshot.instances, set(snapshot.instances.key.tolist())
    for thing, lamp in emitters:
        geometry, area = (_point if lamp["kind"] == "POINT" else _area)(lamp)
        key = int(scan.identity[thing]) >> 32
        while key in keys:
            key = (key + 1) & 0xFFFFFFFF
        keys.add(key)
        matrices = np.array(lamp["world_from_light"])
        if lamp["kind"] == "POINT":
            matrices[:, :3, :3] = np.eye(3)
        radiance = np.array(lamp["color"]) * lamp["energy"] / (math.pi * area)
        emission, tells_places = emission_nodes(lamp, (*map(float, radiance), 1.0), report)
        if tells_places:
            matrices = area_coordinates(lamp, geometry, matrices)
        _append(
            instances,
            name=[lamp["name"]],
            geometry=[len(snapshot.geometries)],
            knots=[len(matrices)],
            world_from_object=matrices,
            slots=[1],
            materials=[len(snapshot.materials)],
            flags=[VISIBLE_CAMERA],
            object_index=[0],
            random=[0.0],
            key=[key],
            adjacent=matrices[[len(matrices) // 2] * 2],
            receives=[2**64 - 1],
            blocks=[2**64 - 1],
            receiver_set=[-1],
            blocker_set=[-1],
            lifespan=[lamp.get("lifespan", (0.0, 1.0))],
        )
        instances.values = {
            key: np.concatenate([rows, np.zeros((1, 4), dtype=rows.dtype)])
            for key, rows in instances.values.items()
        }
        snapshot.geometries.append(geometry)
        snapshot.materials.append(_material(geometry.name, emission))


def _glows(lamp, report):
    """Whether it can be seen and drawn; what only Cycles can draw is named."""
    if not np.any(np.array(lamp["color"]) * lamp["energy"]):
        return False
    if lamp["kind"] == "POINT":
        return lamp["radius"] > 0.0
    if lamp["kind"] == "AREA" and lamp["spread"] >= math.pi * (1.0 - 1e-6):
        return min(lamp["size"]) > 0.0 and _axes(lamp).all()
    if lamp["kind"] != "SPOT" or lamp["radius"] > 0.0:
        what = "a spread below 180 degrees" if lamp["kind"] == "AREA" else f"type {lamp['kind']}"
        report(f"light '{lamp['name']}'", f"lights of {what} are not drawn to the camera")
    return False


def _axes(lamp):
    """Lengths of the light's x and y axis at the middle of the shutter."""
    matrices = lamp["world_from_light"]
    return np.linalg.norm(matrices[len(matrices) // 2][:3, :2], axis=0)


def _point(lamp):
    """(Geometry, area in m^2 by which its power is divided)."""
    radius = lamp["radius"]
    geometry = Geometry(
        name=f"light '{lamp['name']}'",
        kind="POINTS",
        points=np.zeros((1, 1, 3), dtype=np.float32),
        radius=np.full((1, 1), radius, dtype=np.float32),
    )
    return geometry, 4.0 * math.pi * radius * radius


def _area(lamp):
    x, y = lamp["size"]
    area = x * y * _axes(lamp).prod()
    if lamp["shape"] in ("DISK", "ELLIPSE"):
        angles = np.arange(_SIDES) * (2.0 * math.pi / _SIDES)
        outline = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        area *= math.pi / 4.0
    else:
        outline = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    points = np.zeros((1, len(outline), 3), dtype=np.float32)
    points[0, :, :2] = outline[::-1] * (0.5 * x, 0.5 * y)  # clockwise: it faces -z
    geometry = Geometry(
        name=f"light '{lamp['name']}'",
        points=points,
        face_sizes=np.array([len(outline)], dtype=np.int32),
        corner_verts=np.arange(len(outline), dtype=np.int32),
    )
    return geometry, area


def _material(name, emission):
    """Glows to the front by these nodes, and lets everything through."""
    n = len(emission)
    nodes = [
        *emission,
        node("ShaderNodeBsdfTransparent", Color=(1.0, 1.0, 1.0, 1.0)),
        node("ShaderNodeAddShader", Shader=link(n - 1, "Emission"), Shader_001=link(n, "BSDF")),
        node("ShaderNodeNewGeometry"),
        node(
            "ShaderNodeMixShader",
            Fac=link(n + 2, "Backfacing"),
            Shader=link(n + 1, "Shader"),
            Shader_001=link(n, "BSDF"),
        ),
    ]
    return {
        "name": name,
        "index": 0,
        "nodes": nodes,
        "surface": (n + 3, "Shader"),
        "displacement": None,
    }


def _append(instances, **more):
    """Adds rows to the arrays of Instances that there are."""
    for name, values in more.items():
        before = getattr(instances, name)
        if isinstance(before, list):
            setattr(instances, name, before + values)
        elif before is not None:
            values = np.asarray(values, dtype=before.dtype)
            setattr(instances, name, np.concatenate([before, values]))
