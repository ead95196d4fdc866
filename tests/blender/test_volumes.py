# SPDX-License-Identifier: GPL-3.0-or-later
"""What fills things and the world beside Cycles in the same Blender."""

import math

import bpy
import export_probe
import node_comparison
import numpy as np
import pytest
import scene_parts
from test_subsurface import lamp

SIZE, BLOCK = 64, 8


def blocks(channels, name="Combined"):
    """A pass as means of blocks of pixels, [blocks, blocks, 3]."""
    layer = next(one for one in channels if one.endswith(f"{name}.R"))[:-1]
    picture = np.stack([channels[layer + c] for c in "RGB"], axis=-1)
    rows = SIZE // BLOCK
    return picture.reshape(rows, BLOCK, rows, BLOCK, 3).mean(axis=(1, 3))


def channels_of_both(scene, render, samples, bounces=0, in_volumes=0):
    """(Cycles', Granita's); `bounces` of all kinds but `in_volumes`."""
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = samples, False, False
    cycles.pixel_filter_type = "BOX"
    cycles.max_bounces = bounces
    cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.volume_bounces = in_volumes
    cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = cycles.light_sampling_threshold = 0.0
    scene.granita.samples = samples
    scene.granita.pixel_filter, scene.granita.filter_width = "BOX", 1.0
    scene.granita.bounces = "FULL" if bounces else "NONE"
    pictures = []
    for engine in ("CYCLES", "GRANITA"):
        scene.render.engine = engine
        pictures.append(render(scene, engine))
    return pictures


def both(*arguments, **options):
    """channels_of_both() as blocks()."""
    return [blocks(channels) for channels in channels_of_both(*arguments, **options)]


def agrees(theirs, ours, mean=0.02, block=0.05):
    """Noise of both leaves up to `block` in blocks."""
    level = theirs.mean(axis=(0, 1))
    assert level.max() > 0.01
    assert ours.mean(axis=(0, 1)) == pytest.approx(level, rel=mean, abs=mean * float(level.max()))
    assert np.sqrt(((ours - theirs) ** 2).mean(axis=(0, 1))).max() < block * level.max()


def checkered_wall(scene):
    bpy.ops.mesh.primitive_plane_add(size=12.0, location=(0, 0, -2))
    tree = node_comparison.Tree(bpy.context.object)
    checker = tree.add("ShaderNodeTexChecker")
    checker.inputs["Scale"].default_value = 12.0
    tree.emit(checker.outputs["Color"])


def filled(thing, kind, **inputs):
    """The volume node in a material without a surface; returns its tree."""
    tree = node_comparison.Tree(thing)
    node = tree.add(kind)
    for name, value in inputs.items():
        node.inputs[name.replace("_", " ")].default_value = value
    tree.link(node.outputs[0], tree.output.inputs["Volume"])
    return tree


def turned_cube(size=2.0, location=(0, 0, 0)):
    bpy.ops.mesh.primitive_cube_add(size=size, location=location, rotation=(0.5, 0.3, 0.7))
    return bpy.context.object


def orthographic(scene):
    scene_parts.add_camera(scene, (0, 0, 8), ortho_scale=4.0)


ABSORBING = [
    ("ShaderNodeVolumeAbsorption", {"Color": (0.9, 0.4, 0.1, 1.0), "Density": 0.8}),
    ("ShaderNodeEmission", {"Color": (0.9, 0.4, 0.1, 1.0), "Strength": 0.3}),
    (
        "ShaderNodeVolumePrincipled",
        {
            "Color": (0.0, 0.0, 0.0, 1.0),
            "Density": 0.7,
            "Absorption_Color": (0.5, 0.2, 0.1, 1.0),
            "Emission_Color": (0.2, 0.3, 0.9, 1.0),
            "Emission_Strength": 0.4,
        },
    ),
    (
        "ShaderNodeVolumePrincipled",
        {
            "Color": (0.0, 0.0, 0.0, 1.0),
            "Density": 0.7,
            "Blackbody_Intensity": 1.0,
            "Temperature": 1800.0,
            "Blackbody_Tint": (1.0, 0.8, 0.9, 1.0),
        },
    ),
]


