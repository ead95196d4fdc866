# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that a mesh carries on its points, faces and corners: UV maps, colours, named attributes."""

import numpy as np

from ..base.snapshot import Attribute
from ..shading.used_nodes import any_node

# Blender's data type -> (member of an element, components, dtype that `foreach_get` copies fastest)
_LAYOUT = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, np.bool_),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
    "INT16_2D": ("value", 2, np.int32),
    "INT32_2D": ("value", 2, np.int32),
    "QUATERNION": ("value", 4, np.float32),
}
# Of the nodes Attribute, Color Attribute and UV Map.
_NAMING_PROPERTIES = {"attribute_name", "layer_name", "uv_map"}
# Blender's domain -> the snapshot's.
_DOMAINS = {"POINT": "POINT", "FACE": "FACE", "CORNER": "CORNER"}
# In place of a name: Geometry > Random Per Island, which the native side makes of edges.
ISLANDS = ".random_per_island"
# Geometry > Pointiness, by this name: Blender's own begin with a dot.
POINTINESS = ".pointiness"
# Inputs of shaders that ask for a tangent, by default around the z axis of Generated.
_STRETCHES = ("Anisotropic", "Anisotropy")
# Stands among the names for Blender's Generated coordinates, which are no attribute.
GENERATED = "\0generated"
# Nodes that take Generated where nothing is linked to their Vector, or at all times.
_BY_DEFAULT = {
    "ShaderNodeTexBrick",
    "ShaderNodeTexChecker",
    "ShaderNodeTexGradient",
    "ShaderNodeTexMagic",
    "ShaderNodeTexMusgrave",
    "ShaderNodeTexNoise",
    "ShaderNodeTexVoronoi",
    "ShaderNodeTexWave",
    "ShaderNodeTangent",
}


def requested_names(materials):
    """Names that exported materials look up on the mesh, GENERATED among them: a set of str.

    Args:
        materials: the snapshot's material records.
    """
    nodes = [node for material in materials for node in material.get("nodes", ())]
    names = {
        name
        for node in nodes
        for key, name in node.get("properties", {}).items()
        if key in _NAMING_PROPERTIES and name
    }
    if any("Random Per Island" in _linked(node).values() for node in nodes):
        names.add(ISLANDS)
    if any("Pointiness" in _linked(node).values() for node in nodes):
        names.add(POINTINESS)
    if any(map(_asks_for_generated, nodes)):
        names.add(GENERATED)
    return names


def _linked(node):
    """{input: output that it is linked to} of a node's record."""
    return {
        name: value[2]
        for name, value in node.get("inputs", {}).items()
        if isinstance(value, tuple) and value[0] == "LINK"
    }


def _asks_for_generated(node):
    linked = _linked(node)
    return (
        "Generated" in linked.values()
        or (node["type"] in _BY_DEFAULT and "Vector" not in linked)
        or (_is_stretched(node) and "Tangent" not in linked)
    )


def _is_stretched(node):
    """Whether its highlights are longer one way."""
    inputs = node.get("inputs", {})
    return any(inputs.get(name, 0.0) != 0.0 for name in _STRETCHES)


def asks_on_edges(mesh, materials):
    """Whether nodes of evaluated Materials show values that an evaluated Mesh has on its edges."""
    names = {attribute.name for attribute in mesh.attributes if attribute.domain == "EDGE"}
    return bool(names) and any_node(
        materials, lambda node: getattr(node, "attribute_name", None) in names
    )


def mesh_attributes(mesh, label, requested, report, is_cage=False):
    """Every UV map and colour attribute, and the generic attributes asked for.

    Args:
        mesh: evaluated Mesh.
        label: the mesh's name for messages.
        requested: names of generic attributes.
        report: called with (datablock, message).
        is_cage: the mesh is to be subdivided.

    Returns:
        list of Attribute, the UV map and the colour that are active for render first among theirs.
    """
    found = _uv_maps(mesh) + _colors(mesh, is_cage)
    taken = {attribute.name for attribute in found}
    for attribute, domain, values in shadable(mesh, requested - taken, _DOMAINS, label, report):
        found.append(Attribute(attribute.name, domain, "GENERIC", values))
    finite_attributes(found, label, report)
    return found


