# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves, hair and points: what is seen of them, against Cycles with ribbons.

Coverage in blocks of 8 by 8 pixels (cycles_coverage, where the limits come from).
"""

import bpy
import numpy as np
import pytest
import scene_parts
from cycles_coverage import SAMPLES, blurred, expect_coverage_of_cycles
from hair_parts import curve_through, furry, give_material, grid_points, spiral_curves
from motion_parts import drive, open_shutter
from node_comparison import Tree, render_both


def curves(scene):
    scene_parts.add_camera(scene, (0, -5, 2.5)).rotation_euler.x = 1.15
    spiral_curves(scene)


def curves_default_radius(scene):
    scene_parts.add_camera(scene, (0, -0.6, 0.6), ortho_scale=0.9).rotation_euler.x = 0.8
    spiral_curves(scene, radius=None)


def flattened_curves(scene):
    curves(scene)
    scene.objects["Curves"].scale = (1.0, 1.0, 0.2)


def narrowed_curves(scene):
    curves(scene)
    scene.objects["Curves"].scale = (0.2, 1.0, 1.0)


def sheared_moving_curves(scene):
    """Turned under a parent that is scaled along one axis."""
    moving_curves(scene)
    parent = scene_parts.add_object(scene, "Parent", None)
    parent.scale = (1.0, 0.3, 1.0)
    scene.objects["Curves"].parent = parent


def moving_curves(scene):
    scene_parts.add_camera(scene, (0, -5, 2.5)).rotation_euler.x = 1.15
    curves = spiral_curves(scene)
    curves.scale = (0.5, 0.5, 0.5)
    drive(curves, "location", "(frame - 10) / 2", 0)
    drive(curves, "rotation_euler", "(frame - 10) / 3", 2)


def hair(scene):
    scene_parts.add_camera(scene, (0, -5, 3)).rotation_euler.x = 1.0
    furry(scene, shape=0.3)


def hair_of_children(scene):
    scene_parts.add_camera(scene, (0, -5, 3)).rotation_euler.x = 1.0
    kinky = {"kink": "SPIRAL", "kink_amplitude": 0.1, "kink_frequency": 3.0}
    settings = {"child_type": "INTERPOLATED", "rendered_child_count": 10, "use_close_tip": False}
    furry(scene, count=20, shape=-0.5, brownian_factor=0.02, **settings, **kinky)


def moving_hair(scene):
    scene_parts.add_camera(scene, (0, -5, 3)).rotation_euler.x = 1.0
    thing = furry(scene, count=40, use_close_tip=False)
    thing.show_instancer_for_render = False
    thing.rotation_euler.x = 0.4
    drive(thing, "location", "(frame - 10) / 2", 0)


def points(scene):
    scene_parts.add_camera(scene, (0, -5, 4)).rotation_euler.x = 0.9
    grid_points(scene)


def moving_points(scene):
    scene_parts.add_camera(scene, (0, 0, 8))
    drive(grid_points(scene), "location", "frame - 10", 1)


@pytest.mark.parametrize(
    "build",
    [
        curves,
        curves_default_radius,
        flattened_curves,
        narrowed_curves,
        sheared_moving_curves,
        moving_curves,
        hair,
        hair_of_children,
        moving_hair,
        points,
        moving_points,
    ],
)
def test_coverage_is_that_of_cycles(scene, render, build):
    blurred(scene)
    build(scene)
    scene.cycles_curves.shape = "RIBBONS"
    scene.cycles_curves.subdivisions = 5
    expect_coverage_of_cycles(scene, render, least=0.01)


def test_shading_is_that_of_cycles(scene, render):
    """Rounded ribbons in the light of a sun from the side, without shadows: means of colour."""
    scene_parts.add_camera(scene, (0, -5, 2.5)).rotation_euler.x = 1.15
    thing = spiral_curves(scene, radius=0.08)
    give_material(thing, scene_parts.matte())
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy = 2.0
    scene_parts.cast_no_shadow(sun)
    scene_parts.add_object(scene, "Sun", sun).rotation_euler = (0.6, 0.9, 0.0)
    scene.render.film_transparent = True
    scene.granita.samples = scene.cycles.samples = SAMPLES
    scene.cycles.max_bounces = 0
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles_curves.shape = "RIBBONS"
    means = []
    for engine in ("GRANITA", "CYCLES"):
        scene.render.engine = engine
        passes = render(scene, engine)
        color = next(values for key, values in passes.items() if key.endswith("Combined.R"))
        alpha = next(values for key, values in passes.items() if key.endswith("Combined.A"))
        means.append(color.sum() / alpha.sum())
    # Since Blender 5 Cycles draws the pieces of a polyline as cones (here a hundredth more), whatever the shape.
    assert abs(means[0] / means[1] - 1.0) < (0.02 if bpy.app.version < (5, 0, 0) else 0.03), means


@pytest.mark.parametrize("child_type", ["NONE", "INTERPOLATED"])
def test_hairs_have_the_texture_space_of_what_they_stand_on(scene, render, child_type):
    """Generated is one place a hair, its root's; in the box of the hairs themselves it was elsewhere."""
    scene_parts.add_camera(scene, (0, -5, 2.5)).rotation_euler.x = 1.15
    thing = furry(scene, child_type=child_type, root_radius=0.03)
    tree = Tree(thing)
    emission, place = tree.add("ShaderNodeEmission"), tree.add("ShaderNodeTexCoord")
    tree.link(place.outputs["Generated"], emission.inputs["Color"])
    tree.link(emission.outputs[0], tree.output.inputs["Surface"])
    scene.cycles_curves.shape = "RIBBONS"
    scene.render.film_transparent = True
    theirs, ours = (
        picture.reshape(-1, 4).sum(axis=0)
        for picture in render_both(scene, render, samples=64, channels="RGBA")
    )
    assert ours / ours[3] == pytest.approx(theirs / theirs[3], abs=0.01)


