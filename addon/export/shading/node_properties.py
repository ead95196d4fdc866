# SPDX-License-Identifier: GPL-3.0-or-later
"""What is set on a node beside its sockets: enums, numbers, ramps, curves, images."""

from functools import cache

import numpy as np

from .ies import ies_table
from .image import image_name, image_tiles
from .spectrum import TEMPERATURES, WAVELENGTHS, blackbody, monochromatic
from .texture_mapping import is_unmoved, mapping_rows
from .working_space import scene_color

# Cycles tabulates ramps and curves with as many entries; steps then fall on the same places.
TABLE_SIZE = 256


def node_properties(node, owner, images, report):
    """The snapshot's `properties` of a node.

    Args:
        node: shader node.
        owner: datablock for messages.
        images: {name: record}; images that the node shows are added.
        report: called with (datablock, message).

    Returns:
        dict of float, str and float32 arrays.
    """
    found = _plain_properties(node)
    mapping = getattr(node, "texture_mapping", None)
    if mapping is not None and not is_unmoved(mapping):
        found["texture_mapping"] = mapping_rows(mapping)
        found["texture_mapping_is_unit"] = float(mapping.vector_type == "NORMAL")
    special = _SPECIAL.get(node.bl_idname)
    if special is not None:
        found.update(special(node, owner, images, report))
    return found


def _plain_properties(node):
    """Every number and enum that the node's type adds to those of all nodes."""
    found = {}
    for name, is_number, is_array in _own_properties(type(node)):
        value = getattr(node, name, None)
        if value is None:  # one of an add-on's that is gone since
            continue
        if is_array:
            value = np.array(value, dtype=np.float32).ravel()
        found[name] = float(value) if is_number and not is_array else value
    return found


@cache
def _own_properties(node_type):
    """[(name, is it a number, is it an array of them)]; the same for all nodes of a type, and slow to ask for."""
    common = set(node_type.bl_rna.base.properties.keys())
    found = []
    for rna in node_type.bl_rna.properties:
        if rna.identifier in common:
            continue
        is_number = rna.type in ("BOOLEAN", "INT", "FLOAT")
        if is_number or rna.type == "STRING" or (rna.type == "ENUM" and not rna.is_enum_flag):
            found.append((rna.identifier, is_number, is_number and getattr(rna, "is_array", False)))
    return found


def _value(node, *_):
    return {"value": float(node.outputs[0].default_value)}


def _color(node, *_):
    return {"color": np.array(node.outputs[0].default_value, dtype=np.float32)}


def _ramp(node, *_):
    ramp = node.color_ramp
    places = np.arange(TABLE_SIZE) / (TABLE_SIZE - 1)
    table = np.array([ramp.evaluate(x) for x in places], dtype=np.float32)
    steps = ramp.interpolation == "CONSTANT"
    return {"ramp": table.ravel(), "interpolation": "CONSTANT" if steps else "LINEAR"}


def _free_curves(node, *_):
    """Curves without one over all of them; a single one three times."""
    mapping = node.mapping
    mapping.update()  # clips its points, as Cycles does first
    mapping.initialize()
    curves = list(mapping.curves)[:3]
    low = min(curve.points[0].location[0] for curve in curves)
    high = max(curve.points[-1].location[0] for curve in curves)
    table = np.array(
        [
            [mapping.evaluate(curve, x) for curve in curves] * (3 // len(curves))
            for x in np.linspace(low, high, TABLE_SIZE)
        ],
        dtype=np.float32,
    )
    return {"curves": table.ravel(), "low": float(low), "high": float(high)}


def _direction(node, *_):
    return {"direction": np.array(node.outputs[0].default_value, dtype=np.float32)}


def _blackbody(_node, *_):
    return _spectrum(blackbody, TEMPERATURES, 512)


def _wavelength(_node, *_):
    return _spectrum(monochromatic, WAVELENGTHS, 401)


def _spectrum(color_of, ends, count):
    table = scene_color([color_of(x) for x in np.linspace(*ends, count)]).astype(np.float32)
    return {"spectrum": table.ravel(), "low": ends[0], "high": ends[1]}


def _curves(node, *_):
    mapping = node.mapping
    mapping.update()  # clips its points, as Cycles does first
    mapping.initialize()
    curves = list(mapping.curves)
    low = min(curve.points[0].location[0] for curve in curves)
    high = max(curve.points[-1].location[0] for curve in curves)
    table = np.empty((TABLE_SIZE, 3), dtype=np.float32)
    for i, x in enumerate(np.linspace(low, high, TABLE_SIZE)):
        together = mapping.evaluate(curves[3], x)
        table[i] = [mapping.evaluate(curve, together) for curve in curves[:3]]
    return {"curves": table.ravel(), "low": float(low), "high": float(high)}


# The node that shows more than the first tile of an image.
_TILED = "ShaderNodeTexImage"


def _image_texture(node, owner, images, report):
    if node.image is None:
        return {}
    tiles = image_tiles(node.image, images, report) if node.bl_idname == _TILED else {}
    if tiles:
        first = tiles.get(1001, tiles[min(tiles)])
        numbers = np.array(sorted(tiles), dtype=np.float32)
        found = {"image": first, "tiles_of": node.image.name_full, "tiles": numbers}
    else:
        found = {"image": image_name(node.image, node.image_user, images, report)}
    # Cycles divides the colour by alpha only where the node's alpha is used as well.
    record = images[found["image"]]
    alpha = next((socket for socket in node.outputs if socket.identifier == "Alpha"), None)
    packed = record["alpha_mode"] in ("CHANNEL_PACKED", "NONE")
    data = record["colorspace"] == "Non-Color"
    found["unassociate_alpha"] = float(bool(alpha and alpha.is_linked and not packed and not data))
    return found


def _texture_coordinate(node, owner, images, report):
    if node.object is None:
        return {}
    matrix = np.array(node.object.matrix_world.inverted_safe(), dtype=np.float32)
    return {"object_from_world": matrix.ravel()}


def _ies(node, *_):
    return ies_table(node)


_SPECIAL = {
    "ShaderNodeValue": _value,
    "ShaderNodeRGB": _color,
    "ShaderNodeValToRGB": _ramp,
    "ShaderNodeRGBCurve": _curves,
    "ShaderNodeVectorCurve": _free_curves,
    "ShaderNodeFloatCurve": _free_curves,
    "ShaderNodeNormal": _direction,
    "ShaderNodeBlackbody": _blackbody,
    "ShaderNodeVolumePrincipled": _blackbody,
    "ShaderNodeWavelength": _wavelength,
    "ShaderNodeTexImage": _image_texture,
    "ShaderNodeTexEnvironment": _image_texture,
    "ShaderNodeTexCoord": _texture_coordinate,
    "ShaderNodeTexIES": _ies,
}