def shadable(data, names, domains, label, report):
    """Yields (attribute, the snapshot's domain, values) of those that there are; names those that cannot be shaded.

    Args:
        data: evaluated Mesh, Curves or PointCloud.
        domains: Blender's domain -> the snapshot's.
    """
    for name in sorted(names):
        attribute = data.attributes.get(name)
        if attribute is None:
            continue
        values, domain = attribute_values(attribute), domains.get(attribute.domain)
        if values is not None and attribute.domain == "EDGE":
            values, domain = _at_vertices(data, values, attribute.data_type), "POINT"
        if values is None or domain is None:
            report(
                label,
                f"attribute '{name}' ({attribute.data_type} on {attribute.domain}) cannot be shaded",
            )
            continue
        yield attribute, domain, values


def _at_vertices(mesh, values, data_type):
    """Means of the edges there, as in Cycles; 0 where there are none.  Since Blender 4 whole numbers have whole
    means, and a boolean is true where it is of any edge."""
    import bpy

    edges = np.empty((len(mesh.edges), 2), dtype=np.int32)
    mesh.edges.foreach_get("vertices", edges.reshape(-1))
    count = len(mesh.vertices)
    ends = edges.reshape(-1)
    met = np.bincount(ends, minlength=count).clip(1)
    by_end = np.repeat(values, 2, axis=0)
    sums = [np.bincount(ends, column, minlength=count) for column in by_end.T]
    means = np.stack(sums, axis=1) / met[:, None]
    if bpy.app.version < (4, 0, 0):
        return means.astype(np.float32)
    if data_type == "BOOLEAN":
        means = np.where(means > 0.0, 1.0, 0.0)
    elif data_type.startswith("INT"):
        means = np.copysign(np.floor(np.abs(means) + 0.5), means)  # halves away from 0
    return means.astype(np.float32)


def finite_attributes(attributes, label, report):
    """Takes values that are not finite as 0, and says so."""
    for attribute in attributes:
        broken = ~np.isfinite(attribute.values)
        if broken.any():
            report(label, f"'{attribute.name}' holds values that are not finite: taken as 0")
            attribute.values[broken] = 0.0


def _uv_maps(mesh):
    layers = sorted(mesh.uv_layers, key=lambda layer: not layer.active_render)
    maps = []
    for layer in layers:
        values = np.empty((len(mesh.loops), 2), dtype=np.float32)
        # Blender 3.5 made UV maps plain vectors, which are copied in one go.
        if hasattr(layer, "uv"):
            layer.uv.foreach_get("vector", values.reshape(-1))
        else:
            layer.data.foreach_get("uv", values.reshape(-1))
        maps.append(Attribute(layer.name, "CORNER", "UV", values))
    return maps


def _colors(mesh, is_cage):
    layers = list(mesh.color_attributes)
    active = mesh.color_attributes.render_color_index
    if 0 <= active < len(layers):
        layers.insert(0, layers.pop(active))
    return [_color(layer, is_cage and layer.data_type == "BYTE_COLOR") for layer in layers]


def _color(layer, encoded):
    """Of a cage the Subdivision modifier blends bytes as they are stored."""
    if not encoded:
        return Attribute(layer.name, layer.domain, "COLOR", attribute_values(layer))
    values = vectors(layer.data, "color_srgb", 4)
    return Attribute(layer.name, layer.domain, "COLOR", values, encoded=True)


def attribute_values(attribute):
    """float32 [elements, components], colours linear; None for types that hold no numbers."""
    if attribute.data_type not in _LAYOUT:
        return None
    member, width, dtype = _LAYOUT[attribute.data_type]
    values = np.empty(len(attribute.data) * width, dtype=dtype)
    attribute.data.foreach_get(member, values)
    return values.reshape(-1, width).astype(np.float32, copy=False)


def vectors(collection, member="vector", width=3):
    """float32 [n, width]."""
    values = np.empty((len(collection), width), dtype=np.float32)
    collection.foreach_get(member, values.reshape(-1))
    return values
