# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from surface to surface in Blender: whose limits count, and a room beside Cycles in the same Blender."""

import math
from types import SimpleNamespace

import bpy
import exr
import numpy as np
import pytest
import scene_parts
from bounced_parts import picture, render_bounced, room, surface

from granita.export.scene.light_paths import (
    light_paths,
    report_clamp_direct,
    report_occlusion,
    report_transparent_glass,
)


def test_no_limits_are_handed_over_where_light_is_not_followed(scene):
    scene.granita.bounces = "NONE"
    assert light_paths(scene, scene.granita) == {}


def test_limits_are_those_of_cycles(scene):
    scene.granita.bounces = "FULL"
    cycles = scene.cycles
    cycles.max_bounces, cycles.diffuse_bounces, cycles.glossy_bounces = 7, 3, 5
    cycles.transmission_bounces, cycles.transparent_max_bounces = 6, 2
    cycles.sample_clamp_indirect, cycles.blur_glossy = 4.0, 0.5
    cycles.caustics_reflective, cycles.volume_bounces = False, 5
    cycles.caustics_refractive = True
    limits = light_paths(scene, scene.granita)
    # Cycles compares the sum of the channels with three times its clamp.
    assert limits == {
        "bounces": 7,
        "diffuse_bounces": 3,
        "glossy_bounces": 5,
        "transmission_bounces": 6,
        "volume_bounces": 5,
        "transparent_bounces": 2,
        "clamp_indirect": 12.0,
        "reflective_caustics": False,
        "refractive_caustics": True,
        "filter_glossy": 0.5,
    }
    scene.granita.bounces = "FAST"
    assert light_paths(scene, scene.granita) == {**limits, "bounces": 2}


@pytest.mark.parametrize("diffuse, transmission", [(4, 12), (1, 12), (4, 0)])
def test_light_through_leaves_is_transmitted(scene, render, diffuse, transmission):
    """Four sheets, half of each translucent: what goes through has the limit of what is transmitted."""
    material, nodes, links, output = scene_parts.node_material("Leaf")
    mix = nodes.new("ShaderNodeMixShader")
    for i, kind in enumerate(("ShaderNodeBsdfTranslucent", "ShaderNodeBsdfDiffuse"), 1):
        shader = nodes.new(kind)
        shader.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1.0)
        links.new(shader.outputs[0], mix.inputs[i])
    links.new(mix.outputs[0], output.inputs["Surface"])
    for i in range(4):
        scene_parts.add_square(scene, f"Sheet {i}", 20.0, (0.0, 0.0, -0.5 * i), material)
    scene_parts.set_world(scene, (1.0, 1.0, 1.0))
    scene_parts.add_camera(scene, ortho_scale=1.0)
    scene.render.resolution_x = scene.render.resolution_y = 8
    limits = {"diffuse_bounces": diffuse, "transmission_bounces": transmission}
    theirs, ours = render_bounced(scene, render, 2048, limit=12, **limits)
    assert theirs.mean() > 0.3
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.015)


