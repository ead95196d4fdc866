# SPDX-License-Identifier: GPL-3.0-or-later
"""What a shader node's socket holds where constants alone feed it: lights have no shading points at which a
tree could be evaluated."""

import operator

from .node_links import Scope, trace
from .spectrum import blackbody
from .working_space import luminance, scene_color

_MATH = {
    "ADD": operator.add,
    "SUBTRACT": operator.sub,
    "MULTIPLY": operator.mul,
    "DIVIDE": lambda a, b: a / b if b else 0.0,
    "POWER": lambda a, b: a**b if a >= 0.0 else 0.0,
    "MINIMUM": min,
    "MAXIMUM": max,
}


def constant(tree, socket):
    """(A float, a list of floats, or None where something varies or is not understood; what to say of the
    nodes that feed it and are left out).

    Args:
        tree: node tree of the datablock.
        socket: input of one of its own nodes.
    """
    scope = Scope(tree)
    return _value(trace(scope, socket)), list(scope.left_out.values())


def _value(source):
    node = source.node
    if node is None:
        value = source.socket.default_value
        return list(value)[:3] if hasattr(value, "__len__") else float(value)
    if node.type in ("VALUE", "RGB"):
        value = node.outputs[0].default_value
        return list(value)[:3] if node.type == "RGB" else float(value)
    if node.type == "MATH" and node.operation in _MATH:
        a, b = (as_number(_value(trace(source.scope, socket))) for socket in node.inputs[:2])
        if a is None or b is None:
            return None
        result = _MATH[node.operation](a, b)
        return min(max(result, 0.0), 1.0) if node.use_clamp else result
    if node.type == "BLACKBODY":
        temperature = as_number(_value(trace(source.scope, node.inputs[0])))
        return None if temperature is None else scene_color(blackbody(temperature)).tolist()
    if node.type == "LIGHT_FALLOFF" and source.socket.name == "Quadratic":
        # Without smoothing this is what light does anyway.
        smooth = _value(trace(source.scope, node.inputs["Smooth"]))
        if smooth == 0.0:
            return _value(trace(source.scope, node.inputs["Strength"]))
    return None


def as_number(value):
    """As Cycles converts a colour to a number."""
    if isinstance(value, list):
        return float(luminance() @ value)
    return value
