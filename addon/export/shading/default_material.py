# SPDX-License-Identifier: GPL-3.0-or-later
"""The look of slots without a material.  Before Blender 5 it is a diffuse one, which the native module has."""

from dataclasses import replace

import bpy
import numpy as np

from .nodes import version


def fill_empty_slots(instances, materials):
    """From Blender 5 on: a Principled BSDF of default settings where there is no material.

    Args:
        instances: snapshot.Instances.
        materials: records of the snapshot.

    Returns:
        (Instances, list of records).
    """
    none = instances.slots == 0
    if bpy.app.version < (5, 0, 0) or not (none.any() or (instances.materials < 0).any()):
        return instances, materials
    index = len(materials)
    first = np.cumsum(instances.slots) - instances.slots
    filled = np.where(instances.materials < 0, index, instances.materials)
    filled = np.insert(filled, first[none], index).astype(np.int32)
    slots = np.maximum(instances.slots, 1)
    return replace(instances, slots=slots, materials=filled), [*materials, _principled()]


def _principled():
    node = {
        "type": "ShaderNodeBsdfPrincipled",
        "name": "Default",
        "inputs": {"Base Color": (0.8, 0.8, 0.8, 1.0), "Roughness": 0.5, "IOR": 1.5},
        "properties": {"distribution": "MULTI_GGX", "version": version()},
    }
    return {"name": "", "index": 0, "displacement": None, "nodes": [node], "surface": (0, "BSDF")}
