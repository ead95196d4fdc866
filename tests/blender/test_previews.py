# SPDX-License-Identifier: GPL-3.0-or-later
"""Previews of datablocks in a window under Xvfb: Blender's own scenes of them, rendered by Granita."""

import window_host

pytestmark = window_host.needed

WATCH = """
import numpy as np
bpy.context.scene.render.engine = "GRANITA"
bpy.context.scene.view_settings.view_transform = "Standard"

def material(name, shader, **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new(shader), tree.nodes.new("ShaderNodeOutputMaterial")
    for socket, value in inputs.items():
        node.inputs[socket].default_value = value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made

def steps():
    glow = material("Glow", "ShaderNodeEmission", Color=(0.25, 0.5, 0.75, 1))
    matte = material("Matte", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.1, 0.1, 1))
    lamp = bpy.data.lights.new("Lamp", "POINT")
    world = bpy.data.worlds.new("Sky")
    for each in (glow, matte, lamp, world):
        each.asset_generate_preview()
        while bpy.app.is_job_running("RENDER_PREVIEW"):
            yield 0.02
        yield 0.1
        preview = each.preview
        pixels = np.array(preview.image_pixels_float, dtype=float)
        pixels = pixels.reshape(preview.image_size[1], preview.image_size[0], 4)
        height, width = pixels.shape[:2]
        middle = pixels[height // 2, width // 2]
        found[each.name] = [round(255 * v) for v in middle], [round(255 * v) for v in pixels[0, 0]]
    found["end"] = True
"""


def test_materials_lights_and_worlds_have_previews(tmp_path):
    found, said = window_host.watch(WATCH, tmp_path)
    assert found.get("end"), (found, said)
    middle, corner = found["Glow"]
    assert middle == [137, 188, 225, 255]  # sRGB of .25, .5, .75
    assert corner[3] == 0  # icons are cut out
    red, green, blue, _ = found["Matte"][0]
    assert red > 100 and red > 2 * green and abs(green - blue) < 20  # lit by lamps of its scene
    assert min(found["Lamp"][0][:3]) > 40
    assert max(found["Sky"][0][:3]) - min(found["Sky"][0][:3]) < 3 and found["Sky"][0][3] == 255
