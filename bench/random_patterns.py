# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns by chance: nodes that make values, colours and normals.  Runs inside Blender."""

import bpy

# Not White Noise, which the last bit of a place decides.
PATTERNS = (
    "ShaderNodeTexNoise",
    "ShaderNodeTexMusgrave",
    "ShaderNodeTexVoronoi",
    "ShaderNodeTexWave",
    "ShaderNodeTexChecker",
    "ShaderNodeTexBrick",
    "ShaderNodeTexMagic",
    "ShaderNodeTexGradient",
    "ShaderNodeTexImage",
)
PLACES = ("Generated", "Object", "UV", "Normal")
SEEN_PLACES = ("Reflection", "Camera", "Window")  # by who looks: not where things are displaced
FACTORS = (
    "ShaderNodeFresnel",
    "ShaderNodeLayerWeight",
    "ShaderNodeLightPath",
    "ShaderNodeNewGeometry",
    "ShaderNodeObjectInfo",
    "ShaderNodeHairInfo",
    "ShaderNodeWireframe",
)
# Of whose outputs no two engines agree, or that say nothing below 1.
UNUSED = (
    "Ray Length",
    "Random Per Island",
    "Pointiness",
    "Object Index",
    "Material Index",
    "Length",
)
# What makes other values of values, and colours of colours.
VALUE_NODES = ("ShaderNodeMath", "ShaderNodeMapRange", "ShaderNodeClamp", "ShaderNodeFloatCurve")
COLOR_NODES = (
    "ShaderNodeGamma",
    "ShaderNodeBrightContrast",
    "ShaderNodeHueSaturation",
    "ShaderNodeInvert",
    "ShaderNodeRGBCurve",
)
MATH = (
    "ADD",
    "MULTIPLY",
    "SUBTRACT",
    "POWER",
    "SINE",
    "SMOOTH_MIN",
    "PINGPONG",
    "FRACT",
    "ABSOLUTE",
)
BLENDS = ("MIX", "DARKEN", "MULTIPLY", "SCREEN", "OVERLAY", "DIFFERENCE", "SOFT_LIGHT", "COLOR")


def color(random, brightest=0.9):
    return (*random.uniform(0.02, brightest, 3), 1.0)


def image(random, smallest=0.0):
    """Squares in 64 x 64 texels."""
    made = bpy.data.images.new("Texels", 64, 64, alpha=False)
    coarse = random.uniform(smallest, 1, (8, 8, 3)).repeat(8, 0).repeat(8, 1)
    made.pixels[:] = [v for texel in coarse.reshape(-1, 3) for v in (*texel, 1.0)]
    made.pack()
    return made


def socket(sockets, name):
    """The one in use that has the name, in Blender 5 "Factor" for "Fac"; None: there is none."""
    names = (name, "Factor") if name == "Fac" else (name,)
    return next((s for s in sockets if s.name in names and s.enabled), None)


