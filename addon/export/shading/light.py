# SPDX-License-Identifier: GPL-3.0-or-later
"""A light of Blender as the plain record of docs/scene_snapshot.md, read as Cycles reads it.

Where Cycles changed its mind between Blenders, a light means what the host's own Cycles means by it;
nothing but the version tells these changes.
"""

import math

import bpy

from .constant_nodes import as_number, constant
from .inlined_tree import inlined
from .node_links import Scope, trace
from .nodes import FlatGraph
from .output_nodes import fed_socket, output_nodes

_AREA_SHAPES = {"SQUARE", "RECTANGLE", "DISK", "ELLIPSE"}


def light_record(light_object, matrices, report, images=None):
    """One entry of the snapshot's `lights`.

    Args:
        light_object: evaluated Object of type LIGHT.
        matrices: float64 [K, 4, 4], world from light; None: not yet known.
        report: called with (datablock, message) for what cannot be taken over.
        images: {name: record}; those that its nodes show are added.  None: nodes that vary are not taken over.

    Returns:
        dict of plain values; a light that Cycles would not let shine has energy 0.
    """
    light = light_object.data
    label = f"light '{light_object.name}'"
    read = _with_nodes(light)
    graph = None if images is None else _graph(read, label, images, report)
    color, factor = ([1.0] * 3, 1.0) if graph else _emission(read, label, report)
    if getattr(light, "use_temperature", False):
        color = [c * t for c, t in zip(color, light.temperature_color)]
    for name in ("diffuse_factor", "specular_factor"):
        if getattr(light, name, 1.0) != 1.0:
            report(label, f"{name} is EEVEE's alone and is not used")
    shape = getattr(light, "shape", "SQUARE")
    size = getattr(light, "size", 0.0)
    return {
        **(graph or {}),
        "name": light_object.name,
        "kind": light.type,
        "world_from_light": matrices,
        "color": [c * x for c, x in zip(light.color, color)],
        "energy": _energy(light_object, factor),
        "radius": getattr(light, "shadow_soft_size", 0.0) if light.type in ("POINT", "SPOT") else 0,
        "soft_falloff": bool(getattr(light, "use_soft_falloff", True)),
        "sun_angle": getattr(light, "angle", 0.0),
        # Before 4.0 a wide sun was dimmer, and brightest at its rim.
        "sun_flat": bpy.app.version < (4, 0, 0),
        "spot_size": getattr(light, "spot_size", 0.0),
        "spot_blend": getattr(light, "spot_blend", 0.0),
        # Until 3.4 a spot was dimmed by the cosine to its axis and its cone ignored the scale.
        "spot_cosine": bpy.app.version < (3, 5, 0),
        "shape": shape if shape in _AREA_SHAPES else "SQUARE",
        "size": [size, getattr(light, "size_y", size) if _has_two_sizes(shape) else size],
        "spread": getattr(light, "spread", math.pi),
        "casts_shadow": bool(getattr(*shadow_switch(light))),
        "lights_catchers": bool(light_object.is_shadow_catcher),
        "visible_camera": bool(light_object.visible_camera),
        "visible_diffuse": bool(light_object.visible_diffuse),
        "visible_glossy": bool(light_object.visible_glossy),
        "visible_transmission": bool(light_object.visible_transmission),
        "visible_volume": bool(light_object.visible_volume_scatter),
        "most_bounces": _cycles(light, "max_bounces", 1024),
        "diffuse_factor": 1.0,
        "specular_factor": 1.0,
    }


def light_energy(light_object, has_graph=None):
    """(energy of its record, whether that has its nodes).

    Args:
        light_object: evaluated Object of type LIGHT.
        has_graph: the same of another time, as links are not animated; None: not yet known.
    """

    def silent(_datablock, _message):
        """The record tells."""

    if has_graph:
        return _energy(light_object, 1.0), True
    read = _with_nodes(light_object.data)
    if has_graph is None:
        has_graph = _graph(read, "", {}, silent) is not None
    factor = 1.0 if has_graph else _emission(read, "", silent)[1]
    return _energy(light_object, factor), has_graph


