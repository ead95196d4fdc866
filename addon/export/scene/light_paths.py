# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits of light's ways from surface to surface: `scene.granita.bounces` and those that Cycles has."""

from math import isfinite

# Cycles' property, the snapshot's option, Cycles' default: taken where its add-on is not enabled.
LIMITS = (
    ("max_bounces", "bounces", 12),
    ("diffuse_bounces", "diffuse_bounces", 4),
    ("glossy_bounces", "glossy_bounces", 4),
    ("transmission_bounces", "transmission_bounces", 12),
    ("volume_bounces", "volume_bounces", 0),
    ("transparent_max_bounces", "transparent_bounces", 8),
    ("sample_clamp_indirect", "clamp_indirect", 10.0),
    ("caustics_reflective", "reflective_caustics", True),
    ("caustics_refractive", "refractive_caustics", True),
    ("blur_glossy", "filter_glossy", 1.0),
)
# Cycles holds three times its clamp against the sum of the channels.
_CLAMPED_SUM = 3.0
_MOST = {"NONE": 0, "FAST": 2, "FULL": 1024}  # bounces
_KINDS = ("diffuse_bounces", "glossy_bounces", "transmission_bounces", "volume_bounces")


def light_paths(scene, settings, in_view=False, world=None):
    """The options of bounces; none where light is not followed and Fast GI does not stand for it either.

    Args:
        scene: whose settings of Cycles count.
        settings: `scene.granita`, or None.
        in_view: for a 3D view, for which Fast GI has a number of its own.
        world: evaluated, whose settings of Ambient Occlusion count; None: the scene's.
    """
    preset = getattr(settings, "bounces", "NONE")
    cycles = getattr(scene, "cycles", None)
    fast_gi = _fast_gi(cycles, world or scene.world, in_view)
    if preset == "NONE" and not fast_gi:
        return {}
    limits = {option: getattr(cycles, name, default) for name, option, default in LIMITS}
    limits["clamp_indirect"] *= _CLAMPED_SUM
    limits["bounces"] = min(limits["bounces"], _MOST[preset])
    if limits["bounces"] == 0:
        # Surfaces are still lit by what shines without being a lamp: what fills things.
        limits |= {"bounces": 1, **dict.fromkeys(_KINDS, 0)}
    return {**limits, **fast_gi}


def _fast_gi(cycles, world, in_view):
    if world is None or not getattr(cycles, "use_fast_gi", False):
        return {}
    factor, distance = world.light_settings.ao_factor, world.light_settings.distance
    if factor == 0.0 or not (isfinite(factor) and isfinite(distance)):
        return {}
    if cycles.fast_gi_method == "ADD":
        return {"occlusion_added": factor, "occlusion_distance": distance}
    return {
        "occluded_from": cycles.ao_bounces if in_view else cycles.ao_bounces_render,
        "occlusion_distance": distance,
        "occlusion_factor": factor,
    }


def report_occlusion(scene, world, report):
    """Names a world whose Ambient Occlusion is no number, if Fast GI asks for it.

    Args:
        scene: whose settings of Cycles count.
        world: evaluated, or None.
        report: called with (datablock, message).
    """
    if world is None or not getattr(getattr(scene, "cycles", None), "use_fast_gi", False):
        return
    settings = world.light_settings
    if not (isfinite(settings.ao_factor) and isfinite(settings.distance)):
        report(
            f"world '{world.name_full}'",
            "its Ambient Occlusion is no finite number: Fast GI is not used",
        )


def report_transparent_glass(scene, report):
    """Names Cycles' Transparent Glass, where it would show.

    Args:
        scene: whose film counts.
        report: called with (datablock, message).
    """
    cycles = getattr(scene, "cycles", None)
    if scene.render.film_transparent and getattr(cycles, "film_transparent_glass", False):
        report("render settings", "Transparent Glass is not used: glass is as opaque as anything")


def report_clamp_direct(scene, report):
    """Names Cycles' limit of light that comes straight from lamps, where there is one.

    Args:
        scene: whose settings of Cycles count.
        report: called with (datablock, message).
    """
    if getattr(getattr(scene, "cycles", None), "sample_clamp_direct", 0.0) > 0.0:
        report("render settings", "Clamp Direct is not used: direct light stays as bright as it is")


def report_volume_bounces(scene, settings, records, report):
    """Names the limit that counts for nothing where light is not followed, if something is filled.

    Args:
        scene: whose settings of Cycles count.
        settings: `scene.granita`, or None.
        records: of materials and the world.
        report: called with (datablock, message).
    """
    if getattr(settings, "bounces", "NONE") != "NONE":
        return
    bounces = getattr(getattr(scene, "cycles", None), "volume_bounces", 0)
    if bounces > 0 and any(record.get("volume") for record in records):
        report(
            "render settings",
            f"volumes scatter light once, not {bounces + 1} times, without bounces",
        )
