# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that tame the noise of bounces, beside Cycles in the same Blender: Clamp Indirect, Filter Glossy."""

import bpy
import pytest
import scene_parts
from bounced_parts import look_at_stage, met_by_chance, render_bounced, surface, worst_block
from mathutils import Vector
from node_comparison import Tree


def lamp_towards(scene, place, target, energy, size):
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy, lamp.size = energy, size
    light = scene_parts.add_object(scene, "Lamp", lamp, place)
    way = Vector(target) - light.location
    light.rotation_euler = way.to_track_quat("-Z", "Y").to_euler()


def mirrored_wall(scene, material_of):
    """A mirror shows a wall that a large lamp stands before, brighter by far than a clamp of 1."""
    mirror = scene_parts.add_square(scene, "Mirror", 8.0)
    surface(mirror, "ShaderNodeBsdfGlossy", (1.0, 1.0, 1.0), Roughness=0.0)
    wall = scene_parts.add_square(scene, "Wall", 4.0, (0.0, 3.0, 1.6))
    wall.rotation_euler.x = 1.57
    wall.visible_camera = False
    material_of(wall)
    lamp_towards(scene, (0.0, 0.5, 2.5), (0.0, 3.0, 1.6), 3000.0, 3.0)
    look_at_stage(scene, 3.0, 0.5)


def mixed(thing, *closures, factor=0.5):
    """Two closures, each (kind, {input: value}), the second by the factor; returns their nodes."""
    tree = Tree(thing)
    mix = tree.add("ShaderNodeMixShader")
    mix.inputs["Fac"].default_value = factor
    nodes = []
    for socket, (kind, inputs) in zip(mix.inputs[1:], closures, strict=True):
        node = tree.add(f"ShaderNodeBsdf{kind}")
        for name, value in inputs.items():
            node.inputs[name].default_value = value
        tree.link(node.outputs[0], socket)
        nodes.append(node)
    tree.link(mix.outputs[0], tree.output.inputs["Surface"])
    return nodes


@pytest.mark.parametrize("kind, clamp, worst", [("Diffuse", 0.3, 0.1), ("Glass", 10.0, 0.8)])
def test_clamp_indirect_is_that_of_cycles(scene, render, kind, clamp, worst):
    """A ball before a bright square, on a floor: its number is three times as much of the channels' sum, and ways in glass,
    which are all followed, share one."""
    floor = scene_parts.add_square(scene, "Floor", 30.0)
    surface(floor, "ShaderNodeBsdfDiffuse", (0.5, 0.5, 0.5))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.9, location=(0.0, 0.0, 0.92))
    bpy.ops.object.shade_smooth()
    surface(bpy.context.object, f"ShaderNodeBsdf{kind}", (1.0, 1.0, 1.0))
    shining = scene_parts.emission("Shining", (1.0, 1.0, 1.0), 160.0)
    square = scene_parts.add_square(scene, "Square", 1.0, (3.0, -1.0, 5.0), shining)
    square.rotation_euler = (-square.location).to_track_quat("-Z", "Y").to_euler()
    look_at_stage(scene, 3.0, 0.5)
    both = render_bounced(scene, render, 512, limit=12, clamp=clamp)
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=0.01)
    assert worst_block(both) < worst


@pytest.mark.parametrize(
    "place, energy, roughness",
    [
        ((-2.0, 6.0, 4.0), 1500.0, 0.3),
        ((-2.0, 6.0, 4.0), 1500.0, 0.5),
        ((0.0, 5.0, -1.0), 3000.0, 0.5),
    ],
    ids=["aside", "aside, rougher", "straight"],
)
def test_lamps_behind_frosted_glass_are_clamped_a_way_at_a_time(
    scene, render, place, energy, roughness
):
    """Light samples and what lobes meet are contributions of their own: held to one clamp together, a ball straight
    before a lamp was 27 % too dark."""
    frosted = scene_parts.closure(
        "Frosted", "ShaderNodeBsdfGlass", Color=(1.0, 0.9, 0.8, 1.0), Roughness=roughness, IOR=1.45
    )
    bpy.ops.mesh.primitive_uv_sphere_add(
        segments=48, ring_count=24, radius=0.9, location=(0.0, 0.0, 0.5)
    )
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(frosted)
    lamp_towards(scene, place, (0.0, 0.0, 0.5), energy, 3.0)
    look_at_stage(scene, 2.5, 0.5)
    both = render_bounced(scene, render, 1024, limit=2, clamp=10.0)
    assert both[0].mean() > 0.02
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=0.05)


