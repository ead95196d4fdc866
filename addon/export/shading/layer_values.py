# SPDX-License-Identifier: GPL-3.0-or-later
"""What nodes take of the view layer, the scene or the world: one value a frame."""

import numpy as np

from ..base.find_value import find_value
from .world import world_of


def set_layer_values(records, scene, view_layer):
    """Writes the property `layer_value` (four floats) into Attribute nodes of type View Layer, and `world_distance`
    (metres, how far an Ambient Occlusion looks whose Distance is 0) into those, `seconds` and `frame` into Scene Times.

    Args:
        records: of materials, a world or lights with nodes.
        scene, view_layer: evaluated.
    """
    world = world_of(scene, view_layer)
    for record in records:
        for node in record["nodes"]:
            properties = node["properties"]
            if properties.get("attribute_type") == "VIEW_LAYER":
                value = _lookup(properties["attribute_name"], scene, view_layer)
                properties["layer_value"] = np.array(value, dtype=np.float32)
            elif node["type"] == "ShaderNodeAmbientOcclusion" and world is not None:
                properties["world_distance"] = float(world.light_settings.distance)
            elif node["type"] == "GeometryNodeInputSceneTime":
                frame, render = scene.frame_current_final, scene.render
                properties["frame"] = frame
                properties["seconds"] = frame * render.fps_base / render.fps


def _lookup(name, scene, view_layer):
    """In Blender's order; zeros where nothing has it."""
    for owner in (view_layer, scene, scene.world):
        value = find_value(owner, name) if owner is not None else None
        if value is not None:
            return value
    return (0.0,) * 4