@pytest.mark.parametrize("build", [spiral_curves, grid_points])
def test_shadows_are_those_of_cycles(scene, render, build):
    """On a floor that the camera sees from above, of moving things: means of colour in blocks."""
    scene_parts.add_camera(scene, (0, 0, 8), ortho_scale=6.0)
    scene_parts.add_square(scene, "Floor", 8.0, (0, 0, -0.7), scene_parts.matte())
    thing = build(scene)
    give_material(thing, scene_parts.matte())
    drive(thing, "location", "(frame - 10) / 2", 0)
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 2.0, 0.0
    scene_parts.add_object(scene, "Sun", sun).rotation_euler = (0.5, 0.6, 0.0)
    open_shutter(scene, 1.0)
    scene.granita.samples = scene.cycles.samples = SAMPLES
    scene.granita.pixel_filter, scene.granita.filter_width = "BOX", 1.0
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1.0
    scene.cycles.max_bounces = 0
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles_curves.shape = "RIBBONS"
    blocks = []
    for engine in ("GRANITA", "CYCLES"):
        scene.render.engine = engine
        passes = render(scene, engine)
        color = next(values for key, values in passes.items() if key.endswith("Combined.R"))
        height, width = color.shape
        blocks.append(color.reshape(height // 8, 8, width // 8, 8).mean(axis=(1, 3)))
    ours, theirs = blocks
    lit = np.quantile(theirs, 0.95)
    assert theirs.min() < 0.9 * lit  # there are shadows
    print(
        "RMS",
        build.__name__,
        np.sqrt(((ours - theirs) ** 2).mean()) / lit,
        ours.mean() / theirs.mean(),
    )
    assert abs(ours.mean() / theirs.mean() - 1.0) < 0.01
    assert np.sqrt(((ours - theirs) ** 2).mean()) < 0.02 * lit


def test_points_that_stay_spheres_under_uneven_scale_are_named(scene, render, capfd):
    points(scene)
    cloud = next(thing for thing in scene.objects if thing.type == "MESH")
    render(scene)
    assert "stay spheres" not in capfd.readouterr().out
    cloud.scale = (1.0, 0.4, 1.0)
    render(scene)
    assert f"object '{cloud.name}': is scaled unevenly" in capfd.readouterr().out


@pytest.mark.parametrize("turn", [(0.9, 0.2, 0.0), (0.2, 1.0, 0.0), (2.6, 0.3, 0.0)])
@pytest.mark.parametrize("width", [0.3, 0.8, 2.0, 8.0])
def test_principled_hair_of_any_width_is_as_bright(scene, render, width, turn):
    """Mean over ribbons that many pixels wide, under a sun from before, from a side, from behind."""
    hairs = [strand(scene, k, 0.5 * width * 4.0 / 64) for k in range(5)]
    for thing in hairs:
        tree = Tree(thing, thing.name)
        shader = tree.add("ShaderNodeBsdfHairPrincipled", parametrization="ABSORPTION")
        shader.inputs["Absorption Coefficient"].default_value = (0.0, 0.3, 1.0)
        tree.link(shader.outputs[0], tree.output.inputs["Surface"])
        give_material(thing, tree.material)
    scene_parts.add_camera(scene, ortho_scale=4.0)
    sun_of(scene, turn)
    # From behind Cycles' rays meet the next segment of the hair that they leave: some light is lost at its ends.
    agree_in_mean(scene, render, 0.15 if turn[0] > 2.0 else 0.05)


def strand(scene, k, radius):
    x = -1.6 + 0.787 * k  # at 5 places of a pixel
    return curve_through(
        scene, [(x, y, 0.0) for y in np.linspace(-1.5, 1.5, 9)], radius, f"Strand{k}"
    )


def sun_of(scene, turn):
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = 3.0, 0.0
    scene_parts.add_object(scene, "Sun", light).rotation_euler = turn


def agree_in_mean(scene, render, limit=0.05):
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.cycles_curves.shape = "RIBBONS"
    scene.cycles.light_sampling_threshold = 0.0
    theirs, ours = (p.mean(axis=(0, 1)) for p in render_both(scene, render, samples=64))
    assert ours == pytest.approx(theirs, rel=limit)


@pytest.mark.parametrize("linked", [False, True])
def test_principled_hair_is_random_by_itself(scene, render, linked):
    """As if Random were linked to that of Hair Info."""
    thing = furry(scene, count=400, root_radius=0.05)
    thing.show_instancer_for_render = False
    tree = Tree(thing)
    hair = tree.add("ShaderNodeBsdfHairPrincipled", parametrization="MELANIN")
    hair.inputs["Melanin"].default_value = 0.4
    hair.inputs["Random Color"].default_value = 0.9
    hair.inputs["Random Roughness"].default_value = 0.5
    tree.link(hair.outputs[0], tree.output.inputs["Surface"])
    if linked:
        tree.link(tree.add("ShaderNodeHairInfo").outputs["Random"], hair.inputs["Random"])
    sun_of(scene, (0.9, 0.2, 0.0))
    scene_parts.add_camera(scene, (0, -5, 1), ortho_scale=3.0).rotation_euler.x = 1.3
    agree_in_mean(scene, render)


@pytest.mark.parametrize("scale", [(1.0, 0.4, 1.0), (0.5, 1.0, 1.0)])
def test_hair_under_uneven_scale_is_lit_alike(scene, render, scale):
    """Normals of its tubes are those of ellipses."""
    thing = furry(scene, count=60, root_radius=0.12, tip_radius=0.03)
    thing.show_instancer_for_render = False
    thing.visible_shadow = False
    thing.scale = scale
    thing.data.materials.append(scene_parts.matte())
    sun_of(scene, (0.9, 0.5, 0.6))
    scene_parts.add_camera(scene, (0, -5, 1), ortho_scale=3.0).rotation_euler.x = 1.3
    agree_in_mean(scene, render, 0.02)


@pytest.mark.parametrize("kind", ["Diffuse", "Principled"])
@pytest.mark.parametrize("count", [40, 400])
def test_hairs_shade_each_other_alike(scene, render, count, kind):
    """By parts of their width: rays start beside the place that is seen, and no farther than the hair itself."""
    thing = furry(scene, count=count, root_radius=0.05)
    lit_from_above(scene, thing, kind)
    agree_in_mean(scene, render, 0.01)


def test_thin_rough_hair_is_as_bright(scene, render):
    """What it absorbs varies over its width, though its lobes are wide."""
    thing = furry(scene, count=200, root_radius=0.01, tip_radius=0.01)
    thing.visible_shadow = False
    lit_from_above(scene, thing, "Principled")
    agree_in_mean(scene, render, 0.015)


def lit_from_above(scene, thing, kind):
    """Rough hair alone, without what it grows on."""
    thing.show_instancer_for_render = False
    tree = Tree(thing)
    if kind == "Principled":
        shader = tree.add("ShaderNodeBsdfHairPrincipled", parametrization="MELANIN")
        shader.inputs["Melanin"].default_value = 0.4
        shader.inputs["Roughness"].default_value = shader.inputs[
            "Radial Roughness"
        ].default_value = 0.8
    else:
        shader = tree.add("ShaderNodeBsdfDiffuse")
    tree.link(shader.outputs[0], tree.output.inputs["Surface"])
    sun_of(scene, (0.9, 0.2, 0.0))
    scene_parts.add_camera(scene, (0, -5, 1), ortho_scale=3.0).rotation_euler.x = 1.3