def test_what_two_lobes_meet_of_a_lamp_is_clamped_apart(scene, render):
    """Two glossy lobes in a mirror, each of which shows the lamp brighter than the clamp: together they were held to one, - 25 %."""
    lobes = [("Glossy", {"Roughness": roughness}) for roughness in (0.1, 0.15)]
    mirrored_wall(scene, lambda wall: mixed(wall, *lobes))
    both = render_bounced(scene, render, 512, limit=2, clamp=1.0)
    assert 0.1 < both[0].mean() < 0.5  # of what is about ten times as bright
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=0.02)


@pytest.mark.parametrize("roughness", [0.0, 0.4])
def test_what_shines_in_first_reflections_is_not_indirect(scene, render, roughness):
    """A bright wall that is no lamp: a clamp of a 30th of what it brings took 95 % of its reflection away."""
    floor = scene_parts.add_square(scene, "Floor", 8.0)
    surface(floor, "ShaderNodeBsdfGlossy", (0.9, 0.9, 0.9), Roughness=roughness)
    shining = scene_parts.emission("Shining", (30.0, 30.0, 30.0), 1.0)
    tree = shining.node_tree
    kind = tree.nodes.new("ShaderNodeLightPath")  # what varies by it is met by chance alone
    node = next(n for n in tree.nodes if n.type == "EMISSION")
    tree.links.new(kind.outputs["Is Glossy Ray"], node.inputs["Strength"])
    met_by_chance(shining)
    wall = scene_parts.add_square(scene, "Wall", 4.0, (0.0, 3.0, 1.6), shining)
    wall.rotation_euler.x = 1.57
    look_at_stage(scene, 3.0, 0.5)
    both = render_bounced(scene, render, 512, limit=1, clamp=1.0)
    assert both[0].mean() > 1.0
    # Facets that hand light on: - 2.0 % in Blender 5.0, whose Glossy has them from the start.
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=0.025)


def test_brushed_metal_is_filtered_along_and_across(scene, render):
    """A box on brushed metal: what of it is smoother than Filter Glossy asks for is made as rough, along and across.  As
    stretched as before, a block of the box was a tenth off."""

    def metal(name, anisotropic):
        made = scene_parts.closure(name, "ShaderNodeBsdfPrincipled", Metallic=1.0, Roughness=0.25)
        node = next(n for n in made.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
        node.inputs["Base Color"].default_value = (0.8, 0.2, 0.1, 1.0)
        node.inputs["Anisotropic"].default_value = anisotropic
        return made

    scene_parts.add_square(scene, "Floor", 4.0, material=metal("Brushed", 0.8))
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(0.0, 1.5, 1.0))
    bpy.context.object.data.materials.append(metal("Plain", 0.0))
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.5
    light = scene_parts.add_object(scene, "Sun", sun)
    light.rotation_euler = Vector((3.0, -3.0, 5.0)).to_track_quat("Z", "Y").to_euler()
    scene_parts.set_world(scene, (0.3, 0.35, 0.4))
    look_at_stage(scene, 2.5, 0.9)
    both = render_bounced(scene, render, 512, blur_glossy=1.0)
    assert worst_block(both) < 0.07


def lit_wall_over(scene, floor):
    """A bright wall behind a floor, under a lamp that the floor does not show."""
    plane = scene_parts.add_square(scene, "Floor", 8.0)
    floor(plane)
    wall = scene_parts.add_square(scene, "Wall", 4.0, (0.0, 3.0, 1.6))
    wall.rotation_euler.x = 1.57
    surface(wall, "ShaderNodeBsdfDiffuse", (0.9, 0.9, 0.9))
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy = 3000.0
    lamp = scene_parts.add_object(scene, "Lamp", lamp, (0.0, 1.5, 3.0))
    lamp.rotation_euler = Vector((0.0, -1.5, 2.0)).to_track_quat("Z", "Y").to_euler()
    lamp.visible_glossy = False
    look_at_stage(scene, 3.0, 0.5)