def test_what_shines_inside_lights_a_floor_without_bounces(scene, render):
    """Max Bounces 0: a volume's emission is met all the same, as in Cycles."""
    floor = scene_parts.add_square(scene, "Floor", 6.0)
    surface(floor, "ShaderNodeBsdfDiffuse", (0.8, 0.8, 0.8))
    material, nodes, links, output = scene_parts.node_material("Shines")
    links.new(nodes.new("ShaderNodeEmission").outputs[0], output.inputs["Volume"])
    corners = [(x, y, z) for z in (0.2, 1.0) for y in (-0.5, 0.5) for x in (-0.5, 0.5)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    scene_parts.add_mesh(scene, "Box", corners, faces, material=material)
    scene_parts.add_camera(scene, ortho_scale=3.0)
    scene.render.resolution_x = scene.render.resolution_y = 24
    theirs, ours = render_bounced(scene, render, 1024, limit=0)
    beside = np.ones((24, 24), bool)
    beside[7:17, 7:17] = False
    assert theirs[beside].mean() > 0.03
    assert ours[beside].mean() == pytest.approx(theirs[beside].mean(), rel=0.02)


@pytest.mark.parametrize("transparent", [False, True])
@pytest.mark.parametrize("glass", [False, True])
def test_transparent_glass_is_named_where_it_would_show(scene, transparent, glass):
    scene.render.film_transparent, scene.cycles.film_transparent_glass = transparent, glass
    named = []
    report_transparent_glass(scene, lambda *words: named.append(words))
    assert [what for what, _ in named] == ["render settings"] * (transparent and glass)


@pytest.mark.parametrize("clamp", [0.0, 2.0])
def test_a_limit_of_direct_light_is_named(scene, clamp):
    scene.cycles.sample_clamp_direct = clamp
    named = []
    report_clamp_direct(scene, lambda *words: named.append(words))
    assert [what for what, _ in named] == ["render settings"] * (clamp > 0.0)


def test_fast_gi_is_read(scene):
    """Replace with a number for renders and one for views; where there is no world neither is."""
    scene.granita.bounces = "FULL"
    cycles = scene.cycles
    without = light_paths(scene, scene.granita)
    cycles.use_fast_gi, cycles.fast_gi_method = True, "REPLACE"
    cycles.ao_bounces, cycles.ao_bounces_render = 3, 2
    scene.world = None
    assert light_paths(scene, scene.granita) == without
    scene.world = bpy.data.worlds.new("World")
    scene.world.light_settings.distance, scene.world.light_settings.ao_factor = 4.0, 0.5
    read = {"occluded_from": 2, "occlusion_distance": 4.0, "occlusion_factor": 0.5}
    assert light_paths(scene, scene.granita) == {**without, **read}
    read["occluded_from"] = 3
    assert light_paths(scene, scene.granita, in_view=True) == {**without, **read}
    cycles.fast_gi_method = "ADD"
    added = {"occlusion_added": 0.5, "occlusion_distance": 4.0}
    assert light_paths(scene, scene.granita) == {**without, **added}
    scene.granita.bounces = "NONE"  # it stands for all of them
    alone = light_paths(scene, scene.granita)
    assert added.items() <= alone.items()
    assert alone["bounces"] == 1 and alone["diffuse_bounces"] == alone["volume_bounces"] == 0
    cycles.use_fast_gi = False
    assert light_paths(scene, scene.granita) == {}


LOBES = {  # before Blender 5, and since
    "diffuse": ("Diff", "Diffuse "),
    "glossy": ("Gloss", "Glossy "),
    "transmission": ("Trans", "Transmission "),
}
PARTS = {"direct": ("Dir", "Direct"), "indirect": ("Ind", "Indirect"), "color": ("Col", "Color")}


def test_light_passes_are_those_of_cycles(scene, render):
    """Of a pane of rough glass before a room, in which a ball is glossy."""
    surface(room(scene), "ShaderNodeBsdfGlossy", (0.7, 0.7, 0.7), Roughness=0.4)
    pane = scene_parts.add_square(scene, "Pane", 0.8, (-0.4, 0.3, 0.6))
    surface(pane, "ShaderNodeBsdfRefraction", (0.9, 0.9, 0.9), Roughness=0.5, IOR=1.45)
    # Small, it would be a highlight of one pixel, whose samples tell nothing of lobes.
    bpy.data.lights["Lamp"].shadow_soft_size = 0.25
    layer = scene.view_layers[0]
    for lobe in LOBES:
        for part in PARTS:
            setattr(layer, f"use_pass_{lobe}_{part}", True)
    theirs, ours = render_bounced(scene, render, 1024, all_passes=True)
    total = np.zeros_like(picture(ours, "Combined"))
    since = bpy.app.version >= (5, 0, 0)
    for lobe, names in LOBES.items():
        made = [
            {part: picture(passes, names[since] + PARTS[part][since]) for part in PARTS}
            for passes in (theirs, ours)
        ]
        for part in PARTS:
            means = [passes[part].mean() for passes in made]
            # Noise of 576 pixels, of 40 in the pane and 20 of the ball.
            assert means[1] == pytest.approx(means[0], rel=0.03, abs=1e-3), (lobe, part)
        total += (made[1]["direct"] + made[1]["indirect"]) * made[1]["color"]
    assert total == pytest.approx(picture(ours, "Combined"), abs=1e-4)


@pytest.mark.parametrize(("kind", "rough"), [("Diffuse", None), ("Glossy", 0.3), ("Glossy", 0.0)])
def test_a_room_is_as_bright_as_in_cycles(scene, render, kind, rough):
    """Blocks of 4 x 4 pixels.  Cycles' 512 samples leave 1 to 2 % of noise in each of them, less in the mean, but for
    what a mirror throws onto the walls: .017 and .13 were seen."""
    scene.cycles.caustics_reflective = True
    inputs = {} if rough is None else {"Roughness": rough}
    surface(room(scene), f"ShaderNodeBsdf{kind}", (0.7, 0.7, 0.7), **inputs)
    # The lamp in the mirror is a hundredth of a pixel, and as bright as three.
    theirs, ours = render_bounced(scene, render, 512, samples=64 if rough == 0.0 else 16)
    assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=0.03)
    blocks = [p.reshape(6, 4, 6, 4, 3).mean(axis=(1, 3)) for p in (theirs, ours)]
    off = np.abs(blocks[1] - blocks[0]) / theirs.mean()
    assert np.median(off) < (0.03 if rough == 0.0 else 0.015)
    assert np.percentile(off, 95) < (0.25 if rough == 0.0 else 0.12)


