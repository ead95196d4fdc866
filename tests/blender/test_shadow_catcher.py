# SPDX-License-Identifier: GPL-3.0-or-later
"""What is composed into a plate beside Cycles in the same Blender: what shadow catchers lose of their light, as alpha and
as the pass."""

import math

import bpy
import numpy as np
import pytest
import scene_parts
from node_comparison import Tree
from test_volumes import filled

SIZE, BLOCK = 64, 4
DIFFUSE_DIRECT = "Diffuse Direct.R" if bpy.app.version >= (5, 0) else "DiffDir.R"


def shaded_by(thing, kind, **inputs):
    """Gives it a material of one shader, in place of what it had."""
    thing.data.materials.clear()
    tree = Tree(thing)
    shader = tree.add(kind)
    for name, value in inputs.items():
        shader.inputs[name].default_value = value
    tree.link(shader.outputs[0], tree.output.inputs["Surface"])


@pytest.fixture
def plate(scene):
    """A ball on a red floor that catches its shadow, a box half below it, a sun and a sky."""
    bpy.ops.mesh.primitive_plane_add(size=8)
    floor = bpy.context.object
    floor.name, floor.is_shadow_catcher = "Floor", True
    bpy.ops.mesh.primitive_uv_sphere_add(location=(0.0, 0.0, 1.0))
    ball = bpy.context.object
    ball.name = "Ball"
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(2.5, 2.0, -1.2))
    box = bpy.context.object
    for thing, color in ((floor, (0.8, 0.2, 0.2)), (ball, (0.2, 0.8, 0.2)), (box, (0.2, 0.2, 0.8))):
        shaded_by(thing, "ShaderNodeBsdfDiffuse", Color=(*color, 1.0))
    bpy.ops.object.light_add(type="SUN", rotation=(0.6, 0.5, 0.0))
    sun = bpy.context.object
    sun.name, sun.data.energy, sun.data.angle = "Sun", 2.0, 0.2
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.3, 0.4, 0.6, 1.0)
    camera = scene_parts.add_camera(scene, (0.0, -8.0, 5.0))
    camera.rotation_euler, camera.data.lens = (1.05, 0.0, 0.0), 40.0
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.film_transparent = True
    settings, cycles = scene.granita, scene.cycles
    settings.samples, settings.light_samples, settings.bounces = 64, 64, "FULL"
    settings.pixel_filter, settings.filter_width = "BOX", 1.0
    cycles.samples, cycles.pixel_filter_type = 256, "BOX"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    return scene


def channel(made, name):
    return next(values for key, values in made.items() if key.endswith(f".{name}"))


def blocks(values):
    rows = SIZE // BLOCK
    return values.reshape(rows, BLOCK, rows, BLOCK).mean(axis=(1, 3))


def of_both(scene, render, *names):
    """{name: [Cycles, Granita]}, means of blocks."""
    made = {}
    for engine in ("CYCLES", "GRANITA"):
        scene.render.engine = engine
        made[engine] = render(scene, engine)
    return {name: [blocks(channel(made[e], name)) for e in made] for name in names}


def a_lamp_composed_in(_):
    bpy.data.objects["Sun"].is_shadow_catcher = False


def a_glossy_floor(_):
    shaded_by(bpy.data.objects["Floor"], "ShaderNodeBsdfPrincipled", Roughness=0.2)


def a_ball_that_shines(_):
    shaded_by(bpy.data.objects["Ball"], "ShaderNodeEmission", Strength=2.0)


def a_lens(scene):
    lens = scene.camera.data.dof
    lens.use_dof, lens.focus_distance, lens.aperture_fstop = True, 8.0, 0.1


def two_catchers(_):
    box = bpy.data.objects["Cube"]
    box.is_shadow_catcher = True
    box.location, box.scale = (1.5, -0.5, 0.6), (0.5, 0.5, 0.5)


def a_moving_ball(scene):
    scene.render.use_motion_blur = True
    ball = bpy.data.objects["Ball"]
    for frame, x in ((0, -1.0), (2, 1.0)):
        ball.location.x = x
        ball.keyframe_insert("location", frame=frame)
    scene.frame_set(1)


def without_light(scene):
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    bpy.data.objects["Sun"].hide_render = True