def _energy(light_object, factor):
    """Of a light whose nodes have the strength `factor`."""
    light = light_object.data
    energy = light.energy * factor * 2.0 ** getattr(light, "exposure", 0.0)
    if light.type == "AREA" and bpy.app.version < (4, 0, 0):
        energy *= math.pi / 4.0  # radiance was P / (4 A) until 4.0 made it P / (pi A)
    if not getattr(light, "normalize", True):
        energy *= _area(light, light_object.matrix_world)
    if light.type == "AREA" and _cycles(light, "is_portal", False):
        energy = 0.0  # it guides samples to the world, which needs no guide here
    return energy


def shadow_switch(light):
    """(owner, property) that says whether a light casts shadows: Cycles' own, where it has one."""
    cycles = getattr(light, "cycles", None)
    return (cycles, "cast_shadow") if hasattr(cycles, "cast_shadow") else (light, "use_shadow")


def _has_two_sizes(shape):
    return shape in ("RECTANGLE", "ELLIPSE")


def _cycles(light, name, default):
    """A property of Cycles' add-on, where it is enabled and has it."""
    return getattr(getattr(light, "cycles", None), name, default)


def _area(light, matrix):
    """What Cycles divides a normalised light's power by, in its own units (Light::area)."""
    if light.type in ("POINT", "SPOT"):
        radius = light.shadow_soft_size
        return 4.0 * math.pi * radius * radius if radius > 0.0 else 4.0
    if light.type == "SUN":
        half = 0.5 * light.angle
        return math.pi * math.sin(half) ** 2 if half > 0.0 else 1.0
    size_y = light.size_y if _has_two_sizes(light.shape) else light.size
    area = light.size * matrix.col[0].length * size_y * matrix.col[1].length
    return area * (math.pi / 4.0 if light.shape in ("DISK", "ELLIPSE") else 1.0)


def _with_nodes(light):
    """What has the light's nodes as its `node_tree`, or None where it uses none."""
    return inlined(light) if light.use_nodes and light.node_tree is not None else None


def _graph(read, label, images, report):
    """{"nodes": ..., "surface": ...} of a light whose nodes vary, else None."""
    source = None if read is None else _surface(Scope(read.node_tree))
    if source is None:  # _emission() says why
        return None
    if _is_plain_emission(source):
        inputs = [source.node.inputs[name] for name in ("Color", "Strength")]
        if all(constant(read.node_tree, i)[0] is not None for i in inputs):
            return None
    graph = FlatGraph(read.node_tree, label, images, report)
    surface = graph.add_output("Surface")
    return {"nodes": graph.nodes, "surface": surface}


def _surface(scope):
    """Source of the surface, or None: nothing is linked, or it is muted or left out."""
    fed = fed_socket(output_nodes(scope), "Surface")
    source = trace(*fed) if fed else None
    return source if source and source.node else None


def _is_plain_emission(source):
    """Of the light's own tree, not of a group in it."""
    return source.node.type == "EMISSION" and source.scope.parent is None


def _emission(read, label, report):
    """Colour and strength of the light's Emission node; white and 1 without nodes."""
    if read is None:
        return [1.0] * 3, 1.0
    scope = Scope(read.node_tree)
    source = _surface(scope)
    for said in scope.left_out.values():
        report(label, said)
    if source is None:
        return [1.0] * 3, 0.0
    node = source.node
    if not _is_plain_emission(source):
        report(label, f"its node '{node.name}' is not understood: it shines white, strength 1")
        return [1.0] * 3, 1.0
    found = []
    for name in ("Color", "Strength"):
        value, left_out = constant(read.node_tree, node.inputs[name])
        for said in left_out:
            report(label, said)
        if value is None:
            report(label, f"what is linked to {name} of '{node.name}' varies and is not used")
            value = node.inputs[name].default_value
        found.append(value)
    return _color(found[0]), as_number(found[1])


def _color(value):
    return list(value[:3]) if hasattr(value, "__len__") else [value] * 3