@pytest.mark.parametrize("bounces", [0, 1])
def test_max_bounces_of_a_lamp(scene, render, bounces):
    surface(room(scene), "ShaderNodeBsdfDiffuse", (0.7, 0.7, 0.7))
    bpy.data.lights["Lamp"].cycles.max_bounces = bounces
    theirs, ours = render_bounced(scene, render, 512)
    # .6 and .86 of the light come after so few bounces; noise of .002.
    assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=0.02)


@pytest.mark.parametrize("rough", [None, 0.6, 0.3, 0.0])
@pytest.mark.parametrize(("kind", "size"), [("AREA", 2.0), ("POINT", 0.4)])
def test_lobes_meet_a_lamp_after_more_bounces_than_its_own(scene, render, kind, size, rough):
    """A mirror shows a wall, which no longer asks the lamp but reflects what its lobes' samples meet of it."""
    mirror = scene_parts.add_square(scene, "Mirror", 1.0)
    surface(mirror, "ShaderNodeBsdfGlossy", (1.0, 1.0, 1.0), Roughness=0.0)
    wall = scene_parts.add_square(scene, "Wall", 1.0, (0.0, 0.0, 2.0))
    inputs = {} if rough is None else {"Roughness": rough}
    lobe = "ShaderNodeBsdfDiffuse" if rough is None else "ShaderNodeBsdfGlossy"
    surface(wall, lobe, (0.8, 0.8, 0.8), **inputs)
    wall.visible_camera = False
    lamp = bpy.data.lights.new("Lamp", kind)
    setattr(lamp, "size" if kind == "AREA" else "shadow_soft_size", size)
    lamp.energy, lamp.cycles.max_bounces = 10.0, 0
    hung = scene_parts.add_object(scene, "Lamp", lamp, (0.0, 0.0, 1.0))
    hung.rotation_euler = (math.pi, 0.0, 0.0)  # it shines at the wall alone
    scene_parts.add_camera(scene, (0.0, 0.0, 3.0), ortho_scale=0.5)
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.cycles.caustics_reflective = True
    theirs, ours = render_bounced(scene, render, 512)
    # 1 % was seen.  Without what lobes meet, the diffuse wall before the round lamp, which the mirror shows beside it,
    # would be 1.4 % darker, and all others more: nothing of the area lamp's light would be there.
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.012)


@pytest.mark.parametrize("bounces, sampling", [(0, "AUTOMATIC"), (1, "AUTOMATIC"), (0, "NONE")])
@pytest.mark.parametrize("rough", [None, 0.6])
def test_max_bounces_of_a_world(scene, render, rough, bounces, sampling):
    """A small bright part of the sky lights a wall that a mirror shows: with 0 the wall's own rays alone meet it, which lose
    nothing where the world is not sampled."""
    mirror = scene_parts.add_square(scene, "Mirror", 0.6)
    surface(mirror, "ShaderNodeBsdfGlossy", (1.0, 1.0, 1.0), Roughness=0.0)
    wall = scene_parts.add_square(scene, "Wall", 1.0, (0.0, 0.0, 1.0))
    inputs = {} if rough is None else {"Roughness": rough}
    lobe = "ShaderNodeBsdfDiffuse" if rough is None else "ShaderNodeBsdfGlossy"
    surface(wall, lobe, (0.8, 0.8, 0.8), **inputs)
    wall.visible_camera = False
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.cycles.max_bounces, scene.world.cycles.sampling_method = bounces, sampling
    tree = scene.world.node_tree
    around = tree.nodes.new("ShaderNodeVectorMath")
    around.operation = "DOT_PRODUCT"
    around.inputs[1].default_value = (0.5**0.5, 0.0, -(0.5**0.5))
    inside = tree.nodes.new("ShaderNodeMath")
    inside.operation = "GREATER_THAN"
    inside.inputs[1].default_value = 0.97
    strength = tree.nodes.new("ShaderNodeMath")
    strength.operation = "MULTIPLY_ADD"
    strength.inputs[1].default_value, strength.inputs[2].default_value = 20.0, 0.2
    sky = next(node for node in tree.nodes if node.type == "BACKGROUND")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    for a, b in (
        (coordinates.outputs["Generated"], around.inputs[0]),
        (around.outputs["Value"], inside.inputs[0]),
        (inside.outputs[0], strength.inputs[0]),
        (strength.outputs[0], sky.inputs["Strength"]),
    ):
        tree.links.new(a, b)
    scene_parts.add_camera(scene, (0.0, 0.0, 3.0), ortho_scale=0.5)
    scene.render.resolution_x = scene.render.resolution_y = 48
    scene.cycles.caustics_reflective = True
    theirs, ours = render_bounced(scene, render, 512)
    # .6 % was seen.  With 0 a sixth of the light is left, with 1 of it 95 %.
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.015)


