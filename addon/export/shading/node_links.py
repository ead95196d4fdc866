# SPDX-License-Identifier: GPL-3.0-or-later
"""What really feeds a socket: through groups, reroutes and muted nodes, without recursion (files with
1,600 nested groups exist, and Python's stack ends before that)."""

from types import SimpleNamespace

import bpy

# EEVEE's, Freestyle's and what is no longer read; EEVEE's Specular BSDF is drawn as a diffuse one.
_NOT_IN_CYCLES = {
    "ShaderNodeLightAccumulation",
    "ShaderNodeLightEvaluation",
    "ShaderNodeLightInfo",
    "ShaderNodeShaderToRGB",
    "ShaderNodeShadowRaycast",
    "ShaderNodeSqueeze",
    "ShaderNodeUVAlongStroke",
}

# Stands for a socket.
NOTHING = SimpleNamespace(default_value=0.0, hide_value=False, type="VALUE")


class Scope:
    """A node tree in use: the material's own, or a group's as seen from one group node.

    Attributes:
        left_out: {(name, why): what to say} of the nodes that `trace` passed over, in this tree or any group's.
    """

    def __init__(self, tree, group_node=None, parent=None):
        self.tree = tree
        self.left_out = {} if parent is None else parent.left_out
        self.group_node = group_node
        self.parent = parent
        self._children = {}
        self._links = None

    def link(self, socket):
        """The link that feeds an input socket of this tree, or None.

        Blender's own list of a socket's links is a walk over all links of the tree, and every socket of it is
        asked for.
        """
        if self._links is None:
            self._links = {}
            for link in self.tree.links:
                if link.is_valid and not link.is_muted:
                    self._links.setdefault(link.to_socket.as_pointer(), link)
        return self._links.get(socket.as_pointer())

    def inside(self, group_node):
        """The scope of a group node's tree; the same object every time."""
        if group_node.name not in self._children:
            self._children[group_node.name] = Scope(group_node.node_tree, group_node, self)
        return self._children[group_node.name]

    def groups(self):
        """The scopes of the groups in this tree that are not muted, one after the other."""
        for node in self.tree.nodes:
            if node.type == "GROUP" and not node.mute and node.node_tree is not None:
                yield self.inside(node)


class Source:
    """Where a value comes from: a node's output, or a socket's own constant (`node` None).

    `through` holds the types of the sockets passed between, nearest to the source first: a colour
    that enters a group by a number socket is a number from there on.
    """

    __slots__ = ("node", "scope", "socket", "through")

    def __init__(self, scope, node, socket, through=()):
        self.scope = scope
        self.node = node
        self.socket = socket
        self.through = through

    @property
    def key(self):
        return id(self.scope), self.node.name

    @property
    def has_value(self):
        """Of a constant: whether it is what its socket holds, as what groups hide is."""
        return bool(self.through) or _has_constant(self.socket)


def is_connected(scope, socket):
    """Whether Cycles connects an input socket at all, be it to nothing: not to nodes that it does not have, nor to
    muted ones that hand nothing on."""
    link = scope.link(socket)
    if link is None:
        return False
    node = link.from_node
    if _is_muted(node):
        return _inner_socket(node, link.from_socket) is not None
    return _left_out(node) is None


def trace(scope, socket):
    """Follows an input socket to its source.

    Args:
        scope: Scope of the socket's node.
        socket: input NodeSocket.

    Returns:
        Source.  A link that leads nowhere counts as none: the source is the socket's own constant.  So
        does one from a node that Cycles does not have, EEVEE's or one whose add-on is gone, as in Cycles.
    """
    own = Source(scope, None, socket)
    link = scope.link(socket)
    if link is None:  # most sockets, of which a file has ten thousands
        return own
    passed, muted = [], False
    while True:
        link = scope.link(socket)
        if link is not None and not link.from_node.mute and (why := _left_out(link.from_node)):
            name = link.from_node.name
            scope.left_out[name, why] = (
                f"node '{name}' {why}: it is left out, what it feeds keeps its own values"
            )
            link = None
        if link is None:
            # Boundaries of groups hand on their own constants, muted nodes nothing: 0, as in Cycles, and
            # from Blender 5 on as if there were no link.
            if not _has_constant(own.socket) or not hasattr(socket, "default_value"):
                return own
            if muted:
                return own if bpy.app.version >= (5, 0, 0) else Source(scope, None, NOTHING)
            # Groups may hide what their sockets hold, which it is all the same.
            return Source(scope, None, socket, _types(passed))
        node, output = link.from_node, link.from_socket
        muted = _is_muted(node)
        if node.type == "REROUTE":
            socket = node.inputs[0]
        elif muted:
            inner = _inner_socket(node, output)
            if inner is None:
                return own
            socket = inner
        elif node.type == "GROUP":
            result = _group_result(node, output)
            if result is None:
                return own
            scope, socket = scope.inside(node), result
        elif node.type == "GROUP_INPUT":
            if scope.parent is None:
                return own
            outer = _by_identifier(scope.group_node.inputs, output.identifier)
            if outer is None:
                return own
            scope, socket = scope.parent, outer
        else:
            return Source(scope, node, output, _types(passed))
        passed.append(socket)


def _is_muted(node):
    """Reroutes do the same, muted or not."""
    return node.mute and node.type != "REROUTE"


def _inner_socket(node, output):
    """The input that a muted node hands on to an output, or None."""
    links = node.internal_links
    return next((link.from_socket for link in links if link.to_socket == output), None)


def _left_out(node):
    """Why Cycles has nothing of a node, or None."""
    if node.bl_rna.base is None:  # Blender knows of it what is true of all nodes
        return "is of a type that Blender does not know"
    if node.bl_idname in _NOT_IN_CYCLES:
        return "is unknown to Cycles"
    return "asks for Open Shading Language" if node.bl_idname == "ShaderNodeScript" else None


def _types(passed):
    return tuple(socket.type for socket in reversed(passed))


def _has_constant(socket):
    # One that a node does not show stands for something else, as Normal does; but a colour is what it is.
    return hasattr(socket, "default_value") and (not socket.hide_value or socket.type == "RGBA")


def _group_result(group_node, output):
    """The Group Output's input that feeds an output of the group node, or None."""
    tree = group_node.node_tree
    if tree is None:
        return None
    outputs = [node for node in tree.nodes if node.type == "GROUP_OUTPUT"]
    active = next((node for node in outputs if node.is_active_output), None)
    return None if active is None else _by_identifier(active.inputs, output.identifier)


def _by_identifier(sockets, identifier):
    return next((socket for socket in sockets if socket.identifier == identifier), None)
