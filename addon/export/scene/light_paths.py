# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits of light's ways from surface to surface: `scene.granita.bounces` and those that Cycles has."""

# Cycles' property, the snapshot's option, Cycles' default: taken where its add-on is not enabled.
LIMITS = (
    ("max_bounces", "bounces", 12),
    ("diffuse_bounces", "diffuse_bounces", 4),
    ("glossy_bounces", "glossy_bounces", 4),
    ("transmission_bounces", "transmission_bounces", 12),
    ("volume_bounces", "volume_bounces", 0),
    ("transparent_max_bounces", "transparent_bounces", 8),
    ("sample_clamp_indirect", "clamp_indirect", 10.0),
    ("caustics_reflective", "caustics", True),
    ("blur_glossy", "filter_glossy", 1.0),
)
_FAST = 2  # bounces


def light_paths(scene, settings, in_view=False):
    """The options of bounces; none where light is not followed.

    Args:
        scene: whose settings of Cycles count, and whose world's of Ambient Occlusion.
        settings: `scene.granita`, or None.
        in_view: for a 3D view, for which Fast GI has a number of its own.
    """
    preset = getattr(settings, "bounces", "NONE")
    if preset == "NONE":
        return {}
    cycles = getattr(scene, "cycles", None)
    limits = {option: getattr(cycles, name, default) for name, option, default in LIMITS}
    if preset == "FAST":
        limits["bounces"] = min(limits["bounces"], _FAST)
    return {**limits, **_fast_gi(cycles, scene.world, in_view)}


def _fast_gi(cycles, world, in_view):
    if world is None or not getattr(cycles, "use_fast_gi", False):
        return {}
    factor, distance = world.light_settings.ao_factor, world.light_settings.distance
    if factor == 0.0:
        return {}
    if cycles.fast_gi_method == "ADD":
        return {"occlusion_added": factor, "occlusion_distance": distance}
    return {
        "occluded_from": cycles.ao_bounces if in_view else cycles.ao_bounces_render,
        "occlusion_distance": distance,
        "occlusion_factor": factor,
    }


def report_transparent_glass(scene, report):
    """Names Cycles' Transparent Glass, where it would show.

    Args:
        scene: whose film counts.
        report: called with (datablock, message).
    """
    cycles = getattr(scene, "cycles", None)
    if scene.render.film_transparent and getattr(cycles, "film_transparent_glass", False):
        report("render settings", "Transparent Glass is not used: glass is as opaque as anything")


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