@pytest.mark.parametrize("hidden", ["visible_diffuse", "visible_glossy"])
def test_what_is_hidden_from_a_type_of_ray(scene, render, hidden):
    """A lit square hangs before a mirror or a wall, out of the camera's sight."""
    mirrored = hidden == "visible_glossy"
    floor = scene_parts.add_square(scene, "Floor", 4.0)
    kind = "ShaderNodeBsdfGlossy" if mirrored else "ShaderNodeBsdfDiffuse"
    surface(floor, kind, (0.8, 0.8, 0.8), **({"Roughness": 0.0} if mirrored else {}))
    shining = scene_parts.emission("Shining", (1.0, 1.0, 1.0))
    above = scene_parts.add_square(scene, "Above", 4.0, (0.0, 0.0, 1.0), shining)
    above.visible_camera = False
    scene_parts.add_camera(scene, (0.0, 0.0, 0.5), ortho_scale=1.0)
    scene.render.resolution_x = scene.render.resolution_y = 8
    means = []
    for shown in (True, False):
        setattr(above, hidden, shown)
        means.append([p.mean() for p in render_bounced(scene, render, 64)])
    assert means[0][1] == pytest.approx(means[0][0], rel=0.03)
    assert means[1] == [0.0, 0.0]


def test_caustics_are_as_cycles_filters_them(scene, render):
    """Blender's own settings: Filter Glossy blurs what the ball throws, or it throws nothing."""
    surface(room(scene), "ShaderNodeBsdfGlossy", (0.9, 0.9, 0.9), Roughness=0.25)
    for shown, blur in ((True, 1.0), (False, 1.0)):
        scene.cycles.caustics_reflective = shown
        theirs, ours = render_bounced(scene, render, 512, blur_glossy=blur)
        assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=0.02)
        blocks = [p.reshape(6, 4, 6, 4, 3).mean(axis=(1, 3)) for p in (theirs, ours)]
        # Of noise: .067 were seen with 64 light samples, .049 with 256.
        assert np.percentile(np.abs(blocks[1] - blocks[0]), 95) < 0.08 * theirs.mean()


def dark_world(name, factor):
    world = bpy.data.worlds.new(name)
    world.use_nodes = True
    world.node_tree.nodes.clear()
    world.light_settings.ao_factor = factor
    return world


def open_floor(scene):
    """Of an albedo of a half: with nothing above it Fast GI adds half of its factor."""
    floor = scene_parts.add_square(scene, "Floor", 4.0)
    surface(floor, "ShaderNodeBsdfDiffuse", (0.5, 0.5, 0.5))
    scene_parts.add_camera(scene, (0.0, 0.0, 0.5), ortho_scale=1.0)
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.granita.bounces = "FULL"
    scene.cycles.use_fast_gi, scene.cycles.fast_gi_method = True, "ADD"


def added(scene, render):
    return render(scene)["ViewLayer.Combined.R"].mean()


def test_fast_gi_follows_an_animated_world(scene, tmp_path):
    """In an animation, of which the file's own world is told nothing."""
    open_floor(scene)
    scene.world = dark_world("World", 0.0)
    factors = {1: 0.2, 2: 0.9, 3: 0.4}
    for frame, factor in factors.items():
        scene.world.light_settings.ao_factor = factor
        scene.world.light_settings.keyframe_insert("ao_factor", frame=frame)
    scene.frame_start, scene.frame_end = 1, 3
    scene_parts.multilayer_exr(scene)
    scene.render.filepath = str(tmp_path / "frame")
    bpy.ops.render.render(animation=True)
    for frame, factor in factors.items():
        picture = exr.read(str(tmp_path / f"frame{frame:04d}.exr"))
        assert picture["ViewLayer.Combined.R"].mean() == pytest.approx(0.5 * factor, rel=1e-3)


