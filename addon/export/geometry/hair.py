# SPDX-License-Identifier: GPL-3.0-or-later
"""Particle systems drawn as paths -> curves."""

from functools import partial

import numpy as np

from ..base.snapshot import Attribute, Geometry
from .hair_points import HairPoints, flat_floats, particle_range, read_hair_points
from .hair_width import hair_radii, widths


def hair_systems(thing, mode):
    """Names of the particle systems of an evaluated object that are rendered as paths.

    Args:
        thing: evaluated Object.
        mode: of the depsgraph, "RENDER" or "VIEWPORT".
    """
    shown = "show_render" if mode == "RENDER" else "show_viewport"
    return [
        modifier.particle_system.name
        for modifier in thing.modifiers
        if modifier.type == "PARTICLE_SYSTEM"
        and getattr(modifier, shown)
        and modifier.particle_system.settings.type == "HAIR"
        and modifier.particle_system.settings.render_type == "PATH"
    ]


def hair_material(thing, name):
    """The Material that a system's hairs have, or None."""
    slots = thing.material_slots
    if not slots:
        return None
    index = thing.particle_systems[name].settings.material - 1
    return slots[min(max(index, 0), len(slots) - 1)].material


def read_hair(thing, name, label, mode, report):
    """One geometry with one knot, in the object's space.

    Args:
        thing: evaluated Object.
        name: of its particle system.
        label: for messages.
        mode: of the depsgraph, "RENDER" or "VIEWPORT".
        report: called with (datablock, message).

    Returns:
        (Geometry, HairPoints), or None where there is no hair.
    """
    settings = thing.particle_systems[name].settings
    read = partial(read_hair_points, name=name, mode=mode)
    points, sizes = read(thing, None)
    if len(sizes) == 0:
        return None
    geometry = Geometry(
        name=label,
        kind="CURVES",
        points=points[None],
        curve_sizes=sizes,
        radius=hair_radii(settings, points.reshape(len(sizes), -1, 3)).reshape(1, -1),
        attributes=_root_uvs(thing, name, len(sizes), mode),
    )
    return geometry, HairPoints(
        sizes, read, points, widths(settings), settings.animation_data is not None, name, mode
    )


def _root_uvs(thing, name, count, mode):
    """The emitter's active UV map where each hair stands."""
    mesh = thing.data
    if not getattr(mesh, "uv_layers", None):
        return []
    system = thing.particle_systems[name]
    modifier = next(
        m for m in thing.modifiers if m.type == "PARTICLE_SYSTEM" and m.particle_system.name == name
    )
    active = next(i for i, layer in enumerate(mesh.uv_layers) if layer.active_render)
    first, last = particle_range(system, mode)
    parents = len(system.particles)
    # A child says where it stands by itself; a parent is told apart by its own data.
    places = (
        system.uv_on_emitter(
            modifier,
            particle=system.particles[min(particle, parents - 1)],
            particle_no=particle,
            uv_no=active,
        )
        for particle in range(first, last)
    )
    values = flat_floats(places, 2 * count).astype(np.float32).reshape(count, 2)
    return [Attribute(mesh.uv_layers[active].name, "FACE", "UV", values)]