@pytest.mark.parametrize("kind, inputs", ABSORBING)
def test_what_absorbs_and_emits(scene, render, kind, inputs):
    """Two that overlap, before a wall.  Colours of black bodies are known within a hundredth."""
    checkered_wall(scene)
    filled(turned_cube(), kind, **inputs)
    filled(turned_cube(1.5, (0.6, 0.4, 0.5)), kind, **inputs)
    orthographic(scene)
    agrees(*both(scene, render, 16), mean=0.01, block=0.02)


@pytest.mark.parametrize(
    "kind, into",
    [("ShaderNodeVolumePrincipled", "Surface"), ("ShaderNodeBsdfPrincipled", "Volume")],
)
def test_what_is_in_the_other_socket_shines_as_in_cycles(scene, render, kind, into):
    checkered_wall(scene)
    tree = node_comparison.Tree(turned_cube())
    node = tree.add(kind)
    node.inputs["Emission Strength"].default_value = 1.0
    color = node.inputs.get("Emission Color") or node.inputs["Emission"]
    color.default_value = (0.8, 0.5, 0.3, 1.0)
    tree.link(node.outputs[0], tree.output.inputs[into])
    orthographic(scene)
    agrees(*both(scene, render, 16), mean=0.01, block=0.02)


def lit_cube(scene, kind="ShaderNodeVolumeScatter", **inputs):
    inputs = {"Color": (0.8, 0.6, 0.4, 1.0), "Density": 0.7, **inputs}
    filled(turned_cube(), kind, **inputs)
    lamp(scene, "POINT", 3000.0, (2.0, 1.0, 2.0), shadow_soft_size=0.3)
    orthographic(scene)


@pytest.mark.parametrize("anisotropy", [0.0, 0.6, -0.4])
def test_light_is_scattered_once(scene, render, anisotropy):
    lit_cube(scene, Anisotropy=anisotropy)
    agrees(*both(scene, render, 256))


@pytest.mark.parametrize("limit", [1, 3, 8])
def test_light_is_scattered_often(scene, render, limit):
    lit_cube(scene, Color=(0.95, 0.8, 0.6, 1.0), Density=2.0)
    agrees(*both(scene, render, 256, bounces=limit, in_volumes=limit), block=0.06)


def smoke_over_a_floor(scene, size, height, density, color):
    """Returns the floor's shader."""
    bpy.ops.mesh.primitive_plane_add(size=8.0)
    floor = node_comparison.Tree(bpy.context.object)
    shader = floor.add("ShaderNodeBsdfDiffuse")
    floor.link(shader.outputs[0], floor.output.inputs["Surface"])
    bpy.ops.mesh.primitive_cube_add(size=size, location=(0, 0, height))
    filled(bpy.context.object, "ShaderNodeVolumeScatter", Color=color, Density=density)
    lamp(scene, "POINT", 300.0, (2.0, 1.0, 2.5), shadow_soft_size=0.1)
    camera = scene_parts.add_camera(scene, (0, -5, 3))
    camera.rotation_euler = (math.radians(60), 0, 0)
    return shader


def test_floors_and_smoke_light_each_other(scene, render):
    shader = smoke_over_a_floor(scene, 1.5, 0.9, 2.0, (0.9, 0.9, 0.9, 1.0))
    shader.inputs["Color"].default_value = (0.8, 0.3, 0.2, 1.0)
    agrees(*both(scene, render, 256, bounces=4, in_volumes=4), block=0.06)


PHASES = [
    ("RAYLEIGH", {}),
    ("DRAINE", {"Anisotropy": 0.5, "Alpha": 2.0}),
    ("DRAINE", {"Anisotropy": -0.3, "Alpha": 0.5}),
    ("FOURNIER_FORAND", {"IOR": 1.33, "Backscatter": 0.1}),
    ("FOURNIER_FORAND", {"IOR": 1.6, "Backscatter": 0.3}),
    ("MIE", {"Diameter": 0.05}),
    ("MIE", {"Diameter": 1.0}),
    ("MIE", {"Diameter": 3.0}),
    ("MIE", {"Diameter": 20.0}),
]


