# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials by chance: patterns, closures and how they are put together.  Runs inside Blender."""

import bpy

# Not White Noise, which the last bit of a place decides.
PATTERNS = (
    "ShaderNodeTexNoise",
    "ShaderNodeTexVoronoi",
    "ShaderNodeTexWave",
    "ShaderNodeTexChecker",
    "ShaderNodeTexBrick",
    "ShaderNodeTexMagic",
    "ShaderNodeTexGradient",
    "ShaderNodeTexImage",
)
PLACES = ("Generated", "Object", "UV", "Normal")
FACTORS = (
    "ShaderNodeFresnel",
    "ShaderNodeLayerWeight",
    "ShaderNodeLightPath",
    "ShaderNodeNewGeometry",
)
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
    "ShaderNodeEmission": 1,
}


def color(random, brightest=0.9):
    return (*random.uniform(0.02, brightest, 3), 1.0)


def image(random):
    """Smooth noise in 64 x 64 texels."""
    made = bpy.data.images.new("Texels", 64, 64, alpha=False)
    coarse = random.uniform(0, 1, (8, 8, 3)).repeat(8, 0).repeat(8, 1)
    made.pixels[:] = [v for texel in coarse.reshape(-1, 3) for v in (*texel, 1.0)]
    made.pack()
    return made


def socket(sockets, name):
    """The one in use that has the name, in Blender 5 "Factor" for "Fac"; None: there is none."""
    names = (name, "Factor") if name == "Fac" else (name,)
    return next((s for s in sockets if s.name in names and s.enabled), None)


