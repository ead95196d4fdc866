# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own panels that serve Granita as they are.

A panel lists the engines it serves in COMPAT_ENGINES.  Those that Blender marks as generic and
gives to EEVEE too show what an engine that reads Blender's data understands; those that are
generic alone are remains of the engine that Blender once had.  The panels named here
show nothing but common data, too.
"""

import bpy

ENGINE_ID = "GRANITA"

_BY_NAME = {
    "DATA_PT_camera_dof",
    "DATA_PT_camera_dof_aperture",
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_displacement",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_mist",
    "EEVEE_WORLD_PT_surface",
    "MATERIAL_PT_preview",
    "OBJECT_PT_custom_props",
    "RENDER_PT_freestyle",
}

# Generic, but about what Granita does not have.
_NOT_SERVED = {
    "DATA_PT_spot",  # its parent is a panel of other engines; Granita has its own
    "RENDER_PT_output_views",
    "RENDER_PT_stereoscopy",
    "DATA_PT_camera_stereoscopy",
}


def _panels():
    def below(cls):
        for sub in cls.__subclasses__():
            yield sub
            yield from below(sub)

    for panel in below(bpy.types.Panel):
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if not engines or panel.__name__ in _NOT_SERVED:
            continue
        eevee = any(engine.startswith("BLENDER_EEVEE") for engine in engines)
        if panel.__name__ in _BY_NAME or (eevee and "BLENDER_RENDER" in engines):
            yield panel


def register():
    for panel in _panels():
        panel.COMPAT_ENGINES.add(ENGINE_ID)


def unregister():
    for panel in _panels():
        panel.COMPAT_ENGINES.discard(ENGINE_ID)
