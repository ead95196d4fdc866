# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that shaders find on instances: the object's colour, attributes of objects and of their instancers,
places on an instancer.  Only what materials ask for is read.

A value is four numbers; it is asked for by a key: COLOR, ON_INSTANCER_GENERATED, ON_INSTANCER_UV, those of
`particle_values`, or the type of an Attribute node and a name ("OBJECT:temperature", "INSTANCER:shade").
"""

import numpy as np

from ..base.find_value import find_value
from ..geometry.attributes import attribute_values
from ..shading.used_nodes import any_node
from .particle_values import PARTICLE_KEYS

COLOR = "COLOR"
ON_INSTANCER_GENERATED = "INSTANCER GENERATED"
ON_INSTANCER_UV = "INSTANCER UV"
_PLACES = (ON_INSTANCER_GENERATED, ON_INSTANCER_UV)
# What differs between instances of a prototype.
_OF_INSTANCES = {*_PLACES, *PARTICLE_KEYS.values()}
_TYPES = ("OBJECT", "INSTANCER")
_OF_COORDINATES = ("ShaderNodeTexCoord", "ShaderNodeUVMap")


def requested_values(materials):
    """Keys that exported materials ask instances for: a set of str.

    Args:
        materials: the snapshot's material records.
    """
    found = set()
    for material in materials:
        nodes = material.get("nodes", ())
        used = {
            tuple(link[1:])
            for node in nodes
            for link in node["inputs"].values()
            if isinstance(link, tuple) and link[0] == "LINK"
        }
        for index, node in enumerate(nodes):
            properties = node["properties"]
            if node["type"] == "ShaderNodeObjectInfo":
                if (index, "Color") in used or (index, "Alpha") in used:
                    found.add(COLOR)
            elif node["type"] == "ShaderNodeAttribute":
                if properties.get("attribute_type") in _TYPES:
                    found.add(f"{properties['attribute_type']}:{properties['attribute_name']}")
            elif node["type"] == "ShaderNodeParticleInfo":
                found.update(key for name, key in PARTICLE_KEYS.items() if (index, name) in used)
            elif node["type"] in _OF_COORDINATES and properties.get("from_instancer"):
                found.update(_PLACES)
    return found


def takes_place_on_instancer(materials):
    """Whether nodes of evaluated Materials, or of groups in them, ask for it."""
    return any_node(
        materials, lambda node: node.bl_idname in _OF_COORDINATES and node.from_instancer
    )


def place_on_instancer(instance):
    """(generated x, y, z, u, v) of a DepsgraphObjectInstance; Blender counts the first three from -1 to 1."""
    return (*(0.5 * x - 0.5 for x in instance.orco), *instance.uv)


def prototype_value(prototype, key):
    """Four floats of a living InstancePrototype, or None where nothing of it has such a value."""
    if key == COLOR:
        # Blender gives what is instanced its instancer's colour.
        owner = prototype.source if prototype.parent is None else prototype.parent
        return tuple(owner.color)
    if key in _OF_INSTANCES:
        return None
    kind, name = key.split(":", 1)
    for owner in _owners(prototype, kind):
        value = find_value(owner, name)
        if value is not None:
            return value
    return None


def _owners(prototype, kind):
    """In Blender's order."""
    parent = prototype.parent
    if kind == "INSTANCER" and parent is not None:
        for system in parent.particle_systems:
            yield system.settings
        yield parent
    yield prototype.source
    if prototype.source.original.data is not None:
        # The original: to look at the evaluated data would make Blender subdivide a cage.
        yield prototype.source.original.data


class GeometryValues:
    """Attributes that geometry nodes give the instances that they make."""

    def __init__(self, report):
        self._report = report
        self._found = {}

    def of(self, prototype, key):
        """{outermost number of a persistent id: float32 [4]}, or None."""
        parent = prototype.parent
        if parent is None or not key.startswith("INSTANCER:"):
            return None
        if not any(modifier.type == "NODES" for modifier in parent.modifiers):
            return None
        name = key.split(":", 1)[1]
        if not hasattr(parent, "evaluated_geometry"):
            if prototype_value(prototype, key) is None:
                self._report(
                    f"object '{parent.name}'",
                    f"this Blender does not hand out the attribute '{name}' of its instances: 0",
                )
            return None
        known = parent.as_pointer(), name
        if known not in self._found:
            self._found[known] = _read(parent, name)
        return self._found[known]


def _read(parent, name):
    geometry = parent.evaluated_geometry()  # the points live as long as this does
    points = geometry.instances_pointcloud()
    attribute = points.attributes.get(name) if points is not None else None
    values = attribute_values(attribute) if attribute is not None else None
    if values is None:
        return None
    width = values.shape[1]
    rgba = np.zeros((len(values), 4), dtype=np.float32)
    rgba[:, 3] = 1.0
    rgba[:, :width] = values
    if width == 1:
        rgba[:, 1] = rgba[:, 2] = values[:, 0]
    ids = points.attributes.get("id")
    if ids is None:
        return dict(enumerate(rgba))
    # Whole: points on faces have numbers that single precision does not tell apart.
    numbers = np.empty(len(ids.data), dtype=np.int32)
    ids.data.foreach_get("value", numbers)
    return dict(zip(numbers.tolist(), rgba))
