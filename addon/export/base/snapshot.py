# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame that export makes: flat arrays, copied out of Blender.  See docs/scene_snapshot.md.

K is the number of motion knots of the thing itself; K = 1 is static.
"""

from dataclasses import dataclass, field, fields
from typing import Optional

import numpy as np


def _record(instance):
    """Dict of a dataclass's fields, without those that are None."""
    values = ((f.name, getattr(instance, f.name)) for f in fields(instance))
    return {name: value for name, value in values if value is not None}


@dataclass
class Attribute:
    """Values on a geometry: float32 [elements of the domain, width], width 1 to 4."""

    name: str
    domain: str  # "POINT", "FACE", "CORNER"
    kind: str  # "GENERIC", "UV", "COLOR"
    values: np.ndarray
    encoded: bool = False  # colours are sRGB's numbers, between elements too


@dataclass
class Geometry:
    """A polygon mesh or a subdivision cage with V vertices, F faces, C face corners; or curves, or a
    point cloud, of V points."""

    name: str  # "mesh 'Cube'"
    points: np.ndarray  # float32 [K, V, 3], object space, metres
    adjacent: Optional[np.ndarray] = (
        None  # float32 [2, V, 3], of the frame before and the one after
    )
    generated: Optional[np.ndarray] = (
        None  # float32 [V, 3], within the texture space of the mesh, or of hairs' emitter
    )
    face_sizes: Optional[np.ndarray] = None  # int32 [F], corners a face, at least 3
    corner_verts: Optional[np.ndarray] = None  # int32 [C]
    ngon_triangles: Optional[np.ndarray] = None  # int32 [T, 3], corners within faces of more than 4
    quads_by_normal: bool = False  # cut as by Blender before 4.1
    material_index: Optional[np.ndarray] = None  # int32 [F]; None = all 0
    smooth: Optional[np.ndarray] = None  # uint8 [F]; None = all flat
    corner_normals: Optional[np.ndarray] = None  # float32 [C, 3], unit, at the frame's time
    attributes: list = field(default_factory=list)  # of Attribute; active UV, active colour first
    subdivision: Optional[dict] = None
    kind: str = "MESH"  # "CURVES", "POINTS"
    curve_sizes: Optional[np.ndarray] = None  # int32 [curves], points a curve
    radius: Optional[np.ndarray] = None  # float32 [1 or K, V], metres; of curves and points
    edges: Optional[np.ndarray] = None  # int32 [E, 2], where a material asks for islands

    def as_dict(self):
        record = _record(self)
        record["attributes"] = [_record(attribute) for attribute in self.attributes]
        return record


@dataclass
class Instances:
    """n placed geometries, one array a property."""

    name: list  # str [n]
    geometry: np.ndarray  # int32 [n]
    knots: np.ndarray  # int32 [n]
    world_from_object: np.ndarray  # float64 [sum of knots, 4, 4]
    slots: np.ndarray  # int32 [n], material slots
    materials: np.ndarray  # int32 [sum of slots], -1 = none
    flags: np.ndarray  # uint32 [n]
    object_index: np.ndarray  # int32 [n], the pass index
    random: np.ndarray  # float32 [n], 0 to 1
    key: np.ndarray  # uint32 [n], unique; from the persistent identity
    adjacent: Optional[np.ndarray] = None  # float64 [2 n, 4, 4], as of geometries
    # uint64 [n], a bit a set of linked lights; None = all:
    receives: Optional[np.ndarray] = None  # those that light it
    blocks: Optional[np.ndarray] = None  # those that it shadows
    # int32 [n], the bit of what shines by itself; -1 or None = it lights and is shadowed by everything:
    receiver_set: Optional[np.ndarray] = None
    blocker_set: Optional[np.ndarray] = None
    receives_in_volumes: int = 2**64 - 1  # as `receives`, of what fills the world
    lifespan: Optional[np.ndarray] = None  # float32 [n, 2], within the shutter; None = all of it
    values: dict = field(default_factory=dict)  # {key of instance_values: float32 [n, 4]}


@dataclass
class Places:
    """Where things of a frame are at its time, of which knots of a path may be a pixel's part off."""

    camera: np.ndarray  # float64 [4, 4]
    instances: np.ndarray  # float64 [n, 4, 4]
    lights: list  # of float64 [4, 4]


@dataclass
class Snapshot:
    """One frame, complete."""

    options: dict
    camera: dict
    geometries: list  # of Geometry
    instances: Instances
    materials: list  # of dict
    images: list  # of dict
    color_spaces: list  # of dict
    working_space: dict | None
    lights: list  # of dict
    world: dict

    def as_dict(self):
        """What `granita_core.Scene` takes."""
        record = _record(self)
        record["geometries"] = [geometry.as_dict() for geometry in self.geometries]
        record["instances"] = _record(self.instances)
        return record