@pytest.mark.parametrize("color", [0.5, 0.2])
def test_a_mirror_is_clamped_by_what_it_shows(scene, render, color):
    """Cycles, which takes one lobe by chance, takes a dark mirror as surely as a white one where there is no other: it was
    held to its part of the clamp, - 50 and - 76 % of a block."""
    lit_wall_over(
        scene, lambda floor: surface(floor, "ShaderNodeBsdfGlossy", (color,) * 3, Roughness=0.0)
    )
    both = render_bounced(scene, render, 512, limit=1, clamp=0.5)
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=0.01)
    assert worst_block(both) < 0.1


def test_a_weak_mirror_over_paint_is_clamped_as_seldom_as_it_is_chosen(scene, render):
    """Of Principled, whose mirror of .04 chance takes every third time over a dark paint: 67 % of a block."""

    def paint(floor):
        made = scene_parts.closure("Paint", "ShaderNodeBsdfPrincipled", Roughness=0.0)
        node = next(n for n in made.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
        node.inputs["Base Color"].default_value = (0.1, 0.1, 0.1, 1.0)
        floor.data.materials.append(made)

    lit_wall_over(scene, paint)
    both = render_bounced(scene, render, 1024, limit=4, clamp=1.0)
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=0.015)
    assert worst_block(both) < 0.15


def half_clear(thing, kind="Diffuse", **inputs):
    mixed(thing, (kind, inputs), ("Transparent", {}))


def test_what_is_half_clear_is_clamped_twice_as_much(scene, render):
    """Chance takes what it reflects every second time, and clamps what that brings for both: light that bounced was 37 % too bright."""
    lit_wall_over(scene, half_clear)
    bpy.data.objects["Wall"].visible_camera = False
    both = render_bounced(scene, render, 512, limit=1, clamp=3.0)
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=0.02)
    assert worst_block(both) < 0.1


def test_what_is_half_clear_shows_lamps_clamped_twice_as_much(scene, render):
    """The same of a lamp that its gloss meets, in a mirror: 65 % too bright."""
    mirrored_wall(scene, lambda wall: half_clear(wall, "Glossy", Roughness=0.1))
    both = render_bounced(scene, render, 512, limit=2, clamp=1.0)
    assert 0.05 < both[0].mean() < 0.5
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=0.02)


def test_filter_glossy_leaves_cloth_alone(scene, render):
    """It blurs facets that mirror: a box of velvet lit a floor 19 % too far in a block."""
    floor = scene_parts.add_square(scene, "Floor", 8.0)
    surface(floor, "ShaderNodeBsdfDiffuse", (0.8, 0.8, 0.8))
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(0.0, 1.0, 1.0))
    kind = "ShaderNodeBsdfVelvet" if hasattr(bpy.types, "ShaderNodeBsdfVelvet") else None
    if kind is None:
        pytest.skip("Blender 4 has no velvet")
    surface(bpy.context.object, kind, (0.9, 0.9, 0.9), Sigma=0.2)
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.1
    light = scene_parts.add_object(scene, "Sun", sun)
    light.rotation_euler = Vector((1.0, -3.0, 4.0)).to_track_quat("Z", "Y").to_euler()
    look_at_stage(scene, 3.0, 0.5)
    both = render_bounced(scene, render, 512, limit=2, blur_glossy=1.0)
    assert worst_block(both) < 0.05


@pytest.mark.skipif(bpy.app.version < (4, 0, 0), reason="made up for after the blur, as in Cycles")
def test_what_the_filter_blurs_keeps_the_energy_that_it_was_made_with(scene, render):
    """Metal under a diffuse wall: blurred lobes lose energy in Cycles since Blender 4, which is made up for before.  The
    wall was 2 to 4 % too bright."""
    floor = scene_parts.add_square(scene, "Floor", 6.0)
    metal = scene_parts.closure("Metal", "ShaderNodeBsdfPrincipled", Metallic=1.0, Roughness=0.05)
    floor.data.materials.append(metal)
    wall = scene_parts.add_square(scene, "Wall", 4.0, (0.0, 1.5, 2.0))
    wall.rotation_euler.x = 1.57
    surface(wall, "ShaderNodeBsdfDiffuse", (0.8, 0.1, 0.1))
    scene_parts.set_world(scene, (0.5, 0.5, 0.5))
    look_at_stage(scene, 2.0, 1.5)
    theirs, ours = render_bounced(scene, render, 1024, limit=4, blur_glossy=1.0)
    inner = (slice(20, 36), slice(24, 40))  # of the wall
    assert ours[inner].mean() == pytest.approx(theirs[inner].mean(), rel=0.007)


