# SPDX-License-Identifier: GPL-3.0-or-later
"""Every shader node: each output, each socket, each property."""

import contextlib

import bpy
import numpy as np
import scene_parts
import stage
import unwalked
from probe import Probe
from walk import can_be_flipped

# What is no node of a material, or needs a file or a language of its own.
_LEFT_OUT = {
    "ShaderNode",
    "ShaderNodeCustomGroup",
    "ShaderNodeGroup",
    "ShaderNodeLightIterInternalInput",
    "ShaderNodeLightIterInternalOutput",
    "ShaderNodeOutputAOV",
    "ShaderNodeOutputLight",
    "ShaderNodeOutputLineStyle",
    "ShaderNodeOutputMaterial",
    "ShaderNodeOutputWorld",
    "ShaderNodeScript",
    "ShaderNodeTree",
    "ShaderNodeUVAlongStroke",
    "ShaderNodeShaderToRGB",
}
_SHOWN = 0.25  # of an output, so that several fit below 1
# Constants that make sockets count which multiply with something that is 0 from the start.
_CLEAR = {
    "ShaderNodeBsdfPrincipled": {
        "Transmission": 0.5,
        "Transmission Weight": 0.5,
        "Subsurface Weight": 0.5,
        "Roughness": 0.0,
        "Specular IOR Level": 0.2,
    }
}
_RICH = {
    "ShaderNodeBsdfPrincipled": {
        "Metallic": 0.3,
        "Sheen": 0.6,
        "Sheen Weight": 0.6,
        "Clearcoat": 0.6,
        "Coat Weight": 0.6,
        "Coat Roughness": 0.3,
        "Clearcoat Roughness": 0.3,
        "Specular Tint": 0.4,
        "Emission Strength": 0.3,
        "Emission Color": (0.4, 0.2, 0.1, 1),
        "Emission": (0.4, 0.2, 0.1, 1),
        "Anisotropic": 0.0,
        "Base Color": (0.7, 0.5, 0.3, 1),
    }
}


def node_names():
    """bl_idnames of all shader nodes of this Blender."""
    return sorted(
        name for name in dir(bpy.types) if name.startswith("ShaderNode") and name not in _LEFT_OUT
    )


def _is_closure(node):
    return any(socket.type == "SHADER" for socket in node.outputs)


def _build(name, constants=None, mode=None):
    """`constants`: {socket: value}; `mode`: (property, item) that the node is set to."""

    def build(scene):
        stage.set_world(scene)
        stage.top_camera(scene)
        made, nodes, links, output = scene_parts.node_material()
        thing = stage.surface(scene, material=made)
        thing.color = (0.3, 0.6, 0.9, 0.7)
        thing.pass_index, made.pass_index = 2, 3
        try:
            node = nodes.new(name)
        except RuntimeError:
            return {}
        if hasattr(node, "image"):
            node.image = picture()
        if mode:
            setattr(node, *mode)
        _fill_vectors(node)
        for identifier, value in (constants or {}).items():
            socket = next((s for s in node.inputs if s.identifier == identifier), None)
            if socket is not None and not (
                hasattr(socket.default_value, "__len__") and isinstance(value, float)
            ):
                socket.default_value = value
        if _is_closure(node):
            stage.add_sun(scene)
            if (
                name != "ShaderNodeHoldout"
                and node.inputs
                and node.inputs[0].type == "SHADER"
                or _takes_shaders(node)
            ):
                _feed_shaders(nodes, links, node)
            links.new(next(s for s in node.outputs if s.type == "SHADER"), output.inputs["Surface"])
        else:
            emission = nodes.new("ShaderNodeEmission")
            total = _sum_of_outputs(nodes, links, node)
            if total is None:
                return {}
            links.new(total, emission.inputs["Color"])
            links.new(emission.outputs[0], output.inputs["Surface"])
        return {"node": node, "nodes": nodes, "links": links, "output": output, "scene": scene}

    return build


def _fill_vectors(node):
    """Vectors of no length are the same to most operations, and of no direction to the others."""
    for place, socket in enumerate(node.inputs):
        if socket.type == "VECTOR" and not socket.hide_value and not any(socket.default_value):
            value = (0.3 / (1 + place), 0.5, 0.2 + 0.3 * place)
            socket.default_value = value[: len(socket.default_value)]


def _takes_shaders(node):
    return any(socket.type == "SHADER" for socket in node.inputs)


