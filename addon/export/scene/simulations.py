# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender cannot move in time as it should, and so is named: simulations that are not baked, cache
files that are missing, drivers that fail."""

import os

_SIMULATED = {"CLOTH", "SOFT_BODY"}


def unbaked(thing):
    """Names of the simulations of an evaluated Object of which Blender has no baked cache: between frames
    it makes states up, and it cannot go back."""
    found = []
    for modifier in thing.modifiers:
        if not modifier.show_render:
            continue
        if modifier.type in _SIMULATED:
            cache = modifier.point_cache
        elif modifier.type == "PARTICLE_SYSTEM" and _is_simulated(modifier.particle_system):
            cache = modifier.particle_system.point_cache
        else:
            continue
        if not cache.is_baked:
            found.append(modifier.name)
    return found


def unbaked_rigid_bodies(scene):
    """Whether a scene has rigid bodies of which Blender has no baked cache."""
    world = scene.rigidbody_world
    if world is None or not world.enabled or world.collection is None:
        return False
    return len(world.collection.objects) > 0 and not world.point_cache.is_baked


def _is_simulated(system):
    if system.settings.type == "HAIR":
        return system.use_hair_dynamics
    return system.settings.physics_type not in {"NO", "KEYED"}


def troubles(thing):
    """Messages about an evaluated Object that stands still where it should not."""
    found = []
    for modifier in thing.modifiers:
        if modifier.type == "MESH_SEQUENCE_CACHE" and modifier.show_render:
            found += _cache_troubles(modifier)
        if modifier.type == "FLUID" and modifier.show_render and _is_smoke(modifier):
            found.append("its grids of smoke and fire are not read: its box is filled evenly")
    # Blender notes a failure on the copy that it evaluated.
    failed = {
        curve.data_path: None
        for animation in (thing.original.animation_data, thing.animation_data)
        if animation is not None
        for curve in animation.drivers
        if not curve.driver.is_valid
    }
    return found + [f"the driver of its {path} fails: the value stays as it was" for path in failed]


def _is_smoke(modifier):
    domain = modifier.domain_settings if modifier.fluid_type == "DOMAIN" else None
    return domain is not None and domain.domain_type == "GAS"


def _cache_troubles(modifier):
    import bpy

    file = modifier.cache_file
    if file is None:
        return [f"its modifier '{modifier.name}' has no cache file"]
    path = bpy.path.abspath(file.filepath, library=file.library)
    if file.is_sequence or os.path.exists(path):
        return []
    return [f"the cache file '{path}' of its modifier '{modifier.name}' is missing"]
