# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view layer says for itself beside its passes: filters, overrides, samples; and the film's exposure.
Cycles renders the same scenes in the same Blender."""

import bpy
import numpy as np
import pytest
import scene_parts as parts

COMBINED = [f"ViewLayer.Combined.{channel}" for channel in "RGBA"]


def world(name, color):
    made = bpy.data.worlds.new(name)
    made.color = color
    if made.node_tree is not None:  # always, in Blender 5
        made.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)
    return made


@pytest.fixture
def glowing(scene):
    """A glowing square of 2 by 2 m that moves 1 m a frame, on 4 by 3 m of nothing."""
    scene.render.film_transparent = True
    parts.add_camera(scene, ortho_scale=4.0)
    square = parts.add_square(scene, material=parts.emission("Glow", (0.25, 0.5, 0.75)))
    for frame, x in ((0, -1.0), (2, 1.0)):
        square.location.x = x
        square.keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    return scene


def both(scene, render, samples=16):
    """float32 [2, height, width, 4]: Granita's picture, Cycles'."""
    pair = parts.direct_light_of_both(scene, render, samples)
    return np.array([[channels[name] for name in COMBINED] for channels in pair])


def test_motion_blur_can_be_off_in_a_layer(glowing, render):
    glowing.render.use_motion_blur = True
    glowing.render.motion_blur_shutter = 1.0
    glowing.view_layers[0].use_motion_blur = False
    ours, theirs = both(glowing, render)
    # Sharp edges on pixels' borders: the same bits but for the rounding of the colour.
    assert np.abs(ours - theirs).max() < 1e-6
    glowing.view_layers[0].use_motion_blur = True
    blurred, _ = both(glowing, render)
    assert np.abs(blurred - ours).max() > 0.2


def add_hair(square):
    """A fan of particle hair in the square's own plane."""
    square.rotation_euler.x = 1.5707963
    settings = square.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count, settings.hair_length = "HAIR", 40, 1.0
    settings.radius_scale = 0.1


@pytest.mark.parametrize("filters", ["use_solid", "use_strand", "use_solid use_strand"])
def test_filters_leave_out_surfaces_and_hair(glowing, render, filters):
    add_hair(bpy.data.objects["Square"])
    parts.add_square(glowing, "Other", 0.5, (1.5, 1.0, 0.0), bpy.data.materials["Glow"])
    everything, _ = both(glowing, render)
    for name in filters.split():
        setattr(glowing.view_layers[0], name, False)
    ours, theirs = both(glowing, render)
    assert abs(everything[3].mean() - ours[3].mean()) > 0.01
    # 16 samples a pixel of Cycles' on edges of hair.
    assert abs(ours[3].mean() - theirs[3].mean()) < 0.005
    if filters == "use_solid use_strand":
        assert not ours.any()


@pytest.mark.skipif(
    "world_override" not in bpy.types.ViewLayer.bl_rna.properties,
    reason="view layers of this Blender have no world of their own",
)
def test_a_layer_may_have_its_own_world(glowing, render):
    glowing.render.film_transparent = False
    glowing.world = world("Red", (0.9, 0.0, 0.0))
    glowing.view_layers[0].world_override = world("Green", (0.0, 0.9, 0.0))
    ours, theirs = both(glowing, render)
    assert np.abs(ours - theirs).max() < 1e-6
    np.testing.assert_allclose(ours[:, 0, 0], (0.0, 0.9, 0.0, 1.0), atol=1e-6)


@pytest.mark.parametrize(
    "use, own, expected", [("USE", 25, 25), ("BOUNDED", 25, 9), ("IGNORE", 25, 9), ("USE", 0, 9)]
)
def test_a_layer_may_have_its_own_samples(scene, use, own, expected):
    from granita.export.scene.options import options_record, scene_crop, scene_frame

    scene.granita.samples = 9
    scene.view_layers[0].samples = own
    scene.cycles.use_layer_samples = use
    frame = scene_frame(scene.render)
    crop = scene_crop(scene, frame)
    record = options_record(scene, scene.view_layers[0], scene.granita, frame, crop, 0.5)
    assert record["samples"] == expected


def test_exposure_is_of_light_alone(glowing, render):
    """The picture and passes of light, not of colours: each as Cycles has it."""
    glowing.render.film_transparent = False
    glowing.world = world("Grey", (0.2, 0.3, 0.4))
    parts.add_square(glowing, "Matte", 1.0, (1.5, 0.5, -1.0))
    layer = glowing.view_layers[0]
    for name in ("emit", "environment", "diffuse_direct", "diffuse_color"):
        setattr(layer, f"use_pass_{name}", True)
    whole, _ = parts.direct_light_of_both(glowing, render, 16)
    glowing.cycles.film_exposure = 0.5
    half, theirs = parts.direct_light_of_both(glowing, render, 16)
    factors = {}
    for name, values in half.items():
        factors[name] = values.sum() / whole[name].sum()
        # 16 samples a pixel of Cycles' see an edge at other places.
        assert abs(values.mean() - theirs[name].mean()) < 0.01, name
    colours = {name for name in factors if ".DiffCol." in name or ".Diffuse Color." in name}
    assert len(colours) == 3
    for name, factor in factors.items():
        same = name in colours or name.endswith("Combined.A")
        assert factor == pytest.approx(1.0 if same else 0.5, rel=0.01), name


@pytest.mark.parametrize("kind", ["EMPTY", "SPOT", "POINT"])
def test_any_object_may_be_the_camera(glowing, render, kind):
    if kind == "EMPTY" and (5, 1) <= bpy.app.version < (5, 3):
        pytest.skip("Cycles itself crashes")
    light = None
    if kind != "EMPTY":
        light = bpy.data.lights.new(kind, kind)
        light.energy = 0.0
    if kind == "SPOT":
        light.spot_size = 0.6
    glowing.camera = parts.add_object(glowing, "Eye", light, (0.3, 0.1, 5.0))
    ours, theirs = both(glowing, render, samples=64)
    assert 0.02 < ours[3].mean() < 0.9
    # Pixels of the square's border, 64 samples each.
    assert np.abs(ours - theirs).mean() < 2e-3


def test_passes_that_are_not_made_are_named(scene):
    from granita import passes

    layer = scene.view_layers[0]
    assert passes.missing(layer) == []
    layer.use_pass_ambient_occlusion = layer.use_pass_cryptomatte_object = True
    layer.use_pass_diffuse_direct = layer.use_pass_subsurface_direct = True
    layer.cycles.pass_debug_sample_count = True
    layer.lightgroups.add(name="Key")
    names = passes.missing(layer)
    assert len(names) == 5
    for word in ("Ambient Occlusion", "Cryptomatte Object", "Subsurface", "Key", "ample"):
        assert any(word in name for name in names), (word, names)


def test_a_layer_without_a_sky_has_no_world(glowing, render):
    """Neither seen nor shining."""
    glowing.render.film_transparent = False
    glowing.world = world("Red", (0.9, 0.0, 0.0))
    matte = bpy.data.materials.new("Matte")
    if matte.node_tree is None:
        matte.use_nodes = True
    parts.add_square(glowing, "Matte", 0.5, (1.5, 1.0, 0.0), matte)
    shown, _ = both(glowing, render)
    glowing.view_layers[0].use_sky = False
    ours, theirs = both(glowing, render)
    assert np.abs(ours - theirs).max() < 1e-6
    # Left is what glows.
    assert shown[0].mean() > ours[0].mean() + 0.3
