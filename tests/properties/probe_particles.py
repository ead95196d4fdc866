# SPDX-License-Identifier: GPL-3.0-or-later
"""Particle systems: hair drawn as paths, and particles drawn as objects and collections."""

import bpy
import stage
from probe import Probe

# Of simulation and editing: Blender evaluates them, both engines are given what comes out.
PARTICLES_UNREAD = frozenset(
    """active_texture_index adaptive_angle adaptive_pix adaptive_subframes angular_velocity_factor angular_velocity_mode
    apply_effector_to_children apply_guide_to_children bending_random boids brownian_factor collision_collection
    courant_target damping display_color display_method display_percentage display_size display_step drag_factor
    effect_hair effector_amount factor_random force_field_1 force_field_2 fluid integrator keyed_loops keys_step
    is_fluid lifetime lifetime_random mass normal_factor object_align_factor object_factor particle_factor path_end
    path_start phase_factor phase_factor_random react_event rotation_factor_random rotation_mode show_guide_hairs
    show_hair_grid show_health show_number show_size show_unborn show_velocity subframes tangent_factor
    tangent_phase time_tweak timestep trail_count use_adaptive_subframes use_advanced_hair use_die_on_collision
    use_dynamic_rotation use_multiply_size_mass use_react_multiple use_react_start_end use_regrow_hair
    use_self_effect use_size_deflect drag effector_weights""".split()
)


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


_SYSTEM_UNREAD = frozenset(
    {
        "seed",
        "child_seed",
        "use_emit_random",
        "settings",
        "reactor_target_object",
        "use_hair_dynamics",
    }
)
_WALKED = ("settings", "system")

PROBES = [
    Probe("hair", _hair(False), _WALKED, {}, PARTICLES_UNREAD | _SYSTEM_UNREAD),
    Probe("hair with children", _hair(True), ("settings",), {}, PARTICLES_UNREAD),
    Probe(
        "particles as objects", _objects("OBJECT"), _WALKED, {}, PARTICLES_UNREAD | _SYSTEM_UNREAD
    ),
    Probe("particles as collections", _objects("COLLECTION"), ("settings",), {}, PARTICLES_UNREAD),
    Probe("particles as halos", _objects("HALO"), (), {}),
]
