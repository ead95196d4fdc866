# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of passes, and what uses it: registration, the export and the hand-over of tiles."""

from collections import namedtuple

import bpy
import numpy as np

from .export.shading.world import world_of

# `native`: the name in the snapshot and in the native tile; Blender's own since version 5.
# `short`: Blender's name before.  `wanted`: the property of the view layer, or of Cycles' settings of
# it, that asks for the pass (None: always there).
Pass = namedtuple("Pass", "native short channels channel_ids kind wanted")

PASSES = (
    Pass("Combined", "Combined", 4, "RGBA", "COLOR", None),
    Pass("Depth", "Depth", 1, "Z", "VALUE", "use_pass_z"),
    Pass("Mist", "Mist", 1, "Z", "VALUE", "use_pass_mist"),
    Pass("Vector", "Vector", 4, "XYZW", "VECTOR", "use_pass_vector"),
    Pass("Position", "Position", 3, "XYZ", "VECTOR", "use_pass_position"),
    Pass("Normal", "Normal", 3, "XYZ", "VECTOR", "use_pass_normal"),
    Pass("UV", "UV", 3, "UVA", "VECTOR", "use_pass_uv"),
    Pass("Object Index", "IndexOB", 1, "X", "VALUE", "use_pass_object_index"),
    Pass("Material Index", "IndexMA", 1, "X", "VALUE", "use_pass_material_index"),
    Pass("Diffuse Direct", "DiffDir", 3, "RGB", "COLOR", "use_pass_diffuse_direct"),
    Pass("Diffuse Indirect", "DiffInd", 3, "RGB", "COLOR", "use_pass_diffuse_indirect"),
    Pass("Diffuse Color", "DiffCol", 3, "RGB", "COLOR", "use_pass_diffuse_color"),
    Pass("Glossy Direct", "GlossDir", 3, "RGB", "COLOR", "use_pass_glossy_direct"),
    Pass("Glossy Indirect", "GlossInd", 3, "RGB", "COLOR", "use_pass_glossy_indirect"),
    Pass("Glossy Color", "GlossCol", 3, "RGB", "COLOR", "use_pass_glossy_color"),
    Pass("Transmission Direct", "TransDir", 3, "RGB", "COLOR", "use_pass_transmission_direct"),
    Pass("Transmission Indirect", "TransInd", 3, "RGB", "COLOR", "use_pass_transmission_indirect"),
    Pass("Transmission Color", "TransCol", 3, "RGB", "COLOR", "use_pass_transmission_color"),
    Pass("Volume Direct", "VolumeDir", 3, "RGB", "COLOR", "use_pass_volume_direct"),
    Pass("Volume Indirect", "VolumeInd", 3, "RGB", "COLOR", "use_pass_volume_indirect"),
    Pass("Emission", "Emit", 3, "RGB", "COLOR", "use_pass_emit"),
    Pass("Environment", "Env", 3, "RGB", "COLOR", "use_pass_environment"),
    Pass("Shadow", "Shadow", 3, "RGB", "COLOR", "use_pass_shadow"),
    Pass("Shadow Catcher", "Shadow Catcher", 3, "RGB", "COLOR", "use_pass_shadow_catcher"),
    *(
        Pass(name, name, *shape, "denoising_store_passes")
        for name, shape in (
            ("Denoising Normal", (3, "XYZ", "VECTOR")),
            ("Denoising Albedo", (3, "RGB", "COLOR")),
            ("Denoising Depth", (1, "Z", "VALUE")),
        )
    ),
)

# The properties that ask for them.
SERVED = frozenset(p.wanted for p in PASSES)

# Passes of light, which the film's exposure multiplies.
EXPOSED = {
    "Combined",
    "Diffuse Direct",
    "Diffuse Indirect",
    "Glossy Direct",
    "Glossy Indirect",
    "Transmission Direct",
    "Transmission Indirect",
    "Volume Direct",
    "Volume Indirect",
    "Emission",
    "Environment",
}

# Passes that show another's numbers.
_SOURCES = {"Denoising Depth": "Depth"}

# Blender's depth where there is no surface.
NO_SURFACE_DEPTH = 1e10


def display_name(p):
    """The name that this Blender gives the pass."""
    return p.native if bpy.app.version >= (5, 0, 0) else p.short


def standard(view_layer):
    """Passes of the table that the view layer asks for."""
    owners = (view_layer, getattr(view_layer, "cycles", None))
    return [
        p
        for p in PASSES
        if p.wanted is None or any(getattr(owner, p.wanted, False) for owner in owners)
    ]


def custom(view_layer):
    """AOVs of the view layer as passes.  Blender marks invalid those whose names collide."""
    made = []
    for aov in view_layer.aovs:
        if not aov.is_valid:
            continue
        value = aov.type == "VALUE"
        shape = (1, "X", "VALUE") if value else (4, "RGBA", "COLOR")
        made.append(Pass(aov.name, aov.name, *shape, None))
    return made


def wanted(view_layer):
    """All passes that are made for a view layer."""
    return standard(view_layer) + custom(view_layer)