@pytest.mark.skipif(bpy.app.version < (4, 3, 0), reason="these came with Blender 4.3")
@pytest.mark.parametrize("phase, inputs", PHASES)
@pytest.mark.parametrize("height", [2.0, -2.0])
def test_phase_functions(scene, render, phase, inputs, height):
    """Lit from before and from behind."""
    tree = filled(turned_cube(), "ShaderNodeVolumeScatter", Density=0.5)
    node = tree.nodes["Volume Scatter"]
    node.phase = phase
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    lamp(scene, "POINT", 3000.0, (2.0, 1.0, height), shadow_soft_size=0.3)
    orthographic(scene)
    agrees(*both(scene, render, 128))


def test_principled_scatters_light_of_sun_and_world(scene, render):
    filled(turned_cube(), "ShaderNodeVolumePrincipled", Density=1.5, Anisotropy=0.3)
    lamp(scene, "SUN", 3.0, turn=(math.radians(60), 0.0, 0.4))
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.4, 0.8, 1.0)
    orthographic(scene)
    agrees(*both(scene, render, 256))


def test_volumes_shade_what_is_behind_them(scene, render):
    """A floor in the shadow of a cube of smoke: above it, as of faces in one plane Cycles meets either."""
    smoke_over_a_floor(scene, 1.0, 0.8, 1.0, (0.2, 0.5, 0.8, 1.0))
    agrees(*both(scene, render, 256))


def fog(scene, density=0.1):
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    node = tree.nodes.new("ShaderNodeVolumeScatter")
    node.inputs["Density"].default_value = density
    output = next(n for n in tree.nodes if n.type == "OUTPUT_WORLD")
    tree.links.new(node.outputs[0], output.inputs["Volume"])


def spot_in_fog(scene):
    bpy.ops.mesh.primitive_plane_add(size=20.0)
    floor = node_comparison.Tree(bpy.context.object)
    shader = floor.add("ShaderNodeBsdfDiffuse")
    floor.link(shader.outputs[0], floor.output.inputs["Surface"])
    fog(scene)
    lamp(
        scene,
        "SPOT",
        2000.0,
        (0.0, 0.0, 4.0),
        (0.0, 0.4, 0.0),
        spot_size=math.radians(40),
        shadow_soft_size=0.1,
    )
    camera = scene_parts.add_camera(scene, (0, -9, 2))
    camera.rotation_euler = (math.radians(88), 0, 0)


@pytest.mark.parametrize("clip_start", [0.1, 3.0])
def test_fog_shows_the_cone_of_a_spot_lamp(scene, render, clip_start):
    spot_in_fog(scene)
    scene.camera.data.clip_start = clip_start
    agrees(*both(scene, render, 256))


def test_glass_that_absorbs(scene, render):
    checkered_wall(scene)
    thing = turned_cube()
    tree = filled(thing, "ShaderNodeVolumeAbsorption", Color=(0.2, 0.8, 0.5, 1.0), Density=0.9)
    glass = tree.add("ShaderNodeBsdfGlass")
    glass.inputs["Roughness"].default_value = 0.0
    tree.link(glass.outputs[0], tree.output.inputs["Surface"])
    orthographic(scene)
    agrees(*both(scene, render, 256, bounces=8))


