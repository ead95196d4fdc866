# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view knows of its scene: the frame as it is now, and the shutter as it was read last."""

import os

import bpy

from .. import passes
from ..export import PersistentState
from ..export.base.report import ExportError, Report
from ..export.scene.options import light_samples
from ..export.scene.shutter import is_blurred, scene_shutter
from ..export.shading.image import PaintedPixels
from . import scene_reading
from .carried_motion import ShutterTimes, carried, corrected
from .same import is_same
from .shading_settings import COMBINED

# Of a snapshot, what is often the same at all times of the shutter.
_MAY_STAND_STILL = {"options", "camera", "materials", "images", "lights", "world"}
# Read at the frame alone.
_LOOKS = (
    bpy.types.Material,
    bpy.types.World,
    bpy.types.Image,
    bpy.types.Texture,
    bpy.types.ShaderNodeTree,
)


class SceneSnapshots:
    """Belongs to one view.

    Attributes:
        snapshot: what a picture of the state that was read last shows.
        is_exact: whether it holds the motion of that state, not one that was carried over and may be another.
        is_current: whether what scripts may have painted since, without a word, was looked at.
        report: export's Report of the reading.
        exposure: of the film.
    """

    def __init__(self):
        self.snapshot, self.is_exact, self.is_current = None, False, True
        self.report = Report()
        self.exposure = 1.0
        self._state = PersistentState()
        self._still, self._times = None, None  # ShutterTimes; None: nothing blurs
        self._moving, self._moving_times = None, None  # of the last reading of a whole shutter
        self._paths_may_differ = True  # since then
        self._clock = None
        self._image_times = []
        self._painted = PaintedPixels()

    def note(self, depsgraph):
        """What Blender tells of an edit, before the next reading."""
        updates = self._state.note(depsgraph)
        if depsgraph.id_type_updated("IMAGE"):
            self._painted.forget()
        if not self._paths_may_differ:
            self._paths_may_differ = any(_can_change_paths(*update) for update in updates)

    def forget(self):
        """Addresses may mean something else now."""
        self._state = PersistentState()
        self._painted.forget()
        self._paths_may_differ = True

    def read_frame(self, sight, looks_at_paintings=False):
        """Reads what changed at the frame; whether it shows.

        Args:
            looks_at_paintings: also those of which Blender has told nothing, .9 s for 4096 x 4096 pixels.

        Raises:
            ExportError: and nothing is known any more.
        """
        if looks_at_paintings:
            self._painted.forget()
        before, self._still, self.snapshot = self._still, None, None
        self.report = Report()
        with self._painted.in_use():
            still = scene_reading.read_still(
                sight.scene, sight.layer, _viewpoint_of(sight), self._state, self.report
            )
        self.is_current = not self._painted.was_taken
        scene = bpy.data.scenes[sight.scene]
        layer = scene.view_layers[sight.layer]
        self._complete(still, scene, sight)
        blurs = is_blurred(scene, layer) and scene_reading.may_move(sight.scene)
        times = _times(scene, layer) if blurs else None
        image_times = _image_times(still)
        changed = not is_same(before, still) or (times, image_times) != (
            self._times,
            self._image_times,
        )
        self._image_times = image_times
        clock = _clock(scene)
        is_timed = times == self._times and clock == self._clock
        if changed and not (is_timed and self._takes_over(before, still)):
            self._paths_may_differ = True
        self._paths_may_differ |= not is_timed or self._moving is None
        self._clock = clock
        self.is_exact = not blurs or not self._paths_may_differ
        if not blurs:
            self._moving = None
        self._still, self._times = still, times
        self.snapshot = still
        if not self._paths_may_differ and self._moving is not None:
            self.snapshot = self._moving
        elif self._moving is not None:
            self.snapshot = carried(still, times, self._moving, self._moving_times)
        return changed

    def _takes_over(self, before, still):
        """Whether what differs between two frames is the same at all times of the shutter: then the last reading of
        that has it too."""
        if before is None or self._moving is None:
            return False
        others = [name for name in still if not is_same(before[name], still[name])]
        for name in others:
            if name not in _MAY_STAND_STILL or not is_same(self._moving[name], before[name]):
                return False
        self._moving = {**self._moving, **{name: still[name] for name in others}}
        return True

    def read_shutter(self, sight):
        """Reads the whole shutter; whether its picture is another than that of the last such reading."""
        before = self._moving
        self.report = Report()
        with self._painted.in_use():
            moving, places = scene_reading.read_snapshot(
                sight.scene, sight.layer, _viewpoint_of(sight), self.report
            )
        scene = bpy.data.scenes[sight.scene]
        self._complete(moving, scene, sight)
        self._moving_times = _times(scene, scene.view_layers[sight.layer])
        moving = corrected(moving, self._moving_times, places, self._still)
        self._moving = self.snapshot = moving
        self._paths_may_differ = False
        self.is_exact = True
        return not is_same(before, moving)

    def _complete(self, snapshot, scene, sight):
        """Of a view are its own samples, and the one pass that it shows."""
        shown = sight.look.shown
        self.exposure = (
            passes.exposure_owner(scene).film_exposure if passes.is_exposed(shown) else 1.0
        )
        options = snapshot["options"]
        settings = scene.granita
        options["samples"] = settings.preview_samples
        options["light_samples"] = light_samples(
            settings.light_samples, settings.preview_samples, settings.noise_threshold
        )
        options["depth_pass"] = False
        if shown != COMBINED:
            options.update(passes.requested(scene, scene.view_layers[sight.layer], shown))


def _viewpoint_of(sight):
    def viewpoint_of(scene):
        viewpoint = sight.viewpoint(scene)
        if viewpoint is None:
            raise ExportError(f"camera '{sight.camera}'", "is gone")
        return viewpoint

    return viewpoint_of


def _can_change_paths(thing, moved, formed, shaded):
    """Not what a selection or the cursor is to Blender: the scene, without anything that moved; nor how a surface looks,
    nor a lamp or a camera that nothing moves.  A reading of the shutter may hold the window up, and neither a click
    nor a drag of a colour should."""
    types, moved = bpy.types, moved or formed
    if shaded and not moved:
        return False  # since Blender 4.5 what wears a material is named with it
    if isinstance(thing, (types.Scene, types.Collection)):
        return moved
    if isinstance(thing, (types.Light, types.Camera)):
        return _is_animated(thing)
    if isinstance(thing, types.Object) and thing.type in {"LIGHT", "CAMERA"}:
        leads = thing.parent is not None or len(thing.constraints) > 0
        return leads or _is_animated(thing) or _is_animated(thing.data)
    return not isinstance(thing, _LOOKS)


def _is_animated(thing):
    dof = getattr(thing, "dof", None)
    follows = dof is not None and dof.focus_object is not None
    return follows or thing.animation_data is not None


def _image_times(snapshot):
    """When the files of images were written last: under their names they may be others."""
    found = []
    for image in snapshot["images"]:
        try:
            found.append(os.stat(image["path"]).st_mtime_ns if image["path"] else 0)
        except OSError:
            found.append(0)
    return found


def _clock(scene):
    """What of a scene makes other paths of the same keys."""
    render = scene.render
    return (
        scene.granita.motion_steps,
        render.fps,
        render.fps_base,
        render.frame_map_old,
        render.frame_map_new,
        scene.use_gravity,
        tuple(scene.gravity),
        tuple((m.frame, m.camera.name) for m in scene.timeline_markers if m.camera is not None),
    )


def _times(scene, layer):
    shutter = scene_shutter(scene, layer, scene.granita)
    return ShutterTimes(shutter.length, shutter.frame_time)
