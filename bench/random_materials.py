# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials by chance: closures, how they are put together, and volumes.  Runs inside Blender."""

import bpy
from random_patterns import PLACES, Patterns, color

CLOSURES = {
    "ShaderNodeBsdfPrincipled": 10,
    "ShaderNodeBsdfDiffuse": 3,
    "ShaderNodeBsdfGlossy": 2,  # in Blender 4 the next one is it
    "ShaderNodeBsdfAnisotropic": 2,
    "ShaderNodeBsdfGlass": 1,
    "ShaderNodeBsdfRefraction": 1,
    "ShaderNodeBsdfTranslucent": 1,
    "ShaderNodeBsdfTransparent": 1,
    "ShaderNodeSubsurfaceScattering": 1,
    "ShaderNodeBsdfToon": 1,
    "ShaderNodeBsdfVelvet": 1,
    "ShaderNodeBsdfSheen": 1,
    "ShaderNodeBsdfMetallic": 1,
    "ShaderNodeEmission": 1,
    "ShaderNodeHoldout": 0.3,
}
# Of Principled, by the names of every version.
LAYERS = (
    ("Metallic",),
    ("Transmission", "Transmission Weight"),
    ("Coat Weight", "Clearcoat"),
    ("Sheen", "Sheen Weight"),
    ("Subsurface", "Subsurface Weight"),
    ("Anisotropic",),
    ("Specular", "Specular IOR Level"),
    ("Specular Tint",),
    ("Diffuse Roughness",),
)


class Graph(Patterns):
    """Nodes of one material."""

    def closure(self):
        kinds = [kind for kind in CLOSURES if hasattr(bpy.types, kind)]
        weights = [CLOSURES[kind] for kind in kinds]
        total = sum(weights)
        node = self.node(self.random.choice(kinds, p=[w / total for w in weights]))
        base = "Base Color" if "Base Color" in node.inputs else "Color"
        self.set(node, **{base: color(self.random)})
        self.set(node, Strength=float(self.random.uniform(0.2, 3)))
        self.set(
            node,
            IOR=float(self.random.uniform(1.1, 1.8)),
            Roughness=float(self.random.uniform(0.05, 0.9)),
            Scale=float(self.random.uniform(0.02, 0.3)),
        )
        if self.chance(0.5):
            self.link(self.colors(), node, base)
        if self.chance(0.3):
            self.link(self.value(), node, "Roughness")
        if self.chance(0.25):
            self.link(self.normals(), node, "Normal")
        if self.chance(0.2):
            tangent = self.node("ShaderNodeTangent")
            tangent.direction_type = "RADIAL"
            self.link(tangent.outputs[0], node, "Tangent")
        if node.bl_idname == "ShaderNodeBsdfPrincipled":
            self.principled(node)
        return node.outputs[0]

    def principled(self, node):
        """A few of its layers, whole, in part or by a pattern."""
        for names in LAYERS:
            if not self.chance(0.15):
                continue
            weight = 1.0 if self.chance(0.5) else float(self.random.uniform(0.1, 0.9))
            for name in names:
                found = node.inputs.get(name)
                if found is not None and found.type == "RGBA":
                    found.default_value = color(self.random)
                elif found is not None:
                    found.default_value = weight
            if self.chance(0.2):
                value = self.value()
                for name in names:
                    self.link(value, node, name)
        self.set(node, Subsurface_Scale=0.1, Sheen_Tint=color(self.random))
        self.set(node, Coat_Tint=color(self.random), Coat_Roughness=0.2, Clearcoat_Roughness=0.2)
        if self.chance(0.1):
            self.set(node, Thin_Film_Thickness=float(self.random.uniform(100, 900)))
        if self.chance(0.15):
            self.set(node, Alpha=0.5)
            if self.chance(0.5):
                self.link(self.value(), node, "Alpha")
        if self.chance(0.12):
            self.set(node, Emission_Strength=0.5, Emission=color(self.random))
            self.set(node, Emission_Color=color(self.random))
            if self.chance(0.4):
                glow = self.colors()
                self.link(glow, node, "Emission")
                self.link(glow, node, "Emission Color")

    def surface(self):
        made = self.closure()
        if self.chance(0.3):
            kinds = ("ShaderNodeMixShader", "ShaderNodeMixShader", "ShaderNodeAddShader")
            mix = self.node(self.random.choice(kinds))
            if mix.bl_idname == "ShaderNodeMixShader":
                self.tree.links.new(self.value(), mix.inputs[0])
            self.tree.links.new(made, mix.inputs[-2])
            self.tree.links.new(self.closure(), mix.inputs[-1])
            made = mix.outputs[0]
        return made

    def volume(self):
        kinds = (
            "ShaderNodeVolumePrincipled",
            "ShaderNodeVolumeScatter",
            "ShaderNodeVolumeAbsorption",
        )
        node = self.node(self.random.choice(kinds))
        self.set(
            node,
            Color=color(self.random),
            Density=float(self.random.uniform(0.1, 2)),
            Anisotropy=float(self.random.uniform(-0.5, 0.7)),
        )
        if self.chance(0.4):
            self.link(self.value(), node, "Density")
        return node.outputs[0]


def material(name, random, displaces=False, filled=False):
    """Of a surface; `filled` has a volume, with a surface around it or none."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.node_tree.nodes.clear()
    graph = Graph(made.node_tree, random)
    output = graph.node("ShaderNodeOutputMaterial")
    if filled:
        graph.link(graph.volume(), output, "Volume")
    if not filled or graph.chance(0.3):
        graph.link(graph.surface(), output, "Surface")
    if displaces:
        node = graph.node("ShaderNodeDisplacement")
        graph.set(node, Scale=0.1)
        graph.link(Patterns(made.node_tree, random, PLACES).value(), node, "Height")
        graph.link(node.outputs[0], output, "Displacement")
        owner = made if hasattr(made, "displacement_method") else made.cycles
        owner.displacement_method = "BOTH"
    return made
