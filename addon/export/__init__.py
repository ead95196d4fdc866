# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's evaluated scene -> one frame of plain arrays (docs/scene_snapshot.md).

    settings -> camera -> one walk over what is placed -> materials -> meshes -> lights, world
             -> the same again, as little as possible, at the other knots of the shutter

All of it is copied: nothing of Blender's is kept after `export_frame` returns.
"""

from dataclasses import replace

import numpy as np

from .attributes import requested_names
from .camera import camera_record
from .depsgraph import visit
from .frame_scene import FrameScene
from .geometry import read_geometries
from .instance import build_instances, collect_materials, kind_table, usable
from .motion import sample_motion
from .options import options_record, scene_frame
from .path import no_tracks
from .report import Cancelled, ExportError, Report
from .shutter import Clock, scene_shutter
from .snapshot import Snapshot
from .transforms import is_finite
from .velocity import moved_points

__all__ = ["Cancelled", "ExportError", "Report", "export_frame"]


def export_frame(engine, depsgraph, settings, report, check_cancel=lambda: False):
    """Copies the frame at which the depsgraph stands.

    Args:
        engine: RenderEngine whose `frame_set` steps time; None in scripts, where the scene's does.
        depsgraph: evaluated.  It is evaluated at other times for motion blur, and stands at its
            frame again on every way out.
        settings: `scene.granita`, anything with some of its properties, or None for the defaults.
        report: Report, or a function of (datablock, message), for what the frame survives.
        check_cancel: called often; raises, or returns true, to end the export.

    Returns:
        dict for `granita_core.Scene`.

    Raises:
        ExportError: the frame cannot be rendered; the text names the datablock.
        Cancelled, or what check_cancel raises.
    """
    scene, view_layer = depsgraph.scene, depsgraph.view_layer
    clock = Clock(engine, scene)
    frame = scene_frame(scene.render)
    shutter = scene_shutter(scene, settings)
    options = options_record(scene, view_layer, settings, frame, shutter.frame_time)
    # Taken once: past a camera marker within the shutter Blender changes it.
    camera = _render_camera(engine, scene)
    camera_at_frame = camera_record(camera, frame, depsgraph, report)

    scan = visit(depsgraph, report, check_cancel)
    override = depsgraph.view_layer_eval.material_override
    used_materials, slots = collect_materials(scan.kinds, override)
    materials, images, world, lights = _shading(depsgraph, used_materials, scan, report)
    sources, geometry_of_kind = read_geometries(
        scan, requested_names(materials), depsgraph, report, check_cancel
    )
    table = kind_table(scan.kinds, view_layer, geometry_of_kind, slots)
    chosen = usable(scan, table, report)

    at_frame = FrameScene(
        depsgraph=depsgraph,
        camera=camera,
        camera_record=camera_at_frame,
        frame=frame,
        visit=scan,
        sources=sources,
        geometry_of_kind=geometry_of_kind,
        is_light=np.array([kind.type == "LIGHT" for kind in scan.kinds], dtype=bool),
    )
    tracks, points = no_tracks(), {}
    if shutter.segments:
        motion = sample_motion(clock, shutter, at_frame, report, check_cancel)
        camera_at_frame["world_from_camera"] = motion.camera
        tracks, points = motion.tracks, motion.points
        points.update(_flying(sources, shutter, scene.render))
    _place_lights(lights, scan, tracks, report)
    return Snapshot(
        options=options,
        camera=camera_at_frame,
        geometries=[
            replace(source.geometry, points=points.get(index, source.geometry.points))
            for index, source in enumerate(sources)
        ],
        instances=build_instances(scan, chosen, table, tracks, report),
        materials=materials,
        images=images,
        lights=[light for _, light in lights],
        world=world,
    ).as_dict()


def _render_camera(engine, scene):
    """The original camera object; the one that the render pipeline chose wins."""
    camera = getattr(engine, "camera_override", None) or scene.camera
    if camera is None:
        raise ExportError(f"scene '{scene.name}'", "has no camera")
    return camera.original


def _shading(depsgraph, used_materials, scan, report):
    """Materials, images, world, and lights without a place: [(index in the scan, record)]."""
    from .light import light_record
    from .material import export_materials
    from .world import export_world

    aovs = {aov.name for aov in depsgraph.view_layer.aovs if aov.is_valid}
    materials, images = export_materials(used_materials, report, aovs)
    world = export_world(depsgraph.scene_eval, depsgraph.view_layer_eval, report, images)
    no_place = np.eye(4)[None]
    is_light = np.array([kind.type == "LIGHT" for kind in scan.kinds], dtype=bool)
    lights = [
        (i, light_record(scan.kinds[scan.kind[i]].source, no_place, report))
        for i in np.flatnonzero(is_light[scan.kind])
    ]
    return materials, images, world, lights


def _flying(sources, shutter, render):
    """{geometry index: float32 [2, V, 3]} of those whose points say their velocity."""
    return {
        index: moved_points(
            source.geometry.points[0], source.velocity, shutter, render.fps / render.fps_base
        )
        for index, source in enumerate(sources)
        if source.velocity is not None and source.velocity.any()
    }


def _place_lights(lights, scan, tracks, report):
    """Gives lights their matrices; those that are nowhere are left out."""
    for entry in list(lights):
        i, light = entry
        if not is_finite(scan.matrices[i : i + 1])[0]:
            report(f"light '{light['name']}'", "its transform is not finite: left out")
            lights.remove(entry)
            continue
        light["world_from_light"], _ = tracks.table(scan.matrices, np.array([i]))
