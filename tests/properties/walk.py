# SPDX-License-Identifier: GPL-3.0-or-later
"""Every property that can be set on what a probe shows, one flip a value.

A flip is made anew from its probe each time, so that no flip sees another's traces.
"""

from dataclasses import dataclass

import bpy
import unwalked
from values import assign, other_values

# Attributes below a root that are entered: `node.mapping.curves[0].points[0].location` is one of the deepest.
_DEPTH = 4


@dataclass(frozen=True)
class Flip:
    """One change of a probe."""

    probe: str
    key: str  # "PointLight.energy": what the table of exceptions names
    text: str  # its value, or what is done
    path: tuple  # of the struct, from the probe's roots; () for a deed
    name: str  # of the property, or of the deed
    value: object = None

    @property
    def identifier(self):
        path = ".".join(str(step) for step in self.path)
        return f"{self.probe}: {path}{'.' if path else ''}{self.name} = {self.text}"

    def apply(self, probe, roots):
        """Makes the change; whether there was one."""
        if not self.path:
            return probe.deeds[self.name](roots) is not False
        within = [find(roots, self.path[:steps]) for steps in range(1, len(self.path))]
        curves = [struct for struct in within if isinstance(struct, bpy.types.CurveMapping)]
        for curve in curves:
            curve.use_clip = False  # its editor lets no point leave the range else
        is_taken = assign(find(roots, self.path), self.name, self.value)
        for curve in curves:
            curve.update()  # as its editor does
        return is_taken


def find(roots, path):
    """The struct of a path: a root's name, then attributes, or places in collections."""
    struct = roots[path[0]]
    for step in path[1:]:
        struct = getattr(struct, step) if isinstance(step, str) else struct[step]
    return struct


def flips(probe, roots):
    """All flips of a probe whose scene stands."""
    found = []
    for name in probe.walked:
        path = tuple(name.split("."))
        if path[0] not in roots:
            continue
        struct = find(roots, path)
        if probe.sockets is not None:
            found += _socket_flips(probe, path, struct)
        else:
            found += _struct_flips(probe, path, struct, set())
    for name in probe.deeds:
        found.append(Flip(probe.name, name, "done", (), name))
    return found


def _struct_flips(probe, path, struct, seen):
    kind = struct.bl_rna.identifier
    found = []
    for rna in struct.bl_rna.properties:
        name = rna.identifier
        if name in _unread(struct, path, probe) or rna.is_hidden and kind.startswith("Cycles"):
            continue
        if rna.type == "COLLECTION":
            found += _member_flips(probe, path, struct, rna, seen)
            continue
        if not rna.is_readonly:
            for text, value in other_values(struct, rna):
                found.append(Flip(probe.name, f"{kind}.{name}", text, path, name, value))
        if rna.type == "POINTER":
            part = getattr(struct, name)
            found += _part_flips(probe, (*path, name), part, name, seen)
    return found


def _unread(struct, path, probe):
    if isinstance(struct, bpy.types.Node):
        return unwalked.names("names", "nodes") | probe.left_out
    if isinstance(struct, bpy.types.Object):
        return unwalked.names("names") - {"parent"} | probe.left_out
    if isinstance(struct, bpy.types.ID):
        return unwalked.names("names") | probe.left_out
    # Parts go by their names: UV maps and attributes are looked up so.
    is_member = isinstance(path[-1], int)
    return probe.left_out | ({"rna_type"} if is_member else {"rna_type", "name"})


def _part_flips(probe, path, part, name, seen):
    if part is None or isinstance(part, bpy.types.ID) or name in seen:
        return []
    if sum(isinstance(step, str) for step in path) > _DEPTH + 1:
        return []
    if part.bl_rna.identifier in unwalked.names("structs"):
        return []
    return _struct_flips(probe, path, part, seen | {name})


def _member_flips(probe, path, struct, rna, seen):
    """Of a collection's first member and its last; Blender's own attributes, with a dot before the name, are not seen."""
    name = rna.identifier
    if name == "inputs" and isinstance(struct, bpy.types.Node):
        return _socket_flips(probe, path, struct)
    if name in unwalked.names("collections"):
        return []
    members = getattr(struct, name)
    places = [i for i, member in enumerate(members) if not _is_hidden(member)]
    found = []
    for place in sorted({*places[:1], *places[-1:]}):
        found += _part_flips(probe, (*path, name, place), members[place], name, seen)
    return found


def _is_hidden(member):
    return isinstance(member, bpy.types.Attribute) and member.name.startswith(".")


def can_be_flipped(socket):
    return socket.enabled and not socket.hide_value and hasattr(socket, "default_value")


def _socket_flips(probe, path, node):
    found = []
    for place, socket in enumerate(node.inputs):
        if not can_be_flipped(socket) or probe.sockets is not None and place not in probe.sockets:
            continue
        rna = socket.bl_rna.properties["default_value"]
        key = f"{node.bl_idname}[{socket.identifier}]"
        for text, value in other_values(socket, rna):
            text = f"{socket.identifier} {text}"
            found.append(
                Flip(probe.name, key, text, (*path, "inputs", place), "default_value", value)
            )
    return found
