# SPDX-License-Identifier: GPL-3.0-or-later
"""Export as a render sees it: from inside the `render()` of an engine that only exports.

The result of a script's export (engine None, the viewport's depsgraph) is there as well.
"""

import time
from contextlib import contextmanager
from types import SimpleNamespace

import bpy

from granita.export import PersistentState, Report, export_frame


class ExportProbe(bpy.types.RenderEngine):
    bl_idname = "GRANITA_EXPORT_PROBE"
    bl_label = "Export Probe"
    bl_use_postprocess = False

    job = None

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)

    def render(self, depsgraph):
        job = ExportProbe.job
        try:
            job.before(depsgraph)
            started = time.thread_time()
            job.snapshot = export_frame(
                self, depsgraph, job.settings, job.report, job.cancelled, job.persistent_state
            )
            job.seconds = time.thread_time() - started
        except Exception as error:
            job.error = error
        job.time_after = depsgraph.scene.frame_current + depsgraph.scene.frame_subframe
        job.after(depsgraph)


def _nothing(_):
    pass


@contextmanager
def _probing(scene):
    bpy.utils.register_class(ExportProbe)
    engine = scene.render.engine
    try:
        scene.render.engine = ExportProbe.bl_idname
        yield
    finally:
        scene.render.engine = engine
        bpy.utils.unregister_class(ExportProbe)
        ExportProbe.job = None


def _render(
    scene,
    motion_steps,
    cancelled=lambda _wanted: False,
    before=_nothing,
    after=_nothing,
    persistent_state=None,
):
    job = SimpleNamespace(
        settings=SimpleNamespace(motion_steps=motion_steps),
        report=Report(),
        cancelled=cancelled,
        snapshot=None,
        seconds=None,
        error=None,
        time_after=None,
        before=before,
        after=after,
        persistent_state=persistent_state,
    )
    ExportProbe.job = job
    bpy.ops.render.render(scene=scene.name)
    if job.error is not None:
        job.error.time_after = job.time_after
        raise job.error
    return job


def through_engine(
    scene, *, motion_steps=3, cancelled=lambda _wanted: False, before=_nothing, after=_nothing
):
    """(snapshot, Report, time at which the scene stood afterwards); raises what export raises."""
    with _probing(scene):
        job = _render(scene, motion_steps, cancelled, before, after)
    return job.snapshot, job.report, job.time_after


def frame_by_frame(scene, frames, *, persistent, keeps=True, motion_steps=3, edit=_nothing):
    """Exports frames as an animation does; yields of each its `snapshot`, `report` and `seconds`, of the
    exporting thread alone.

    Args:
        persistent: with Persistent Data.
        keeps: whether export keeps then what it read, from frame to frame.
        edit: called with the number of each frame before it is rendered.
    """
    scene.render.use_persistent_data = persistent
    persistent_state = PersistentState() if persistent and keeps else None
    with _probing(scene):
        for frame in frames:
            scene.frame_set(frame)
            edit(frame)
            yield _render(scene, motion_steps, persistent_state=persistent_state)


def through_script(*, motion_steps=3):
    """(snapshot, Report), from the viewport's depsgraph."""
    report = Report()
    settings = SimpleNamespace(motion_steps=motion_steps)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return export_frame(None, depsgraph, settings, report), report


def geometry_of(snapshot, name):
    """The geometry of the first instance of an object."""
    instances = snapshot["instances"]
    return snapshot["geometries"][instances["geometry"][instances["name"].index(name)]]


def knots_of(snapshot, name):
    """float64 [K, 4, 4], world from object, of the first instance of an object."""
    instances = snapshot["instances"]
    i = instances["name"].index(name)
    first = int(instances["knots"][:i].sum())
    return instances["world_from_object"][first : first + instances["knots"][i]]


def attribute_of(geometry, name):
    return next(a for a in geometry["attributes"] if a["name"] == name)
