# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's evaluated scene -> one frame of plain arrays (docs/scene_snapshot.md).

    settings -> camera -> one walk over what is placed -> materials -> meshes -> lights, world
             -> the same again, as little as possible, at the other knots of the shutter

All of it is copied: no reference to anything of Blender's is kept after `export_frame` returns.
"""

from .blur_settings import blurs
from .camera import camera_record
from .frame_scene import FrameScene
from .instance import place
from .lamps import energies, place_lamps, read_lamps
from .motion import Motion, sample_motion
from .neighbours import read_neighbours
from .newcomers import with_newcomers
from .options import options_record, scene_frame
from .persistent import Kept
from .placed import read_placed
from .report import Cancelled, ExportError, Report
from .shutter import Clock, scene_shutter
from .snapshot import Snapshot
from .velocity import flying_points

__all__ = ["Cancelled", "ExportError", "Kept", "Report", "export_frame"]


def export_frame(engine, depsgraph, settings, report, check_cancel=lambda: False, kept=None):
    """Copies the frame at which the depsgraph stands.

    Args:
        engine: RenderEngine whose `frame_set` steps time; None in scripts, where the scene's does.
        depsgraph: evaluated.  It is evaluated at other times for motion blur, and stands at its
            frame again on every way out.
        settings: `scene.granita`, anything with some of its properties, or None for the defaults.
        report: Report, or a function of (datablock, message), for what the frame survives.
        check_cancel: called often; raises, or returns true, to end the export.
        kept: persistent.Kept of the engine where Blender keeps its evaluated scene from frame to frame:
            only what changed is read then.

    Returns:
        dict for `granita_core.Scene`.

    Raises:
        ExportError: the frame cannot be rendered; the text names the datablock.
        Cancelled, or what check_cancel raises.
    """
    scene, view_layer = depsgraph.scene, depsgraph.view_layer
    clock = Clock(engine, scene)
    if kept is not None:
        clock.after = lambda: kept.note(depsgraph)
    frame = scene_frame(scene.render)
    shutter = scene_shutter(scene, settings)
    options = options_record(scene, view_layer, settings, frame, shutter.frame_time)
    # Taken once: past a camera marker within the shutter Blender changes it.
    camera = _render_camera(engine, scene)
    camera_at_frame = camera_record(camera, frame, depsgraph, report)

    if kept is not None:
        placed = kept.placed(depsgraph, report, check_cancel)
    else:
        placed = read_placed(depsgraph, None, report, check_cancel)
    world, world_images = _world(depsgraph, report)
    lamps = read_lamps(depsgraph, placed.scan, placed.lights(), report)
    placed.choose(report)
    at_frame = FrameScene(
        depsgraph=depsgraph,
        camera=camera,
        camera_blurs=blurs(camera),
        camera_record=camera_at_frame,
        frame=frame,
        visit=placed.scan,
        plain=placed.plain,
        sources=placed.sources,
        geometry_of_kind=placed.table.geometry,
        is_light=placed.is_light,
        energies=energies(depsgraph) if shutter.segments else {},
    )
    fps = scene.render.fps / scene.render.fps_base
    motion, points, neighbours, seen = Motion(camera_at_frame["world_from_camera"]), {}, {}, placed
    if shutter.segments:
        motion = sample_motion(clock, shutter, fps, at_frame, report, check_cancel)
        camera_at_frame["world_from_camera"] = motion.camera
        if motion.lens is not None:
            camera_at_frame["lens_knots"] = motion.lens
        seen = with_newcomers(placed, at_frame.visit, depsgraph, report, check_cancel)
        later = seen.lights()[len(placed.lights()) :]
        lamps += read_lamps(depsgraph, seen.scan, later, report)
        points = {**motion.points, **flying_points(seen.sources, shutter, fps)}
    scan = seen.scan
    instances = place(seen.instances, scan, seen.chosen, motion.tracks, motion.lifespans, report)
    if view_layer.use_pass_vector:
        found = read_neighbours(clock, at_frame, fps, report, check_cancel)
        camera_at_frame["neighbours"] = found.camera
        instances = found.instances(instances, scan, seen.chosen)
        neighbours = found.points
    if kept is not None:
        kept.keep(placed)
    return Snapshot(
        options=options,
        camera=camera_at_frame,
        geometries=[
            source.exported(points.get(index), neighbours.get(index))
            for index, source in enumerate(seen.sources)
        ],
        instances=instances,
        materials=seen.materials,
        images=_each_once(seen.images + world_images),
        lights=place_lamps(lamps, scan, motion, report),
        world=world,
    ).as_dict()


def _each_once(images):
    return list({image["name"]: image for image in images}.values())


def _render_camera(engine, scene):
    """The original camera object; the one that the render pipeline chose wins."""
    camera = getattr(engine, "camera_override", None) or scene.camera
    if camera is None:
        raise ExportError(f"scene '{scene.name}'", "has no camera")
    return camera.original


def _world(depsgraph, report):
    """(record of the world, those of its images)."""
    from .world import export_world

    images = []
    world = export_world(depsgraph.scene_eval, depsgraph.view_layer_eval, report, images)
    return world, images