@pytest.mark.parametrize("coordinate", ["Generated", "Object"])
def test_density_may_vary(scene, render, coordinate):
    checkered_wall(scene)
    thing = turned_cube()
    tree = filled(thing, "ShaderNodeVolumeAbsorption", Color=(0.2, 0.8, 0.5, 1.0))
    where = tree.add("ShaderNodeTexCoord")
    noise = tree.add("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 3.0
    strong = tree.add("ShaderNodeMath", operation="MULTIPLY")
    strong.inputs[1].default_value = 4.0
    tree.link(where.outputs[coordinate], noise.inputs["Vector"])
    tree.link(noise.outputs["Fac" if "Fac" in noise.outputs else 0], strong.inputs[0])
    tree.link(strong.outputs[0], tree.nodes["Volume Absorption"].inputs["Density"])
    orthographic(scene)
    agrees(*both(scene, render, 64), mean=0.01, block=0.03)


def smoke_of_noise(thing):
    tree = filled(thing, "ShaderNodeVolumePrincipled")
    noise = tree.add("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 2.5
    ramp = tree.add("ShaderNodeMapRange")
    for name, value in (("From Min", 0.4), ("From Max", 0.7), ("To Max", 6.0)):
        ramp.inputs[name].default_value = value
    where = tree.add("ShaderNodeTexCoord")
    tree.link(where.outputs["Object"], noise.inputs["Vector"])
    tree.link(noise.outputs[0], ramp.inputs["Value"])
    tree.link(ramp.outputs[0], tree.nodes["Principled Volume"].inputs["Density"])
    return tree


def test_smoke_of_noise_is_lit(scene, render):
    smoke_of_noise(turned_cube())
    lamp(scene, "POINT", 300.0, (2.0, 1.0, 2.0), shadow_soft_size=0.3)
    orthographic(scene)
    # Both march in steps, of their own: 2.1 % were seen, and .050 in blocks.
    agrees(*both(scene, render, 256), mean=0.03, block=0.06)


def test_what_is_not_read_of_smoke_is_named(scene):
    domain = turned_cube()
    fluid = domain.modifiers.new("Fluid", "FLUID")
    fluid.fluid_type = "DOMAIN"
    fluid.domain_settings.domain_type = "GAS"
    tree = filled(domain, "ShaderNodeVolumePrincipled")
    info = tree.add("ShaderNodeVolumeInfo")
    tree.link(info.outputs["Density"], tree.nodes["Principled Volume"].inputs["Density"])
    scene_parts.add_camera(scene)
    scene.cycles.volume_bounces = 3
    snapshot, report, _ = export_probe.through_engine(scene)
    named = {datablock: message for datablock, message, _ in report.entries()}
    assert "smoke" in named[f"object '{domain.name}'"]
    assert "once, not 4 times" in named["render settings"]
    assert snapshot["materials"][0]["surface"] is None
    assert snapshot["materials"][0]["volume"] is not None


@pytest.mark.parametrize("bounces", [0, 2])
@pytest.mark.parametrize("hidden", ["wall", "world", "world by its nodes", "neither"])
def test_what_is_hidden_from_what_volumes_scatter(scene, render, hidden, bounces):
    """Light of a wall whose emission varies and of the world, in fog, without the one or the other."""
    filled(turned_cube(), "ShaderNodeVolumeScatter", Density=0.6)
    checkered_wall(scene)
    wall = bpy.context.object
    scene.world = bpy.data.worlds.new("World")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    background = next(n for n in scene.world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.2, 0.5, 0.9, 1.0)
    if hidden == "wall":
        # From diffuse rays too, of which there are none: Cycles 3.4 asks for both.  Nor is there a world, of which
        # some that the wall's shadow hides reaches the fog there, as it is sampled.
        wall.visible_volume_scatter = wall.visible_diffuse = False
        background.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    if hidden == "world":
        scene.world.cycles_visibility.scatter = False
    if hidden == "world by its nodes":
        nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
        path, rest = nodes.new("ShaderNodeLightPath"), nodes.new("ShaderNodeMath")
        if "Is Volume Scatter Ray" not in path.outputs:
            pytest.skip("this Blender's Light Path does not tell")
        rest.operation = "SUBTRACT"
        rest.inputs[0].default_value = 1.0
        links.new(path.outputs["Is Volume Scatter Ray"], rest.inputs[1])
        links.new(rest.outputs[0], background.inputs["Strength"])
    orthographic(scene)
    agrees(*both(scene, render, 256, bounces, bounces))


def test_what_is_hidden_from_volumes_is_read(scene):
    things = [turned_cube(location=(x, 0, 0)) for x in (0.0, 3.0)]
    things[0].visible_volume_scatter = False
    scene.world = bpy.data.worlds.new("World")
    scene_parts.add_camera(scene)
    snapshot = export_probe.through_engine(scene)[0]
    instances = snapshot["instances"]
    seen = {
        name: bool(flags & 64)
        for name, flags in zip(instances["name"], instances["flags"], strict=True)
    }
    assert seen == {thing.name: thing is not things[0] for thing in things}
    assert snapshot["world"]["visible_volume"]
    if hasattr(scene.world, "cycles_visibility"):
        scene.world.cycles_visibility.scatter = False
        assert not export_probe.through_engine(scene)[0]["world"]["visible_volume"]
