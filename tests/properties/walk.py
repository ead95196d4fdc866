# SPDX-License-Identifier: GPL-3.0-or-later
"""Every property that can be set on what a probe shows, one flip a value.

A flip is made anew from its probe each time, so that no flip sees another's traces.
"""

from dataclasses import dataclass

import bpy
from values import assign, other_values

# Parts of a datablock that no render engine reads: the window's, other engines', simulation's, tools'.
UNREAD_STRUCTS = {
    "AnimData",
    "AnimVizMotionPaths",
    "AnimViz",
    "AssetMetaData",
    "BakeSettings",
    "CameraBackgroundImage",
    "Depsgraph",
    "DopeSheet",
    "FieldSettings",
    "FFmpegSettings",
    "IDMaterials",
    "ImageFormatSettings",
    "ImagePreview",
    "Library",
    "MaterialGPencilStyle",
    "MaterialLineArt",
    "ObjectDisplay",
    "ObjectLineArt",
    "RaytraceEEVEE",
    "RigidBodyWorld",
    "SceneDisplay",
    "SceneEEVEE",
    "SceneGpencil",
    "SceneHydra",
    "SequenceEditor",
    "ShaderNodeTree",
    "ToolSettings",
    "TransformOrientationSlot",
    "UnitSettings",
    "View3DCursor",
    "View3DShading",
    "ViewLayerEEVEE",
    "FreestyleSettings",
}
# Names and states of the interface, which every datablock or node has.
UNREAD_PROPERTIES = {
    "name",
    "rna_type",
    "tag",
    "use_fake_user",
    "use_extra_user",
    "is_runtime_data",
    "is_embedded_data",
    "original",
    "asset_data",
    "bl_description",
    "bl_height_default",
    "bl_height_max",
    "bl_height_min",
    "bl_icon",
    "bl_idname",
    "bl_label",
    "bl_static_type",
    "bl_width_default",
    "bl_width_max",
    "bl_width_min",
    "color_tag",
    "height",
    "hide",
    "label",
    "location_absolute",
    "parent",
    "select",
    "show_options",
    "show_preview",
    "show_texture",
    "use_custom_color",
    "warning_propagation",
    "width",
    "width_hidden",
}
# The same for nodes alone: where they stand in the editor, and their own colour there.
UNREAD_OF_NODES = {"location", "color"}
_DEPTH = 3


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
        return assign(find(roots, self.path), self.name, self.value)


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
        if name in roots and probe.sockets is not None:
            found += _socket_flips(probe, (name,), roots[name])
        elif name in roots:
            found += _struct_flips(probe, (name,), roots[name], set())
    for name in probe.deeds:
        found.append(Flip(probe.name, name, "done", (), name))
    return found


def _struct_flips(probe, path, struct, seen):
    kind = struct.bl_rna.identifier
    found = []
    for rna in struct.bl_rna.properties:
        name = rna.identifier
        if name in _unread(struct, probe) or rna.is_hidden and kind.startswith("Cycles"):
            continue
        if rna.type == "COLLECTION":
            if name == "inputs" and isinstance(struct, bpy.types.Node):
                found += _socket_flips(probe, path, struct)
            continue
        if rna.type == "POINTER" and rna.is_readonly:
            found += _part_flips(probe, path, struct, rna, seen)
            continue
        if rna.is_readonly:
            continue
        for text, value in other_values(struct, rna):
            found.append(Flip(probe.name, f"{kind}.{name}", text, path, name, value))
        if rna.type == "POINTER":
            found += _part_flips(probe, path, struct, rna, seen)
    return found


def _unread(struct, probe):
    if isinstance(struct, (bpy.types.ID, bpy.types.Node)):
        names = (
            UNREAD_PROPERTIES - {"parent"}
            if isinstance(struct, bpy.types.Object)
            else UNREAD_PROPERTIES
        )
        if isinstance(struct, bpy.types.Node):
            names = names | UNREAD_OF_NODES
        return names | probe.left_out
    return {"rna_type", "name"} | probe.left_out


def _part_flips(probe, path, struct, rna, seen):
    part = getattr(struct, rna.identifier)
    if part is None or isinstance(part, bpy.types.ID) or len(path) > _DEPTH:
        return []
    if part.bl_rna.identifier in UNREAD_STRUCTS or rna.identifier in seen:
        return []
    return _struct_flips(probe, (*path, rna.identifier), part, seen | {rna.identifier})


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
