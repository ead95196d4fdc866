# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's evaluated scene -> one frame of plain arrays (docs/scene_snapshot.md).

    settings -> camera -> one walk over the scene's objects -> materials -> meshes -> lights, world
             -> the same again, as little as possible, at the other knots of the shutter

All of it is copied: no reference to anything of Blender's is kept after `export_frame` returns.
"""

from dataclasses import replace

from .base.report import Cancelled, ExportError, Report
from .base.snapshot import Places, Snapshot
from .geometry.velocity import points_by_velocity
from .motion.adjacent_frames import read_adjacent_frames
from .motion.appearing_instances import with_appearing_instances
from .motion.sample_motion import Motion, sample_motion
from .scene.culling import Culling, culling_asked
from .scene.frame_scene import FrameScene
from .scene.instance import linked, place
from .scene.lamp_emitters import add_emitters
from .scene.lamps import energies, lamp_graphs, place_lamps, read_lamps
from .scene.light_linking import link_lights
from .scene.light_paths import (
    report_clamp_direct,
    report_occlusion,
    report_transparent_glass,
    report_volume_bounces,
)
from .scene.options import options_record, rendered_frame, scene_crop
from .scene.persistent_state import PersistentState
from .scene.scene_objects import read_scene_objects
from .scene.shutter import Clock, scene_shutter
from .scene.viewpoint import CameraViewpoint

__all__ = ["Cancelled", "ExportError", "PersistentState", "Report", "export_frame"]


def export_frame(
    engine,
    depsgraph,
    settings,
    report,
    check_cancel=lambda _wanted: False,
    persistent_state=None,
    viewpoint=None,
    moves=True,
    tell_places=None,
):
    """Copies the frame at which the depsgraph stands.

    Args:
        engine: RenderEngine whose `frame_set` steps time; None in scripts, where the scene's does.
        depsgraph: evaluated.  It is evaluated at other times for motion blur, and stands at its
            frame again on every way out.
        settings: `scene.granita`, anything with some of its properties, or None for the defaults.
        report: Report, or a function of (datablock, message), for what the frame survives.
        check_cancel: called often, with the bytes that the export is about to take where these are many, else 0;
            raises, or returns true, to end it.
        persistent_state: PersistentState of the engine where Blender keeps its evaluated scene from
            frame to frame: only what changed is read then.
        viewpoint: of scene/viewpoint.py, a 3D view's; None: the scene's camera and its resolution.
        moves: false where the depsgraph may not be moved in time: what is at the frame stands still.
        tell_places: called with the Places of the snapshot.

    Returns:
        dict for `granita_core.Scene`.

    Raises:
        ExportError: the frame cannot be rendered; the text names the datablock.
        Cancelled, or what check_cancel raises.
    """
    scene, view_layer = depsgraph.scene, depsgraph.view_layer
    clock = Clock(engine, scene)
    if persistent_state is not None:
        clock.after = lambda: persistent_state.note(depsgraph)
    if viewpoint is None:
        # Taken once: past a camera marker within the shutter Blender changes it.
        frame = rendered_frame(engine, scene.render)
        viewpoint = CameraViewpoint(_render_camera(engine, scene), frame, scene_crop(scene, frame))
    shutter = scene_shutter(scene, view_layer, settings)
    if not moves:
        shutter = replace(shutter, segments=0)
    options = options_record(
        scene,
        view_layer,
        settings,
        viewpoint.frame,
        viewpoint.crop,
        shutter.frame_time,
        in_view=depsgraph.mode == "VIEWPORT",
        world=_evaluated_world(depsgraph),
    )
    camera_at_frame = viewpoint.record(depsgraph, report)
    camera_place = camera_at_frame["world_from_camera"][0]

    if persistent_state is not None:
        scene_objects = persistent_state.scene_objects(depsgraph, report, check_cancel)
    else:
        scene_objects = read_scene_objects(depsgraph, None, report, check_cancel)
    scene_objects.hidden = viewpoint.hidden
    culls = viewpoint.culls and any(culling_asked(scene))
    scene_objects.culling = Culling(scene, camera_at_frame, viewpoint.frame) if culls else None
    world, world_images = _world(depsgraph, report)
    lamp_images = {}
    lamps = read_lamps(depsgraph, scene_objects.scan, scene_objects.lights(), lamp_images, report)
    scene_objects.choose(report)
    graphs = lamp_graphs(lamps, scene_objects.scan)
    at_frame = FrameScene(
        depsgraph=depsgraph,
        viewpoint=viewpoint,
        camera_record=camera_at_frame,
        visit=scene_objects.scan,
        plain=scene_objects.plain,
        sources=scene_objects.sources,
        geometry_of_prototype=scene_objects.table.geometry,
        is_light=scene_objects.is_light,
        energies=energies(depsgraph, graphs) if shutter.segments else {},
        lamp_graphs=graphs,
    )
    fps = scene.render.fps / scene.render.fps_base
    motion, points, adjacent, seen = (
        Motion(camera_at_frame["world_from_camera"]),
        {},
        {},
        scene_objects,
    )
    if shutter.segments:
        motion = sample_motion(clock, shutter, fps, at_frame, report, check_cancel)
        camera_at_frame["world_from_camera"] = motion.camera
        if motion.lens is not None:
            camera_at_frame["lens_knots"] = motion.lens
        seen = with_appearing_instances(
            scene_objects, at_frame.visit, depsgraph, report, check_cancel
        )
        later = seen.lights()[len(scene_objects.lights()) :]
        lamps += read_lamps(depsgraph, seen.scan, later, lamp_images, report)
        points = {**motion.points, **points_by_velocity(seen.sources, shutter, fps)}
    scan = seen.scan
    instances = place(seen.instances, scan, seen.chosen, motion.tracks, motion.lifespans, report)
    instances = linked(instances, scan, seen.chosen, link_lights(lamps, scan, report))
    if view_layer.use_pass_vector and moves:
        found = read_adjacent_frames(clock, at_frame, fps, report, check_cancel)
        camera_at_frame["adjacent"] = found.camera
        instances = found.instances(instances, scan, seen.chosen)
        adjacent = found.points
    if persistent_state is not None:
        persistent_state.keep(scene_objects)
    lights = place_lamps(lamps, scan, motion, report)
    instances, materials = _fill_empty_slots(instances, list(seen.materials))
    report_occlusion(scene, _evaluated_world(depsgraph), report)
    report_transparent_glass(scene, report)
    report_clamp_direct(scene, report)
    report_volume_bounces(scene, settings, (*materials, world), report)
    images = _each_once(seen.images + world_images + list(lamp_images.values()))
    images, colors = _in_color_spaces(images, report)
    snapshot = Snapshot(
        options=options,
        camera=camera_at_frame,
        geometries=[
            source.exported(points.get(index), adjacent.get(index))
            for index, source in enumerate(seen.sources)
        ],
        instances=replace(instances),
        materials=materials,
        images=images,
        **colors,
        lights=[record for _, record in lights],
        world=world,
    )
    if tell_places is not None:
        here = scan.matrices
        lamps_here = [here[thing] for thing, _ in lights]
        tell_places(Places(camera_place, here[seen.chosen], lamps_here))
    add_emitters(snapshot, lights, scan, report)
    return snapshot.as_dict()


def _each_once(images):
    return list({image["name"]: image for image in images}.values())


def _in_color_spaces(images, report):
    """(the images, what else the snapshot says of colours)."""
    from .shading.color_space import in_color_spaces
    from .shading.working_space import working_space

    images, spaces = in_color_spaces(images, report)
    return images, {"color_spaces": spaces, "working_space": working_space()}


def _render_camera(engine, scene):
    """The original camera object; the one that the render pipeline chose wins."""
    camera = getattr(engine, "camera_override", None) or scene.camera
    if camera is None:
        raise ExportError(f"scene '{scene.name}'", "has no camera")
    return camera.original


def _fill_empty_slots(instances, materials):
    from .shading.default_material import fill_empty_slots

    return fill_empty_slots(instances, materials)


def _evaluated_world(depsgraph):
    from .shading.world import world_of

    return world_of(depsgraph.scene_eval, depsgraph.view_layer_eval)


def _world(depsgraph, report):
    """(record of the world, those of its images)."""
    from .shading.layer_values import set_layer_values
    from .shading.world import export_world

    images = []
    scene, view_layer = depsgraph.scene_eval, depsgraph.view_layer_eval
    world = export_world(scene, view_layer, report, images)
    set_layer_values([world], scene, view_layer)
    return world, images
