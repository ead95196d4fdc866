# SPDX-License-Identifier: GPL-3.0-or-later
"""The look of slots without a material: a diffuse one, as the native module has it for Blender 4, from 5 on a Principled BSDF."""

from dataclasses import replace

import bpy
import numpy as np

from .nodes import version


def fill_empty_slots(instances, materials):
    """A material where there is none, but in Blender 4: before, Cycles bends normals of any diffuse BSDF.

    Args:
        instances: snapshot.Instances.
        materials: records of the snapshot.

    Returns:
        (Instances, list of records).
    """
    none = instances.slots == 0
    if bpy.app.version[0] == 4 or not (none.any() or (instances.materials < 0).any()):
        return instances, materials
    index = len(materials)
    first = np.cumsum(instances.slots) - instances.slots
    filled = np.where(instances.materials < 0, index, instances.materials)
    filled = np.insert(filled, first[none], index).astype(np.int32)
    slots = np.maximum(instances.slots, 1)
    return replace(instances, slots=slots, materials=filled), [*materials, _default()]


def _default():
    color = {"Color": (0.8, 0.8, 0.8, 1.0), "Roughness": 0.0}
    node = {"type": "ShaderNodeBsdfDiffuse", "inputs": color, "properties": {}}
    if bpy.app.version >= (5, 0, 0):
        color = {"Base Color": (0.8, 0.8, 0.8, 1.0), "Roughness": 0.5, "IOR": 1.5}
        node = {
            "type": "ShaderNodeBsdfPrincipled",
            "inputs": color,
            "properties": {"distribution": "MULTI_GGX"},
        }
    node["name"] = "Default"
    node["properties"]["version"] = version()
    return {"name": "", "index": 0, "displacement": None, "nodes": [node], "surface": (0, "BSDF")}
