# SPDX-License-Identifier: GPL-3.0-or-later
"""Particle systems: hair drawn as paths, and particles drawn as objects and collections."""

import bpy
import stage
import unwalked
from probe import Probe


def _emitter(scene, kind):
    stage.set_world(scene, (0.1, 0.1, 0.1))
    stage.camera(scene)
    stage.add_sun(scene)
    thing = stage.surface(scene, "Emitter", 4, 1.6, 0.4, stage.diffuse("Ground", (0.3, 0.5, 0.3)))
    thing.data.materials.append(stage.glowing("Second", "UV"))
    thing.modifiers.new("Particles", "PARTICLE_SYSTEM")
    system = thing.particle_systems[0]
    settings = system.settings
    settings.type, settings.count = kind, 60
    return thing, system, settings


def _hair(children):
    def build(scene):
        thing, system, settings = _emitter(scene, "HAIR")
        settings.hair_length, settings.render_step = 0.6, 3
        settings.root_radius, settings.tip_radius = 4.0, 1.0
        if children:
            settings.child_type = "INTERPOLATED"
            settings.rendered_child_count = 4
            # Shown in the viewport; Blender 4 renamed it.
            shown = "child_percent" if hasattr(settings, "child_percent") else "child_nbr"
            setattr(settings, shown, 4)
        return {"settings": settings, "system": system, "object": thing, "scene": scene}

    return build


def _objects(render_type):
    def build(scene):
        thing, system, settings = _emitter(scene, "EMITTER")
        settings.frame_start = settings.frame_end = 1.0
        settings.physics_type = "NO"
        settings.lifetime = 10
        # At random, or as many as vertices, Blender puts several at one place.
        settings.use_emit_random, settings.count = False, 20
        cube = stage.add_cube(
            scene, size=0.8, location=(0, 0, 0), material=stage.diffuse("Cube", (0.9, 0.4, 0.2))
        )
        other = stage.add_cube(
            scene, "Other", 0.5, (0, 0, 0), stage.diffuse("Other", (0.2, 0.4, 0.9))
        )
        part = bpy.data.collections.new("Part")
        for member in (cube, other):
            part.objects.link(member)
            scene.collection.objects.unlink(member)
        settings.render_type, settings.particle_size = render_type, 0.25
        if render_type == "OBJECT":
            settings.instance_object = cube
        elif render_type == "COLLECTION":
            settings.instance_collection = part
        scene.frame_set(2)
        return {"settings": settings, "system": system, "object": thing, "scene": scene}

    return build


_PARTICLES = unwalked.names("particles")
_BOTH = unwalked.names("particles", "particle systems")
_WALKED = ("settings", "system")

PROBES = [
    Probe("hair", _hair(False), _WALKED, {}, _BOTH),
    Probe("hair with children", _hair(True), ("settings",), {}, _PARTICLES),
    Probe("particles as objects", _objects("OBJECT"), _WALKED, {}, _BOTH),
    Probe("particles as collections", _objects("COLLECTION"), ("settings",), {}, _PARTICLES),
    Probe("particles as halos", _objects("HALO"), (), {}),
]