def _feed_shaders(nodes, links, node):
    for place, socket in enumerate(s for s in node.inputs if s.type == "SHADER"):
        emission = nodes.new("ShaderNodeEmission")
        emission.inputs["Color"].default_value = ((0.7, 0.2, 0.1, 1), (0.1, 0.3, 0.6, 1))[place % 2]
        links.new(emission.outputs[0], socket)


def _sum_of_outputs(nodes, links, node):
    """A vector: the outputs, each with a weight, added up and kept small by a sine."""
    total = None
    for place, socket in enumerate(s for s in node.outputs if s.enabled):
        scale = nodes.new("ShaderNodeVectorMath")
        scale.operation = "MULTIPLY_ADD"
        links.new(socket, scale.inputs[0])
        scale.inputs[1].default_value = (_SHOWN, _SHOWN * (1 + place % 3), _SHOWN / (1 + place % 2))
        if total is None:
            scale.inputs[2].default_value = (0.5, 0.5, 0.5)
        else:
            links.new(total, scale.inputs[2])
        total = scale.outputs[0]
    return total


def picture(name="Picture", size=8):
    """An image of coloured texels, packed, so that it is read as a file is."""
    image = bpy.data.images.get(name)
    if image is None:
        image = bpy.data.images.new(name, size, size, alpha=True)
        pixels = np.random.default_rng(3).uniform(0.1, 0.9, (size, size, 4)).astype(np.float32)
        pixels[..., 3] = np.where(pixels[..., 3] < 0.4, 0.5, 1.0)
        image.pixels.foreach_set(pixels.ravel())
        image.pack()
    return image


@contextlib.contextmanager
def _alone(name):
    """A new node in a tree of its own; None where this Blender does not make it."""
    material = bpy.data.materials.new("Look")
    material.use_nodes = True
    try:
        node = material.node_tree.nodes.new(name)
    except RuntimeError:
        node = None
    yield node
    bpy.data.materials.remove(material)


def _outputs(name):
    """One deed an output: it alone is shown."""
    with _alone(name) as node:
        if node is None:
            return {}
        shown = [] if _is_closure(node) else node.outputs
        found = {f"output {s.identifier}": _show(place) for place, s in enumerate(shown)}
        found["is muted"] = _mute
        return found


def _show(place):
    def deed(roots):
        socket = roots["node"].outputs[place]
        if not socket.enabled:
            return False
        emission = roots["nodes"].new("ShaderNodeEmission")
        roots["links"].new(socket, emission.inputs["Color"])
        roots["links"].new(emission.outputs[0], roots["output"].inputs["Surface"])
        return True

    return deed


def _mute(roots):
    roots["node"].mute = True


def _modes(name):
    """{(property, item): places of inputs}: items of enums that enable inputs which neither a new node nor an
    earlier item has."""
    with _alone(name) as node:
        return {} if node is None else dict(_opening_modes(node))


def _opening_modes(node):
    seen = _open_inputs(node)
    for rna in node.bl_rna.properties:
        if rna.type != "ENUM" or rna.is_readonly or rna.is_enum_flag:
            continue
        if rna.identifier in unwalked.names("names"):
            continue
        before = getattr(node, rna.identifier)
        for item in rna.enum_items:
            try:
                setattr(node, rna.identifier, item.identifier)
            except TypeError:  # an item of other kinds of trees
                continue
            opened = _open_inputs(node) - seen
            if opened:
                yield (rna.identifier, item.identifier), opened
                seen |= opened
        setattr(node, rna.identifier, before)


def _open_inputs(node):
    return {place for place, socket in enumerate(node.inputs) if can_be_flipped(socket)}


def probes():
    """A probe for each node that this Blender has."""
    found = []
    left_out = unwalked.names("node probes")
    for name in node_names():
        found.append(Probe(name, _build(name), ("node",), _outputs(name), left_out, node=True))
        for label, known in (("rich", _RICH), ("clear", _CLEAR)):
            if name in known:
                build = _build(name, known[name])
                found.append(Probe(f"{name}, {label}", build, ("node",), {}, left_out, node=True))
        for mode, opened in _modes(name).items():
            label = f"{name}, {mode[1]}"
            found.append(
                Probe(
                    label, _build(name, mode=mode), ("node",), sockets=frozenset(opened), node=True
                )
            )
    return found