@pytest.mark.parametrize("reflective", [False, True])
@pytest.mark.parametrize("refractive", [False, True])
@pytest.mark.parametrize("kind", ["Refraction", "Glass", "Glossy"])
def test_each_switch_of_caustics_takes_its_own_lobes(scene, render, kind, reflective, refractive):
    """A rough sheet hangs over a matte floor, under a bright sky: what it lets through and what it mirrors had one switch."""
    floor = scene_parts.add_square(scene, "Floor", 2.0)
    surface(floor, "ShaderNodeBsdfDiffuse", (0.8, 0.8, 0.8))
    sheet = scene_parts.add_square(scene, "Sheet", 8.0, (0.0, 0.0, 1.0))
    sheet.visible_camera = False
    surface(sheet, f"ShaderNodeBsdf{kind}", (0.9, 0.9, 0.9), Roughness=0.3)
    scene_parts.set_world(scene, (0.5, 0.5, 0.5))
    scene.cycles.caustics_reflective = reflective
    scene.cycles.caustics_refractive = refractive
    scene_parts.add_camera(scene, (0.0, 0.0, 0.5), ortho_scale=1.0)
    scene.render.resolution_x = scene.render.resolution_y = 16
    theirs, ours = render_bounced(scene, render, 2048, limit=4)
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.015)


@pytest.mark.parametrize("reflective, refractive", [(False, True), (True, False), (True, True)])
@pytest.mark.parametrize("case", ["Glass", "Glossy"])
def test_what_sent_the_ray_decides_over_caustics(scene, render, case, reflective, refractive):
    """Over a matte floor a cube of glass, whose far side is met by what the near one sent on, or a mirror above a sheet that
    refracts: any matte surface before had closed all of them, a half of the light."""
    floor = scene_parts.add_square(scene, "Floor", 2.0)
    surface(floor, "ShaderNodeBsdfDiffuse", (0.8, 0.8, 0.8))
    if case == "Glass":
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 0.7))
        things = [bpy.context.object]
        surface(things[0], "ShaderNodeBsdfGlass", (1.0, 1.0, 1.0), Roughness=0.0, IOR=1.5)
    else:
        things = [
            scene_parts.add_square(scene, "Mirror", 3.0, (0.0, 0.0, 1.5)),
            scene_parts.add_square(scene, "Sheet", 8.0, (0.0, 0.0, -0.5)),
        ]
        surface(things[0], "ShaderNodeBsdfGlossy", (0.9, 0.9, 0.9), Roughness=0.0)
        surface(things[1], "ShaderNodeBsdfRefraction", (0.9, 0.9, 0.9), Roughness=0.0, IOR=1.2)
    for thing in things:
        thing.visible_camera = False
    scene_parts.set_world(scene, (1.0, 1.0, 1.0))
    scene.cycles.caustics_reflective = reflective
    scene.cycles.caustics_refractive = refractive
    scene_parts.add_camera(scene, (0.0, 0.0, 5.0), ortho_scale=0.8)
    scene.render.resolution_x = scene.render.resolution_y = 16
    both = render_bounced(scene, render, 2048, limit=6, transmission_bounces=6)
    # What glass mirrors alone is 3.6 % more here: why is not known.
    within = 0.045 if case == "Glass" and not refractive else 0.02
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=within)


def test_a_little_refraction_takes_nothing_from_what_is_translucent(scene, render):
    """Where its facets, blurred or not, send no sample, those of the translucent lobe shared the light with it all the same:
    9 %."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
    ball = bpy.context.object
    ball.data.polygons.foreach_set("use_smooth", [True] * len(ball.data.polygons))
    closures = [("Refraction", {"Roughness": 0.5, "IOR": 1.4}), ("Translucent", {})]
    refraction, _ = mixed(ball, *closures, factor=0.99)
    refraction.distribution = "GGX"
    scene_parts.set_world(scene, (0.5, 0.5, 0.5))
    scene_parts.add_camera(scene, ortho_scale=1.4)
    both = render_bounced(scene, render, 256, blur_glossy=1.0, limit=12, transmission_bounces=12)
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=0.015)