@pytest.mark.skipif(
    "world_override" not in bpy.types.ViewLayer.bl_rna.properties, reason="from Blender 4.2 on"
)
@pytest.mark.parametrize("own", [True, False])
def test_fast_gi_follows_the_world_of_a_view_layer(scene, render, own):
    open_floor(scene)
    scene.world = dark_world("World", 0.2) if own else None
    scene.view_layers[0].world_override = dark_world("Override", 0.8)
    assert added(scene, render) == pytest.approx(0.4, rel=1e-3)


def test_an_ambient_occlusion_of_no_number_is_named(scene):
    scene.cycles.use_fast_gi, scene.granita.bounces = True, "FULL"
    world = dark_world("Odd", 0.5)
    named = []
    report_occlusion(scene, world, lambda *words: named.append(words))
    assert not named
    settings = SimpleNamespace(ao_factor=float("nan"), distance=1.0)
    odd = SimpleNamespace(name_full="Odd", light_settings=settings)
    report_occlusion(scene, odd, lambda *words: named.append(words))
    assert [what for what, _ in named] == ["world 'Odd'"]
    assert "occlusion_added" not in light_paths(scene, scene.granita, world=odd)
    assert "occluded_from" not in light_paths(scene, scene.granita, world=odd)


@pytest.mark.parametrize(
    ("method", "bounces", "distance", "followed"),
    [
        ("REPLACE", 1, 0.6, "FULL"),
        ("REPLACE", 2, 0.6, "FULL"),
        ("REPLACE", 1, 10.0, "FULL"),
        ("ADD", 1, 0.6, "FULL"),
        ("REPLACE", 1, 0.6, "NONE"),
        ("REPLACE", 2, 0.6, "NONE"),
        ("ADD", 1, 0.6, "NONE"),
    ],
)
def test_fast_gi_is_as_in_cycles(scene, render, method, bounces, distance, followed):
    """A room and a glossy ball in it, lit by a grey world and a lamp.  The mean was within .5 %; blocks along corners, on
    a pixel in which two walls meet, differ by 4 % as they do without it."""
    surface(room(scene), "ShaderNodeBsdfGlossy", (0.7, 0.7, 0.7), Roughness=0.3)
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.6, 0.8, 1.0)
    scene.world.light_settings.distance, scene.world.light_settings.ao_factor = distance, 0.8
    scene.cycles.use_fast_gi, scene.cycles.fast_gi_method = True, method
    scene.cycles.ao_bounces_render = bounces
    # Samples that are shaded by themselves too: they saw farther than their grid where no bounce is followed (- 11 %).
    scene.granita.shading_threshold = 0.0
    theirs, ours = render_bounced(scene, render, 512, bounces=followed)
    blocks = [p.reshape(6, 4, 6, 4, 3).mean(axis=(1, 3)) for p in (theirs, ours)]
    assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=0.01)
    assert np.percentile(np.abs(blocks[1] - blocks[0]), 95) < 0.05 * theirs.mean()


@pytest.mark.parametrize("diffuse", [1, 4])
def test_limits_count_what_chance_would_have_taken(scene, render, diffuse):
    """A room of Principled, whose mirror chance takes once in twenty times: a way along which both lobes reflect counts as
    glossy as seldom.  Where each lobe's sample counted as its own, half of the light had the limits of gloss: + 8 % with one
    Diffuse Bounce, + 4 % with Blender's four."""
    room(scene)
    for thing in scene.objects:
        if thing.type != "MESH":
            continue
        color = (0.8, 0.75, 0.7, 1.0) if thing.name != "Ball" else (0.5, 0.5, 0.5, 1.0)
        made = scene_parts.closure(thing.name, "ShaderNodeBsdfPrincipled", Roughness=0.5)
        node = next(n for n in made.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
        node.inputs["Base Color"].default_value = color
        thing.data.materials.clear()
        thing.data.materials.append(made)
    limits = {"diffuse_bounces": diffuse, "glossy_bounces": 4, "limit": 12}
    theirs, ours = render_bounced(scene, render, 1024, **limits)
    # Left are .4 to 2 % (4.5, one Diffuse Bounce), for which the lobes' chances are not Cycles' to the percent.
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.025)