class Patterns:
    """Nodes of one tree, each chosen by `random` (a numpy generator), patterns by `places`."""

    def __init__(self, tree, random, places=PLACES + SEEN_PLACES):
        self.tree, self.random, self.places = tree, random, places

    def chance(self, of):
        return self.random.random() < of

    def pick(self, kinds):
        """One that this version of Blender has."""
        return self.random.choice([kind for kind in kinds if hasattr(bpy.types, kind)])

    def node(self, kind):
        return self.tree.nodes.new(kind)

    def link(self, output, node, name):
        """Where this version's node has such an input."""
        found = socket(node.inputs, name)
        if found is not None:
            self.tree.links.new(output, found)

    def set(self, node, **inputs):
        """Likewise; colours where older versions have numbers are left."""
        for name, value in inputs.items():
            found = socket(node.inputs, name.replace("_", " "))
            if hasattr(found, "default_value") and (found.type == "VALUE") == isinstance(
                value, float
            ):
                found.default_value = value

    def choose_enums(self, node, *names):
        for name in names:
            found = node.bl_rna.properties.get(name)
            if found and found.type == "ENUM" and found.enum_items:
                setattr(
                    node, name, self.random.choice([item.identifier for item in found.enum_items])
                )

    def place(self):
        """Vectors on the surface: as they are, turned or bent."""
        made = self.node("ShaderNodeTexCoord").outputs[self.random.choice(self.places)]
        if self.chance(0.3):
            mapping = self.node("ShaderNodeMapping")
            self.choose_enums(mapping, "vector_type")
            mapping.inputs["Rotation"].default_value = self.random.uniform(-1, 1, 3)
            mapping.inputs["Scale"].default_value = self.random.uniform(0.5, 3, 3)
            self.link(made, mapping, "Vector")
            made = mapping.outputs[0]
        if self.chance(0.1):
            turn = self.node("ShaderNodeVectorRotate")
            self.set(turn, Angle=float(self.random.uniform(-2, 2)), Axis=(0.5, 0.5, 0.7))
            self.link(made, turn, "Vector")
            made = turn.outputs[0]
        return made

    def pattern(self):
        """The node of a texture somewhere on the surface."""
        node = self.node(self.pick(PATTERNS))
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
            "noise_type",
            "musgrave_type",
        )
        scale = float(self.random.uniform(1, 8))
        self.set(node, Scale=scale, Detail=float(self.random.uniform(0, 4)))
        self.set(node, Distortion=float(self.random.choice((0.0, 0.0, 1.5))))
        self.set(node, Color1=color(self.random), Color2=color(self.random))
        self.link(self.place(), node, "Vector")
        return node

    @staticmethod
    def output(node, name):
        """That one, or whichever is in use."""
        found = socket(node.outputs, name)
        return found if found is not None else next(o for o in node.outputs if o.enabled)

    def attribute(self):
        """The node of what meshes carry: colours that random_things.py gives them."""
        node = self.node("ShaderNodeAttribute")
        node.attribute_name = "Tint"
        return node

    def factor(self):
        node = self.node(self.pick(FACTORS))
        outputs = [o for o in node.outputs if o.type == "VALUE" and "Depth" not in o.name]
        outputs = [o for o in outputs if o.name not in UNUSED and o.enabled]
        return outputs[self.random.integers(len(outputs))]

    def changed_value(self, value):
        node = self.node(self.random.choice(VALUE_NODES))
        if node.bl_idname == "ShaderNodeMath":
            node.operation, node.use_clamp = self.random.choice(MATH), True
            for other in node.inputs[1:]:
                other.default_value = float(self.random.uniform(0.2, 2))
        if node.bl_idname == "ShaderNodeMapRange":
            self.choose_enums(node, "interpolation_type")
        self.link(value, node, "Value")
        return node.outputs[0]

    def value(self):
        """An output between 0 and 1 or so."""
        if self.chance(0.25):
            return self.factor()
        ramp = self.node("ShaderNodeValToRGB")
        ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = sorted(
            self.random.uniform(0, 1, 2)
        )
        self.choose_enums(ramp.color_ramp, "interpolation")
        self.link(self.output(self.pattern(), "Fac"), ramp, "Fac")
        made = ramp.outputs["Color"]
        return self.changed_value(made) if self.chance(0.2) else made

    def changed_colors(self, colors):
        node = self.node(self.random.choice(COLOR_NODES))
        self.set(node, Gamma=1.6, Bright=0.1, Contrast=0.3, Hue=float(self.random.uniform(0, 1)))
        self.link(colors, node, "Color")
        return node.outputs[0]

    def blended(self, one, other, how, factor):
        """Of outputs or colours."""
        node = self.node("ShaderNodeMixRGB")
        node.blend_type, node.use_clamp = how, True
        for name, what in (("Fac", factor), ("Color1", one), ("Color2", other)):
            if isinstance(what, bpy.types.NodeSocket):
                self.link(what, node, name)
            else:
                self.set(node, **{name: what})
        return node.outputs[0]

    def colors(self):
        """An output of colours that reflect at most nine tenths."""
        if self.chance(0.15):
            made = self.output(self.attribute(), "Color")
        elif self.chance(0.5):
            made = self.output(self.pattern(), "Color")
        else:
            ramp = self.node("ShaderNodeValToRGB")
            for element in ramp.color_ramp.elements:
                element.color = color(self.random)
            self.link(self.value(), ramp, "Fac")
            made = ramp.outputs["Color"]
        if self.chance(0.2):
            made = self.changed_colors(made)
        if self.chance(0.15):
            how = self.random.choice(BLENDS)
            made = self.blended(made, color(self.random), how, self.value())
        return self.blended(made, color(self.random), "MULTIPLY", 1.0)

    def normals(self):
        if self.chance(0.3):
            node = self.node("ShaderNodeNormalMap")
            texels = self.node("ShaderNodeTexImage")
            texels.image = image(self.random, 0.4)
            texels.image.colorspace_settings.name = "Non-Color"
            self.set(node, Strength=float(self.random.uniform(0.2, 0.8)))
            self.link(texels.outputs[0], node, "Color")
            return node.outputs[0]
        node = self.node("ShaderNodeBump")
        self.set(node, Strength=float(self.random.uniform(0.1, 0.6)), Distance=0.05)
        self.link(self.value(), node, "Height")
        return node.outputs["Normal"]