class Graph:
    """Nodes of one material, each chosen by `random` (a numpy generator)."""

    def __init__(self, tree, random):
        self.tree, self.random = tree, random
        tree.nodes.clear()

    def chance(self, of):
        return self.random.random() < of

    def node(self, kind):
        return self.tree.nodes.new(kind)

    def link(self, output, node, name):
        """Where this version's node has such an input."""
        found = socket(node.inputs, name)
        if found is not None:
            self.tree.links.new(output, found)

    def set(self, node, **inputs):
        """Likewise."""
        for name, value in inputs.items():
            found = socket(node.inputs, name.replace("_", " "))
            if hasattr(found, "default_value"):
                found.default_value = value

    def choose_enums(self, node, *names):
        for name in names:
            found = node.bl_rna.properties.get(name)
            if found and found.type == "ENUM" and found.enum_items:
                setattr(
                    node, name, self.random.choice([item.identifier for item in found.enum_items])
                )

    def pattern(self):
        """The node of a texture somewhere on the surface."""
        node = self.node(self.random.choice(PATTERNS))
        if node.bl_idname == "ShaderNodeTexImage":
            node.image = image(self.random)
            self.choose_enums(node, "interpolation", "extension")
        self.choose_enums(
            node,
            "wave_type",
            "wave_profile",
            "gradient_type",
            "feature",
            "distance",
            "noise_dimensions",
        )
        scale = float(self.random.uniform(1, 8))
        self.set(node, Scale=scale, Detail=float(self.random.uniform(0, 4)))
        self.set(node, Color1=color(self.random), Color2=color(self.random))
        place = self.node("ShaderNodeTexCoord").outputs[self.random.choice(PLACES)]
        if self.chance(0.3):
            mapping = self.node("ShaderNodeMapping")
            mapping.inputs["Rotation"].default_value = self.random.uniform(-1, 1, 3)
            mapping.inputs["Scale"].default_value = self.random.uniform(0.5, 3, 3)
            self.link(place, mapping, "Vector")
            place = mapping.outputs[0]
        self.link(place, node, "Vector")
        return node

    @staticmethod
    def output(node, name):
        """That one, or whichever is in use."""
        found = socket(node.outputs, name)
        return found if found is not None else next(o for o in node.outputs if o.enabled)

    def value(self):
        """An output between 0 and 1 or so."""
        if self.chance(0.25):
            node = self.node(self.random.choice(FACTORS))
            outputs = [o for o in node.outputs if o.type == "VALUE" and "Depth" not in o.name]
            outputs = [o for o in outputs if o.name not in ("Ray Length", "Random Per Island")]
            return outputs[self.random.integers(len(outputs))]
        ramp = self.node("ShaderNodeValToRGB")
        ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = sorted(
            self.random.uniform(0, 1, 2)
        )
        self.choose_enums(ramp.color_ramp, "interpolation")
        pattern = self.pattern()
        self.link(self.output(pattern, "Fac"), ramp, "Fac")
        return ramp.outputs["Color"]

    def colors(self):
        """An output of colours that reflect at most nine tenths."""
        if self.chance(0.5):
            made = self.output(self.pattern(), "Color")
        else:
            ramp = self.node("ShaderNodeValToRGB")
            for element in ramp.color_ramp.elements:
                element.color = color(self.random)
            self.link(self.value(), ramp, "Fac")
            made = ramp.outputs["Color"]
        dim = self.node("ShaderNodeMixRGB")
        dim.blend_type = "MULTIPLY"
        self.set(dim, Fac=1.0, Color2=color(self.random))
        self.link(made, dim, "Color1")
        return dim.outputs["Color"]

    def bump(self):
        node = self.node("ShaderNodeBump")
        self.set(node, Strength=float(self.random.uniform(0.1, 0.6)), Distance=0.05)
        self.link(self.value(), node, "Height")
        return node.outputs["Normal"]

    def closure(self):
        kinds = [kind for kind in CLOSURES if hasattr(bpy.types, kind)]
        weights = [CLOSURES[kind] for kind in kinds]
        node = self.node(self.random.choice(kinds, p=[w / sum(weights) for w in weights]))
        base = "Base Color" if "Base Color" in node.inputs else "Color"
        self.set(node, **{base: color(self.random)})
        self.set(node, Strength=float(self.random.uniform(0.2, 3)))
        self.set(
            node,
            IOR=float(self.random.uniform(1.1, 1.8)),
            Roughness=float(self.random.uniform(0.05, 0.9)),
        )
        self.set(node, Scale=float(self.random.uniform(0.02, 0.3)))
        if self.chance(0.5):
            self.link(self.colors(), node, base)
        if self.chance(0.3):
            self.link(self.value(), node, "Roughness")
        if self.chance(0.25):
            self.link(self.bump(), node, "Normal")
        if node.bl_idname == "ShaderNodeBsdfPrincipled":
            self.principled(node)
        return node.outputs[0]

    def principled(self, node):
        """A few of its layers, by the names of every version."""
        layers = (
            {"Metallic": 1.0},
            {"Transmission": 1.0, "Transmission Weight": 1.0},
            {"Coat Weight": 1.0, "Clearcoat": 1.0},
            {"Sheen": 0.5, "Sheen Weight": 0.5},
            {"Subsurface": 0.3, "Subsurface Weight": 0.5, "Subsurface Scale": 0.1},
            {"Alpha": 0.5},
            {"Anisotropic": 0.7},
            {
                "Emission Strength": 0.5,
                "Emission": color(self.random),
                "Emission Color": color(self.random),
            },
            {"Specular": 0.9, "Specular IOR Level": 0.9},
        )
        for layer in layers:
            if self.chance(0.15):
                self.set(node, **layer)

    def surface(self):
        made = self.closure()
        if self.chance(0.3):
            mix = self.node(
                self.random.choice(
                    ("ShaderNodeMixShader", "ShaderNodeMixShader", "ShaderNodeAddShader")
                )
            )
            if mix.bl_idname == "ShaderNodeMixShader":
                self.tree.links.new(self.value(), mix.inputs[0])
            self.tree.links.new(made, mix.inputs[-2])
            self.tree.links.new(self.closure(), mix.inputs[-1])
            made = mix.outputs[0]
        return made


def material(name, random, displaces=False):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    graph = Graph(made.node_tree, random)
    output = graph.node("ShaderNodeOutputMaterial")
    graph.link(graph.surface(), output, "Surface")
    if displaces:
        node = graph.node("ShaderNodeDisplacement")
        graph.set(node, Scale=0.1)
        graph.link(graph.value(), node, "Height")
        graph.link(node.outputs[0], output, "Displacement")
        owner = made if hasattr(made, "displacement_method") else made.cycles
        owner.displacement_method = "BOTH"
    return made