def an_instance(scene):
    """The empty that makes it says so, as in Cycles."""
    floor = bpy.data.objects["Floor"]
    floor.is_shadow_catcher = False
    group = bpy.data.collections.new("Set")
    for owner in floor.users_collection:
        owner.objects.unlink(floor)
    group.objects.link(floor)
    empty = scene_parts.add_object(scene, "Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", group
    empty.is_shadow_catcher = True


CHANGES = [
    lambda _: None,
    a_glossy_floor,
    a_ball_that_shines,
    a_lens,
    two_catchers,
    a_moving_ball,
    a_lamp_composed_in,
    without_light,
    an_instance,
]
# Of a pixel that the ball covers in part, or at times, Cycles clamps what pixels have together, and here samples are.
EDGES = {"a_ball_that_shines": 0.06, "a_moving_ball": 0.05, "a_lamp_composed_in": 0.05}


@pytest.mark.parametrize("change", CHANGES)
def test_alpha_is_what_shadows_take(plate, render, change):
    """Noise of both is .003 in blocks; where the ball's edge crosses them .01 more."""
    change(plate)
    made = of_both(plate, render, "Combined.A", "Combined.G")
    theirs, ours = made["Combined.A"]
    assert np.abs(ours - theirs).max() < EDGES.get(change.__name__, 0.03)
    assert ours.mean() == pytest.approx(theirs.mean(), abs=0.002)
    theirs, ours = made["Combined.G"]  # the ball; of the floor and of the box below it nothing
    assert np.abs(ours - theirs).max() < 0.03


@pytest.mark.parametrize("change", CHANGES)
def test_the_pass_is_what_is_left_of_light(plate, render, change):
    """Then Combined shows nothing of catchers.  Blocks that the ball's edge crosses have few samples of the floor."""
    change(plate)
    plate.view_layers[0].cycles.use_pass_shadow_catcher = True
    names = [f"Shadow Catcher.{c}" for c in "RGB"]
    made = of_both(plate, render, "Combined.A", *names)
    theirs, ours = made["Combined.A"]
    assert np.abs(ours - theirs).max() < 0.02
    for name in names:
        theirs, ours = made[name]
        assert np.quantile(np.abs(ours - theirs), 0.97) < 0.02 * theirs.max()
        assert ours.mean() == pytest.approx(theirs.mean(), abs=0.003)


def test_the_world_is_dimmed_by_as_much(plate, render):
    """Where the film shows one: the same picture over it, at edges too, where Cycles dims twice."""
    plate.render.engine = "GRANITA"
    over = render(plate, "transparent")
    plate.render.film_transparent = False
    shown = render(plate, "opaque")
    left = 1.0 - channel(over, "Combined.A")
    for c, world in zip("RGB", (0.3, 0.4, 0.6)):
        expected = channel(over, f"Combined.{c}") + left * world
        assert channel(shown, f"Combined.{c}") == pytest.approx(expected, abs=1e-5)
    assert channel(shown, "Combined.A").min() == 1.0


def an_endless_fog(scene):
    """Nothing of the world comes through."""
    tree = scene.world.node_tree
    fog = tree.nodes.new("ShaderNodeVolumeScatter")
    fog.inputs["Density"].default_value = 0.02
    tree.links.new(fog.outputs[0], tree.nodes["World Output"].inputs["Volume"])


def cloud(scene, height):
    bpy.ops.mesh.primitive_cube_add(size=3.0, location=(-2.0, 2.0, height))
    smoke = {"Color": (0.2, 0.5, 0.8, 1.0), "Density": 0.5}
    filled(bpy.context.object, "ShaderNodeVolumeAbsorption", **smoke)


def a_cloud_above(scene):
    cloud(scene, 2.0)


def a_cloud_below(scene):
    cloud(scene, -2.0)


def a_lamp_in_fog(scene):
    an_endless_fog(scene)
    bpy.ops.object.light_add(type="POINT", location=(0.0, -2.0, 3.0))
    bpy.context.object.data.energy = 500.0


@pytest.mark.parametrize("change", [a_lamp_in_fog, a_cloud_above, a_cloud_below])
def test_volumes_before_them_dim_them(plate, render, change):
    """Those behind do not, as in Cycles.  Blocks near the lamp in fog have noise; there Cycles' catchers are more opaque
    than fog and shadow make them (alpha .55 where 7 m of it have .13)."""
    change(plate)
    channels = "RGB" if change is a_lamp_in_fog else "RGBA"
    made = of_both(plate, render, *(f"Combined.{c}" for c in channels))
    # Two blocks touch the lamp, and are noise in Blender 5.2.
    rank = 0.99 if change is a_lamp_in_fog and bpy.app.version >= (5, 2) else 1.0
    for name, (theirs, ours) in made.items():
        assert np.quantile(np.abs(ours - theirs), rank) < 0.06, name
        assert ours.mean() == pytest.approx(theirs.mean(), abs=0.002), name


def test_no_world_shines_through_endless_fog(plate, render):
    """Neither beside them nor on them."""
    an_endless_fog(plate)
    plate.render.film_transparent = False
    for theirs, ours in of_both(plate, render, "Combined.R", "Combined.B").values():
        assert not theirs.any() and not ours.any()


def test_other_passes_show_no_light_of_catchers(plate, render):
    plate.view_layers[0].use_pass_diffuse_direct = True
    theirs, ours = of_both(plate, render, DIFFUSE_DIRECT)[DIFFUSE_DIRECT]
    assert np.quantile(np.abs(ours - theirs), 0.97) < 0.02
    assert np.median(ours) == 0.0 < ours.max()


def test_what_reflects_them_sees_their_surface(plate, render):
    shaded_by(bpy.data.objects["Ball"], "ShaderNodeBsdfGlossy", Roughness=0.0)
    theirs, ours = of_both(plate, render, "Combined.R")["Combined.R"]
    assert math.isclose(ours.mean(), theirs.mean(), rel_tol=0.03)
    assert ours[9].max() > 0.1  # the red floor below its middle


def test_wires_cast_all_of_their_shadow(plate, render):
    """A sixth of a pixel thick, under a hard sun without blue: alpha was 16 % too low, in dashes."""
    for thing in [o for o in plate.objects if o.type == "MESH" and o.name != "Floor"]:
        bpy.data.objects.remove(thing)
    sun = bpy.data.objects["Sun"]
    sun.data.angle, sun.rotation_euler = 0.0, (0.0, 0.0, 0.0)
    sun.data.color = (1.0, 0.8, 0.0)
    camera = plate.camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", 6.4
    camera.location, camera.rotation_euler = (0.0, 0.0, 9.0), (0.0, 0.0, 0.0)
    width, every = 0.1 / 6, 0.61
    for i in range(13):
        place = ((i - 6) * every, 0.0, 3.0)
        bpy.ops.mesh.primitive_cube_add(location=place, rotation=(0.0, 0.0, 0.13))
        wire = bpy.context.object
        wire.scale, wire.visible_camera = (width / 2, 5.0, width / 2), False
    plate.cycles.max_bounces = 0
    plate.granita.bounces, plate.cycles.samples = "NONE", 1024
    theirs, ours = of_both(plate, render, "Combined.A")["Combined.A"]
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.03)
