# SPDX-License-Identifier: GPL-3.0-or-later
"""Light scattered below surfaces that mirrors show or other light meets, beside Cycles in the same Blender."""

import math

import bpy
import numpy as np
import pytest
import scene_parts
from bounced_parts import look_at_stage, render_bounced, surface
from mathutils import Vector
from test_subsurface import lamp, methods

COLOR, RADIUS = (0.8, 0.6, 0.4), (0.3, 0.15, 0.08)


def waxen(thing, method):
    surface(thing, "ShaderNodeSubsurfaceScattering", COLOR, Scale=1.0, Radius=RADIUS)
    tree = thing.material_slots[0].material.node_tree
    next(n for n in tree.nodes if n.type == "SUBSURFACE_SCATTERING").falloff = method
    return thing


def box(size, place=(0.0, 0.0, 0.0), wall=0.0):
    """`wall`: of a hollow one, its thickness."""
    bpy.ops.mesh.primitive_cube_add(size=1.0, scale=size, location=place)
    thing = bpy.context.object
    if wall:
        solid = thing.modifiers.new("Solidify", "SOLIDIFY")
        solid.thickness, solid.offset = wall, -1.0
    return thing


def mirrored(scene, method):
    """A sheet lit from behind and a ball, in a mirror behind them."""
    waxen(box((1.6, 0.06, 1.6), (-0.6, 0.2, 0.0)), method)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=(1.0, 0.2, 0.0))
    waxen(bpy.context.object, method)
    mirror = scene_parts.add_square(scene, "Mirror", 6.0, (0.0, 2.5, 0.0))
    mirror.rotation_euler = (math.pi / 2, 0.0, 0.0)
    surface(mirror, "ShaderNodeBsdfGlossy", (0.9, 0.9, 0.9), Roughness=0.0)
    lamp(scene, "POINT", 600.0, (0.0, -2.0, 6.0), shadow_soft_size=0.1)
    scene.cycles.caustics_reflective = False  # the lamp's, over the mirror, is noise in both
    look_at_stage(scene, 0.9, 0.0)


def lantern(scene, method):
    """A shade of wax around a lamp, which lights a floor."""
    waxen(box((0.8, 0.8, 1.0), wall=0.06), method)
    floor = scene_parts.add_square(scene, "Floor", 8.0, (0.0, 0.0, -0.6))
    surface(floor, "ShaderNodeBsdfDiffuse", (0.7, 0.7, 0.7))
    lamp(scene, "POINT", 100.0, shadow_soft_size=0.1)
    look_at_stage(scene, 2.0, -0.2)


def hollow(scene, method):
    """Lit by the sun from behind."""
    waxen(box((1.6, 1.6, 1.6), wall=0.2), method)
    towards = Vector((-1.0, 2.0, 1.0)).to_track_quat("Z", "Y").to_euler()
    lamp(scene, "SUN", 5.0, turn=towards)
    look_at_stage(scene, 1.0, 0.0)


@pytest.mark.parametrize("make", [mirrored, lantern, hollow])
@pytest.mark.parametrize("method", methods())
def test_light_is_scattered_where_ways_land(scene, render, make, method):
    """Cycles 5 does for diffuse ways as well, those before for mirrors' alone: drawn as diffuse, floors that lanterns light
    were up to 2.1 times too bright and the inside of hollow bodies had a fifth.  Bounds are noise, and inversions of the
    albedo: they part by a hundredth, and by three where light has passed two walls (Cycles' own before 5.2's Random Walk)."""
    make(scene, method)
    both = render_bounced(scene, render, 256)
    theirs, ours = (image.reshape(12, 4, 16, 4, 3).mean(axis=(1, 3)) for image in both)
    level = theirs.mean(axis=(0, 1))
    assert ours.mean(axis=(0, 1)) == pytest.approx(level, rel=0.05, abs=0.02 * float(level.max()))
    assert (np.abs(ours - theirs).mean(axis=(0, 1)) < 0.2 * level).all()


def test_probes_reach_as_far_as_the_channel_that_was_drawn(scene, render):
    """Probes of Burley's profile: what passes a block of the widest channel alone was half as much again as in Cycles."""
    hollow(scene, "BURLEY")
    block = next(thing for thing in scene.objects if thing.type == "MESH")
    block.modifiers.clear()
    block.scale.y *= 0.125
    theirs, ours = (image.mean() for image in render_bounced(scene, render, 1024, bounces="NONE"))
    assert ours == pytest.approx(theirs, rel=0.04)
