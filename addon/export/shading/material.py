# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as node graphs (docs/scene_snapshot.md)."""

from .inlined_tree import inlined
from .nodes import FlatGraph, version


def export_materials(materials, report, aovs=()):
    """The snapshot's `materials` and the images they show.

    Args:
        materials: evaluated Materials, in the order of the snapshot.
        report: called with (datablock, message).
        aovs: names whose AOV Output nodes are wanted.

    Returns:
        (list of material records, list of image records).
    """
    images = {}
    records = [material_record(material, images, report, aovs) for material in materials]
    return records, list(images.values())


def displacement_method(material):
    """BUMP, DISPLACEMENT or BOTH: Cycles' own property until Blender 4.1, then the material's."""
    if hasattr(material, "displacement_method"):
        return material.displacement_method
    cycles = getattr(material, "cycles", None)
    return cycles.displacement_method if cycles is not None else "BUMP"


def material_record(material, images, report, aovs=()):
    """One entry of the snapshot's `materials`; `images` {name: record} grows."""
    record = {"name": material.name_full, "index": material.pass_index, "displacement": None}
    if not material.use_nodes or material.node_tree is None:
        color = tuple(material.diffuse_color)
        node = {
            "type": "ShaderNodeBsdfDiffuse",
            "name": "Viewport Display",
            "inputs": {"Color": color},
            "properties": {"version": version()},
        }
        return {**record, "nodes": [node], "surface": (0, "BSDF")}
    owner = f"material '{material.name_full}'"
    read = inlined(material)
    graph = FlatGraph(read.node_tree, owner, images, report)
    surface = graph.add_output("Surface")
    record["displacement"] = graph.add_output("Displacement")
    record["displacement_method"] = displacement_method(material)
    record["volume"] = graph.add_output("Volume")
    graph.add_aov_outputs(aovs)
    record["holdout"] = surface is not None and _cuts(graph.nodes, surface[0])
    if not record["holdout"] and any(node["type"] == _HOLDOUT for node in graph.nodes):
        report(owner, "Holdout is black where it is mixed with others than Transparent BSDF")
    if record["holdout"] and any(map(_tints, graph.nodes)):
        report(owner, "what its Transparent BSDF takes of light is held out as well")
    return {**record, "nodes": graph.nodes, "surface": surface}


_HOLDOUT = "ShaderNodeHoldout"
_MIXES = {"ShaderNodeMixShader", "ShaderNodeAddShader"}


def _tints(node):
    if node["type"] != "ShaderNodeBsdfTransparent":
        return False
    color = node["inputs"].get("Color", (1.0, 1.0, 1.0, 1.0))
    return color[0] == "LINK" or any(channel != 1.0 for channel in color[:3])


def _cuts(nodes, index):
    """Whether a shader is Holdout, mixed with nothing but what is transparent."""
    kinds, pending, seen = set(), [index], set()
    while pending:
        number = pending.pop()
        if number in seen:  # mixes of mixes of the same: ways double with each
            continue
        seen.add(number)
        node = nodes[number]
        if node["type"] not in _MIXES:
            kinds.add(node["type"])
            continue
        shaders = [node["inputs"].get(name) for name in ("Shader", "Shader_001")]
        linked = [shader[1] for shader in shaders if shader is not None and shader[0] == "LINK"]
        # An empty socket adds nothing, but takes its part of a mix.
        if len(linked) < 2 and node["type"] == "ShaderNodeMixShader":
            return False
        pending += linked
    return _HOLDOUT in kinds and kinds <= {_HOLDOUT, "ShaderNodeBsdfTransparent"}
