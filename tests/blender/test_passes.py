# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes in Blender's own render result, beside those of Cycles with all bounces at 0.

The stage of a ball over a floor, 64 by 48 pixels, through multilayer OpenEXR.  Filtered passes are
compared over 4 by 4 pixels; passes of one sample, and those with jumps, in all but few pixels.
"""

import math
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import scene_parts

LONG = bpy.app.version >= (5, 0, 0)
NAMES = {  # the view layer's property: (name before Blender 5, since, channels)
    "use_pass_z": ("Depth", "Depth", "Z"),
    "use_pass_mist": ("Mist", "Mist", "Z"),
    "use_pass_position": ("Position", "Position", "XYZ"),
    "use_pass_normal": ("Normal", "Normal", "XYZ"),
    "use_pass_uv": ("UV", "UV", "UVA"),
    "use_pass_object_index": ("IndexOB", "Object Index", "X"),
    "use_pass_material_index": ("IndexMA", "Material Index", "X"),
    "use_pass_diffuse_direct": ("DiffDir", "Diffuse Direct", "RGB"),
    "use_pass_diffuse_color": ("DiffCol", "Diffuse Color", "RGB"),
    "use_pass_glossy_direct": ("GlossDir", "Glossy Direct", "RGB"),
    "use_pass_glossy_color": ("GlossCol", "Glossy Color", "RGB"),
    "use_pass_emit": ("Emit", "Emission", "RGB"),
    "use_pass_environment": ("Env", "Environment", "RGB"),
}


def set_stage(scene):
    camera = scene_parts.add_camera(scene, (0.0, -6.0, 4.0))
    camera.rotation_euler = (math.radians(60.0), 0.0, 0.0)
    camera.data.lens = 35.0
    matte = scene_parts.closure("Matte", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.6, 0.4, 1.0))
    gloss = scene_parts.closure(
        "Gloss", "ShaderNodeBsdfGlossy", Color=(0.5, 0.7, 0.9, 1.0), Roughness=0.5
    )
    glow = scene_parts.emission("Glow", (0.25, 0.5, 0.75))
    matte.pass_index, gloss.pass_index, glow.pass_index = 3, 5, 8
    floor = scene_parts.add_square(scene, "Floor", 12.0, (0.0, 0.0, 0.0), matte)
    floor.pass_index = 1
    bpy.ops.mesh.primitive_uv_sphere_add(
        segments=64, ring_count=32, radius=1.0, location=(0, 0, 1.2)
    )
    ball = bpy.context.object
    ball.data.materials.append(gloss)
    for polygon in ball.data.polygons:
        polygon.use_smooth = True
    ball.pass_index = 2
    lamp = scene_parts.add_square(scene, "Lamp", 1.0, (-2.5, 0.0, 0.5), glow)
    lamp.rotation_euler = (1.0, 0.0, 0.0)
    lamp.pass_index = 300
    for thing in (floor, ball, lamp):
        if not thing.data.uv_layers:
            thing.data.uv_layers.new(name="UVMap")
    world = bpy.data.worlds.new("World")
    if world.node_tree is None:
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.2, 0.3, 1.0)
    world.mist_settings.start, world.mist_settings.depth = 4.0, 9.0
    scene.world = world
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy = 2.0
    scene_parts.add_object(scene, "Sun", sun, (2.0, -2.0, 4.0)).rotation_euler = (0.5, 0.4, 0.0)
    return matte, gloss, glow


def ask_for_all(view_layer):
    for prop in NAMES:
        setattr(view_layer, prop, True)


def arrays(channels, prop):
    """A pass of a file, [height, width, channels]."""
    short, long, ids = NAMES[prop]
    found = [
        values
        for c in ids
        for name, values in channels.items()
        if name.endswith(f".{long if LONG else short}.{c}")
    ]
    assert len(found) == len(ids), (prop, sorted(channels))
    return np.stack(found, axis=-1).astype(np.float64)


@pytest.fixture
def pair(scene, render):
    """(Granita's, Cycles') channels of one file each."""
    materials = set_stage(scene)
    layer = scene.view_layers[0]
    ask_for_all(layer)
    for name, kind in (("Tint", "COLOR"), ("Mask", "VALUE")):
        aov = layer.aovs.add()
        aov.name, aov.type = name, kind
    scene_parts.add_aov_output(materials[1], "Tint", (0.25, 0.5, 2.0), 0.0)
    scene_parts.add_aov_output(materials[0], "Mask", (0.0, 0.0, 0.0), 3.0)
    return scene_parts.direct_light_of_both(scene, render, 100)


def rms(values):
    return np.sqrt(np.mean(values**2))


def blocks(picture):
    return picture.reshape(12, 4, 16, 4, -1).mean(axis=(1, 3))


def compared(channels, prop):
    """The pass; of the glossy ball its light: where few samples touch it, light by colour is a ratio
    of few samples."""
    values = arrays(channels, prop)
    if prop == "use_pass_glossy_direct":
        values *= arrays(channels, "use_pass_glossy_color")
    return values


# RMS over blocks, relative to the RMS of Cycles': noise of 100 samples a pixel, and of
# edges that 16 samples see in Granita.
FILTERED = {
    "use_pass_mist": 0.01,
    "use_pass_normal": 0.03,
    "use_pass_uv": 0.04,
    "use_pass_diffuse_direct": 0.04,
    "use_pass_diffuse_color": 0.02,
    "use_pass_glossy_direct": 0.05,
    "use_pass_glossy_color": 0.04,
    "use_pass_emit": 0.04,
    "use_pass_environment": 0.02,
}


def test_passes_agree_with_cycles(pair):
    report = {}
    for prop, tolerance in FILTERED.items():
        ours, theirs = (blocks(compared(channels, prop)) for channels in pair)
        assert np.abs(theirs).mean() > 1e-3, prop
        report[prop] = rms(ours - theirs) / rms(theirs), tolerance
    wrong = {prop: pair for prop, pair in report.items() if pair[0] > pair[1]}
    assert not wrong, wrong
    for name in ("Tint.R", "Tint.G", "Tint.B", "Tint.A", "Mask.X"):
        ours, theirs = (
            blocks(next(v for k, v in channels.items() if k.endswith("." + name))[..., None])
            for channels in pair
        )
        assert theirs.max() > 0.2, name
        error = rms(ours - theirs) / rms(theirs)
        assert error < 0.04, (name, error)


@pytest.mark.parametrize(
    "prop", ["use_pass_z", "use_pass_position", "use_pass_object_index", "use_pass_material_index"]
)
def test_passes_of_one_sample_agree_with_cycles(pair, prop):
    """Both take one sample a pixel, not the same: away from edges they differ by what half a pixel
    does, .1 of 10 metres on this floor, on edges by anything."""
    ours, theirs = (arrays(channels, prop) for channels in pair)
    tolerance = 1e-6 if "index" in prop else 0.6
    wrong = (np.abs(ours - theirs) > tolerance).any(axis=-1)
    assert wrong.mean() < 0.06
    assert len(np.unique(theirs)) > 3


@pytest.mark.parametrize("prop", sorted(NAMES))
def test_a_pass_that_is_asked_for_alone(scene, render, prop):
    """The same numbers as among all."""
    set_stage(scene)
    layer = scene.view_layers[0]
    for other in NAMES:
        setattr(layer, other, other == prop)
    alone = arrays(render(scene), prop)
    ask_for_all(layer)
    np.testing.assert_array_equal(alone, arrays(render(scene), prop))


def test_uv_is_marked_where_there_is_a_map(scene, render):
    set_stage(scene)
    lamp = bpy.data.objects["Lamp"].data
    lamp.uv_layers.remove(lamp.uv_layers[0])
    ask_for_all(scene.view_layers[0])
    ours, theirs = (
        blocks(arrays(channels, "use_pass_uv"))
        for channels in scene_parts.direct_light_of_both(scene, render, 100)
    )
    assert 0.1 < theirs[..., 2].mean() < 0.9
    # As in FILTERED.
    assert rms(ours - theirs) < 0.04 * rms(theirs)


def test_a_mist_without_depth_covers_nothing_that_is_seen(scene, render):
    set_stage(scene)
    scene.world.mist_settings.depth = 0.0
    ask_for_all(scene.view_layers[0])
    ours, theirs = (
        blocks(arrays(channels, "use_pass_mist"))
        for channels in scene_parts.direct_light_of_both(scene, render, 100)
    )
    assert theirs.max() > 0.9
    assert rms(ours - theirs) < 0.02 * rms(theirs)


def test_light_by_colour_is_the_picture(scene, render):
    set_stage(scene)
    ask_for_all(scene.view_layers[0])
    channels = render(scene)
    light = sum(
        arrays(channels, f"use_pass_{lobe}_direct") * arrays(channels, f"use_pass_{lobe}_color")
        for lobe in ("diffuse", "glossy")
    )
    light += arrays(channels, "use_pass_emit") + arrays(channels, "use_pass_environment")
    combined = np.stack(
        [v for c in "RGB" for k, v in channels.items() if k.endswith(f".Combined.{c}")], axis=-1
    )
    assert np.abs(light - combined).max() < 1e-5 * combined.max()


def test_a_failure_to_list_passes_is_told(scene, monkeypatch):
    """Blender lists them at each change of a view layer and would print the traceback alone."""
    from granita import engine, passes

    def broken(_):
        raise ValueError("\x1b[31m")

    monkeypatch.setattr(passes, "wanted", broken)
    told = []
    listing = SimpleNamespace(report=lambda kind, text: told.append((kind, text)))
    engine.GranitaRenderEngine.update_render_passes(listing, scene, scene.view_layers[0])
    assert told == [({"ERROR"}, r"passes: ValueError: \x1b[31m")]


def test_each_layer_has_its_own_passes(scene, render):
    set_stage(scene)
    scene.view_layers[0].use_pass_normal = True
    other = scene.view_layers.new("Other")
    other.use_pass_emit = True
    names = render(scene).keys()
    assert any(n.startswith("ViewLayer.Normal.") for n in names)
    assert not any(n.startswith("Other.Normal.") for n in names)
    emit = NAMES["use_pass_emit"][LONG]
    assert any(n.startswith(f"Other.{emit}.") for n in names)