# Not passes of their own: the beauty, and how exact Cryptomatte is.
_NO_PASSES = {"use_pass_combined", "use_pass_cryptomatte_accurate"}
# Passes of Cycles' add-on that are not named so.
_OF_CYCLES = {"pass_debug_sample_count", "pass_render_time"}


def missing(view_layer):
    """Names of what a view layer asks for beside the table: it is not made."""
    served = SERVED | _NO_PASSES
    cycles = getattr(view_layer, "cycles", None)
    found = []
    for owner, others in ((view_layer, set()), (cycles, _OF_CYCLES)):
        for rna in owner.bl_rna.properties if owner is not None else ():
            name = rna.identifier
            asked = name.startswith("use_pass_") and name not in served or name in others
            if asked and getattr(owner, name):
                found.append(f"'{rna.name}'")
    groups = [f"of light group '{group.name}'" for group in getattr(view_layer, "lightgroups", ())]
    return found + groups


def requested(scene, view_layer, alone=None):
    """The snapshot's options of passes: of one Pass `alone`, else of all that the view layer asks for."""
    asked = wanted(view_layer) if alone is None else [alone]
    world = world_of(scene, view_layer)
    falloff = {"QUADRATIC": 2.0, "LINEAR": 1.0, "INVERSE_QUADRATIC": 0.5}
    options = {
        "passes": [_SOURCES.get(p.native, p.native) for p in asked if p in PASSES],
        "aovs": [
            {"name": p.native, "kind": "VALUE" if p.channels == 1 else "COLOR"}
            for p in asked
            if p not in PASSES
        ],
        "pass_alpha_threshold": view_layer.pass_alpha_threshold,
    }
    if world is not None:
        mist = world.mist_settings
        values = (mist.start, mist.depth, falloff[mist.falloff])
        options["mist"] = np.array(values, dtype=np.float32)
    return options


def register(engine, scene, view_layer):
    """Every pass is registered, standard ones too: else the result holds Combined alone."""
    for p in wanted(view_layer):
        engine.register_pass(scene, view_layer, display_name(p), p.channels, p.channel_ids, p.kind)


def is_exposed(p):
    """Whether the film's exposure multiplies a Pass."""
    return p in PASSES and p.native in EXPOSED


def exposure_owner(scene):
    """Whose `film_exposure` counts: Cycles' settings where its add-on is enabled, so that a file looks the
    same in both, else Granita's own."""
    cycles = getattr(scene, "cycles", None)
    return cycles if hasattr(cycles, "film_exposure") else scene.granita


def tile_arrays(tile):
    """{native name: pixels} of all passes of a tile."""
    arrays = {"Combined": tile.combined, **tile.passes}
    if tile.depth is not None:
        depth = np.where(np.isfinite(tile.depth), tile.depth, NO_SURFACE_DEPTH)
        for name in ("Depth", *_SOURCES):
            arrays.setdefault(name, depth)  # an AOV may have the name of what is not asked for
    return arrays


def shown_pixels(tile, name):
    """float32 [h, w, 4]: a pass of a tile as a picture, single numbers in grey."""
    if name == "Combined":
        return tile.combined
    values = tile.passes[name]
    height, width = tile.combined.shape[:2]
    pixels = np.ones((height, width, 4), dtype=np.float32)
    pixels[..., :3] = values.reshape(height, width, -1)[..., :3]
    return pixels


def deliver(engine, tile, passes, layer, origin, exposure=1.0):
    """Copies one native tile into Blender's render result.

    `exposure`: light in the file for light on the film.
    `origin`: the crop's lower-left pixel in the frame, which is (0, 0) of the result.  The result
    is closed on every path (an open one crashes the saving of float files).
    """
    height, width = tile.combined.shape[:2]
    arrays = tile_arrays(tile)
    result = engine.begin_result(tile.x - origin[0], tile.y - origin[1], width, height, layer=layer)
    if result is None:
        raise ValueError(f"tile ({tile.x}, {tile.y}) lies outside of the result")
    complete = False
    try:
        if (result.resolution_x, result.resolution_y) != (width, height):
            raise ValueError(
                f"tile ({tile.x}, {tile.y}) of {width} x {height} pixels does not fit the result: "
                f"{result.resolution_x} x {result.resolution_y} pixels are left"
            )
        render_passes = result.layers[0].passes
        for p in passes:
            values = arrays[p.native]
            if exposure != 1.0 and is_exposed(p):
                values = np.array(values, dtype=np.float32)
                values[..., :3] *= np.float32(exposure)
            _put(render_passes[display_name(p)], values, width * height, p.channels)
        complete = True
    finally:
        engine.end_result(result, cancel=not complete)


def _put(render_pass, pixels, count, channels):
    """Up to Blender 4.0 `rect` has the shape (pixels, channels), later it is flat.

    It must be contiguous float32: other types leave the fast path, which on 3.4 does not check
    its size.
    """
    values = np.ascontiguousarray(pixels, dtype=np.float32)
    if values.size != count * channels:
        raise ValueError(f"pass {render_pass.name}: {values.size} values for {count} pixels")
    shape = (-1,) if bpy.app.version >= (4, 1, 0) else (count, channels)
    render_pass.rect.foreach_set(values.reshape(shape))
