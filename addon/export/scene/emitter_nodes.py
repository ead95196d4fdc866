# SPDX-License-Identifier: GPL-3.0-or-later
"""What a light that the camera sees sends there, as nodes of geometry that glows.

Nodes of a light say the same on a mesh that stands for it, as long as what they ask of places and directions does: of an
area light that has the light's coordinates (`area_coordinates`), what the tables here name.
"""

import numpy as np

from ..base.snapshot import Attribute

# Those whose values are the same at each place of a light and in each direction from it, from one eye.
_PLACELESS = {
    *("ShaderNodeLightFalloff", "ShaderNodeLightPath", "ShaderNodeValue", "ShaderNodeRGB"),
    *("ShaderNodeMath", "ShaderNodeMixRGB", "ShaderNodeMix", "ShaderNodeBlackbody"),
    *("FunctionNodeIntegerMath", "FunctionNodeBooleanMath", "GeometryNodeInputSceneTime"),
}
# Those that know of places only what they are told, or Generated and UV.
_TOLD = _PLACELESS | {
    *("ShaderNodeTexImage", "ShaderNodeTexNoise", "ShaderNodeTexWave", "ShaderNodeTexGradient"),
    *("ShaderNodeTexChecker", "ShaderNodeTexVoronoi", "ShaderNodeTexMusgrave"),
    *("ShaderNodeTexMagic", "ShaderNodeTexBrick", "ShaderNodeTexWhiteNoise"),
    *("ShaderNodeMapping", "ShaderNodeVectorMath", "ShaderNodeMapRange", "ShaderNodeClamp"),
    *("ShaderNodeSeparateXYZ", "ShaderNodeCombineXYZ", "ShaderNodeSeparateColor"),
    "FunctionNodeGetVectorComponent",
    *("ShaderNodeCombineColor", "ShaderNodeSeparateRGB", "ShaderNodeCombineRGB"),
    *("ShaderNodeValToRGB", "ShaderNodeRGBToBW", "ShaderNodeRGBCurve", "ShaderNodeGamma"),
    *("ShaderNodeBrightContrast", "ShaderNodeHueSaturation", "ShaderNodeInvert"),
}
_TOLD_OUTPUTS = {
    "ShaderNodeTexCoord": {"Generated", "UV", "Object"},
    "ShaderNodeNewGeometry": {"Position", "Normal", "True Normal", "Incoming", "Parametric"},
}
_PARAMETRIC = "light's Parametric"


def emission_nodes(lamp, radiance, report):
    """(nodes of what it sends to the camera, the last an Emission; whether they tell places apart)."""
    plain = node("ShaderNodeEmission", Color=radiance, Strength=1.0)
    if "nodes" not in lamp:
        return [plain], False
    *before, own = lamp["nodes"]
    is_placeless = all(one["type"] in _PLACELESS for one in before)
    knows_places = lamp["kind"] == "AREA" and _are_told(lamp["nodes"])
    if own["type"] != "ShaderNodeEmission" or not (is_placeless or knows_places):
        report(f"light '{lamp['name']}'", "is drawn to the camera without its nodes")
        return [plain], False
    inputs = {"Fac": 1.0, "Color1": own["inputs"]["Color"], "Color2": radiance}
    tint = node("ShaderNodeMixRGB", **inputs)
    tint["properties"]["blend_type"] = "MULTIPLY"
    emission = {**own, "inputs": {**own["inputs"], "Color": link(len(before), "Color")}}
    return _with_parametric([*before, tint, emission]), not is_placeless


def area_coordinates(lamp, geometry, matrices):
    """Gives a polygon, which has points of the light's own space, what nodes of an area light are told.

    Returns: float64 [K, 4, 4], where it stands: in the world itself until lamps became objects (Blender 4.5), whose
    places nodes are told until then.
    """
    version = lamp["nodes"][-1]["properties"]["version"]
    local = geometry.points[0].astype(np.float64)
    size = np.array(lamp["size"])
    if lamp["shape"] in ("SQUARE", "DISK"):
        size[1] = size[0]
    parameters = (0.5 + local[:, :2] / size).astype(np.float32)
    geometry.attributes = [Attribute(_PARAMETRIC, "POINT", "GENERIC", parameters)]
    if version >= 400:
        corners = parameters[geometry.corner_verts]
        geometry.attributes.insert(0, Attribute("UVMap", "CORNER", "UV", corners))
    if version >= 405:
        geometry.generated = geometry.points[0]
        return matrices
    places = local @ matrices[:, :3, :3].transpose(0, 2, 1) + matrices[:, None, :3, 3]
    geometry.points = places.astype(np.float32)
    geometry.generated = geometry.points[len(matrices) // 2]
    return np.eye(4)[None]


def _are_told(nodes):
    asked = [(nodes[source]["type"], output) for _, _, source, output in _links(nodes)]
    return all(
        one["type"] in _TOLD or one["type"] in _TOLD_OUTPUTS or one is nodes[-1] for one in nodes
    ) and all(output in _TOLD_OUTPUTS.get(kind, {output}) for kind, output in asked)


def _links(nodes):
    """(index, input, index of its source, output) of each link."""
    for index, one in enumerate(nodes):
        for name, value in one["inputs"].items():
            if _is_link(value):
                yield index, name, value[1], value[2]


def _with_parametric(nodes):
    """Nodes whose Parametric is the attribute of `area_coordinates`."""
    asking = [found[:2] for found in _links(nodes) if found[3] == "Parametric"]
    if not asking:
        return nodes
    attribute = node("ShaderNodeAttribute")
    attribute["properties"]["attribute_name"] = _PARAMETRIC
    moved = [attribute] + [
        {**one, "inputs": {name: _later(value) for name, value in one["inputs"].items()}}
        for one in nodes
    ]
    for index, name in asking:
        moved[index + 1]["inputs"][name] = link(0, "Vector")
    return moved


def _later(value):
    return link(value[1] + 1, value[2]) if _is_link(value) else value


def _is_link(value):
    return isinstance(value, tuple) and value[:1] == ("LINK",)


def node(kind, **inputs):
    return {"type": kind, "name": kind, "inputs": inputs, "properties": {}}


def link(index, output):
    return ("LINK", index, output)
