# SPDX-License-Identifier: GPL-3.0-or-later
"""A node's output as emission on a plane, rendered by Cycles and by Granita.

The plane is a board of separate squares, each covering 2 by 2 pixels and carrying constants of its own
in the attributes A, B and C: within a square nothing varies, so both renderers must agree on every
pixel without noise, steps and jumps included.
"""

import bpy
import numpy as np
import scene_parts

SQUARES = 16
PIXELS = 2 * SQUARES


def board(scene, low=-1.5, high=1.5, seed=7, tilt=0.0, both_sides=False):
    """Adds board and camera; attributes A, B, C uniform in [low, high], UV map over the whole.

    With `tilt` each square leans its own way (slopes up to `tilt`) and still covers its pixels; with
    `both_sides` every other one shows its back.
    """
    n = SQUARES
    i, j = np.meshgrid(np.arange(n), np.arange(n))
    lower_left = np.stack([i.ravel(), j.ravel()], axis=1)
    corners = lower_left[:, None] + np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    uv = corners.reshape(-1, 2) / n
    vertices = np.concatenate([uv * 2 - 1, np.zeros((len(uv), 1))], axis=1)
    faces = np.arange(4 * n * n).reshape(-1, 4)
    random = np.random.default_rng(seed)
    slopes = np.repeat(random.uniform(-tilt, tilt, (n * n, 2)), 4, axis=0)
    vertices[:, 2] = np.sum(slopes * (vertices[:, :2] - np.repeat(vertices[::4, :2], 4, axis=0)), 1)
    if both_sides:
        faces[::2] = faces[::2, ::-1]
        uv.reshape(-1, 4, 2)[::2] = uv.reshape(-1, 4, 2)[::2, ::-1]
    thing = scene_parts.add_mesh(scene, "Board", vertices.tolist(), faces.tolist())
    mesh = thing.data
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", uv.astype(np.float32).ravel())
    for name in "ABC":
        values = np.repeat(random.uniform(low, high, (n * n, 3)), 4, axis=0)
        attribute = mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
        attribute.data.foreach_set("vector", values.astype(np.float32).ravel())
    scene_parts.add_camera(scene, ortho_scale=2.0)
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    return thing


class Tree:
    """A material of nodes on an object; `add` and `link` by names."""

    def __init__(self, thing, name="Material"):
        self.material, self.nodes, self.links, self.output = scene_parts.node_material(name)
        thing.data.materials.append(self.material)

    def add(self, kind, **properties):
        node = self.nodes.new(kind)
        for name, value in properties.items():
            setattr(node, name, value)
        return node

    def attribute(self, name, output="Vector"):
        return socket(self.add("ShaderNodeAttribute", attribute_name=name).outputs, output)

    def link(self, source, target):
        self.links.new(source, target)

    def emit(self, source, strength=1.0):
        """Shows an output."""
        emission = self.add("ShaderNodeEmission")
        emission.inputs["Strength"].default_value = strength
        self.link(source, emission.inputs["Color"])
        self.link(emission.outputs[0], self.output.inputs["Surface"])


def socket(sockets, identifier):
    """By identifier: names repeat."""
    return next(s for s in sockets if s.identifier == identifier)


def render_both(scene, render, samples=1, channels="RGB"):
    """(Cycles, Granita): float32 [h, w, channels]."""
    scene.view_settings.view_transform = "Raw"
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples = samples
    cycles.use_denoising = False
    cycles.use_adaptive_sampling = False
    cycles.pixel_filter_type = "BOX"
    cycles.max_bounces = 0
    theirs = combined(render(scene, "cycles"), channels)
    scene.render.engine = "GRANITA"
    scene.granita.samples = samples
    scene.granita.dicing_rate = 0.5  # the node is compared, not the interpolation between vertices
    scene.granita.pixel_filter = "BOX"
    scene.granita.filter_width = 1.0
    ours = combined(render(scene, "granita"), channels)
    return theirs, ours


def combined(passes, channels="RGB"):
    """[height, width, channels] of the first layer."""
    layer = [name for name in passes if name.endswith("Combined.R")][0][:-1]
    return np.stack([passes[layer + c] for c in channels], axis=-1)


def rmse(a, b):
    return float(np.sqrt(np.mean(np.square(a - b))))


LIMIT = 0.002


def check(scene, render, samples=1, limit=LIMIT, relative=False):
    """Renders both and compares; a case that hardly varies shows nothing and fails.

    `relative`: the limit is of what varies, for lights so strong that numbers are not around 1.
    """
    theirs, ours = render_both(scene, render, samples)
    deviation, error = float(theirs.std()), rmse(theirs, ours)
    assert deviation >= 0.1, f"deviation {deviation:.4f}"
    most = limit * deviation if relative else limit
    assert error < most, f"error {error:.5f}, deviation {deviation:.4f}"


def enum_values(kind, name):
    properties = getattr(bpy.types, kind).bl_rna.properties
    return [item.identifier for item in properties[name].enum_items]
