# SPDX-License-Identifier: GPL-3.0-or-later
"""A shader node tree as the flat graph of docs/scene_snapshot.md: nodes in evaluation order, under the
socket names of Blender 4, with groups, reroutes and mutes gone."""

import bpy

from .node_links import Scope, trace
from .node_properties import node_properties
from .output_nodes import fed_socket, output_nodes

# Sockets that Blender 4 renamed: {bl_idname: {old identifier: new}}.
_PRINCIPLED = {
    "Subsurface": "Subsurface Weight",
    "Specular": "Specular IOR Level",
    "Sheen": "Sheen Weight",
    "Clearcoat": "Coat Weight",
    "Clearcoat Roughness": "Coat Roughness",
    "Clearcoat Normal": "Coat Normal",
    "Transmission": "Transmission Weight",
    "Emission": "Emission Color",
}
_RENAMED = {"ShaderNodeBsdfPrincipled": _PRINCIPLED}
# Blender 5 spells some sockets out.
_SHORT = {"Factor": "Fac"}


class FlatGraph:
    """Nodes so far, each once a scope."""

    def __init__(self, tree, owner, images, report):
        self._root = Scope(tree)
        self._outputs = output_nodes(self._root)
        self._owner = owner
        self._images = images
        self._report = report
        self._index = {}
        self.nodes = []

    def add_output(self, name):
        """Adds all that feeds a socket of the output node.

        Args:
            name: "Surface", "Displacement" or "Volume".

        Returns:
            (node index, output identifier), or None where nothing is linked.
        """
        fed = fed_socket(self._outputs, name)
        if fed is None:
            return None
        source = trace(*fed)
        if source.node is not None:
            self._add_nodes(source)
        self._report_left_out()
        if source.node is None:
            return None
        return self._index[source.key], output_identifier(source.socket)

    def add_aov_outputs(self, names):
        """Adds the AOV Output nodes of those names, groups' too, with all that feeds them."""
        scopes = [self._root] if names else []
        while scopes:
            scope = scopes.pop()
            scopes.extend(scope.groups())
            for node in scope.tree.nodes:
                is_asked = node.bl_idname == "ShaderNodeOutputAOV" and not node.mute
                if is_asked and aov_name(node) in names:
                    self._add_aov_output(scope, node)
        self._report_left_out()

    def _report_left_out(self):
        for said in self._root.left_out.values():
            self._report(self._owner, said)
        self._root.left_out.clear()

    def _add_aov_output(self, scope, node):
        inputs = {}
        for socket in node.inputs:
            origin = trace(scope, socket)
            if origin.node is not None:
                self._add_nodes(origin)
            self._add_input(inputs, socket.identifier, origin, node)
        properties = {"aov_name": aov_name(node), "version": version()}
        self.nodes.append(
            {
                "type": node.bl_idname,
                "name": f"AOV Output {aov_name(node)}",
                "inputs": inputs,
                "properties": properties,
            }
        )

    def _add_nodes(self, root):
        pending, entered = [(root, None)], set()
        while pending:
            source, inputs = pending.pop()
            if source.key in self._index:
                continue
            if inputs is not None:
                self._emit(source, inputs)
            elif source.key not in entered:
                entered.add(source.key)
                inputs = _traced_inputs(source)
                pending.append((source, inputs))
                pending.extend((s, None) for s in inputs.values() if s.node is not None)

    def _emit(self, source, sources):
        node = source.node
        inputs = {}
        for name, origin in sources.items():
            self._add_input(inputs, name, origin, node)
        properties = node_properties(node, self._owner, self._images, self._report)
        self._index[source.key] = len(self.nodes)
        self.nodes.append(
            {
                "type": node.bl_idname,
                "name": node.name,
                "inputs": inputs,
                "properties": {**properties, "version": version()},
            }
        )

    def _add_input(self, inputs, name, origin, node):
        if origin.node is None:
            value = _constant(origin.socket) if origin.has_value else None
        elif origin.key in self._index:
            value = self._converted_link(origin)
        else:
            self._report(self._owner, f"node '{node.name}': its links run in a circle")
            return
        if value is not None:
            inputs[name] = value

    def _converted_link(self, origin):
        """The link, behind a conversion node where the socket types in between ask for one."""
        link = ("LINK", self._index[origin.key], output_identifier(origin.socket))
        if "VALUE" not in origin.through or origin.socket.type not in ("RGBA", "VECTOR"):
            return link
        if origin.socket.type == "RGBA":
            kind, inputs, output, properties = "ShaderNodeRGBToBW", {"Color": link}, "Val", {}
        else:
            third = (1 / 3, 1 / 3, 1 / 3)
            kind, inputs = "ShaderNodeVectorMath", {"Vector": link, "Vector_001": third}
            output, properties = "Value", {"operation": "DOT_PRODUCT"}
        self.nodes.append(
            {
                "type": kind,
                "name": "conversion",
                "inputs": inputs,
                "properties": {**properties, "version": version()},
            }
        )
        return ("LINK", len(self.nodes) - 1, output)


def version():
    """Of Blender, whose releases change what nodes mean: 405 is 4.5."""
    return 100 * bpy.app.version[0] + bpy.app.version[1]


def aov_name(node):
    """Blender 4.1 renamed the property, which had hidden the node's own name."""
    return node.aov_name if hasattr(node, "aov_name") else node.name


def output_identifier(socket):
    return _SHORT.get(socket.identifier, socket.identifier)


def _traced_inputs(source):
    """{identifier: Source} of the inputs in use."""
    renamed = _RENAMED.get(source.node.bl_idname, {})
    found = {}
    for socket in source.node.inputs:
        if socket.enabled:
            name = renamed.get(socket.identifier, _SHORT.get(socket.identifier, socket.identifier))
            found[name] = trace(source.scope, socket)
    return found


def _constant(socket):
    """A float, a tuple of floats, or None for sockets whose default is not a constant."""
    value = socket.default_value
    if isinstance(value, (int, float)):
        return float(value)
    if isinstance(value, str) or not hasattr(value, "__len__"):
        return None
    return tuple(float(x) for x in value)
