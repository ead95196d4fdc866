# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D view sees, as numbers: its camera, or its own place; the frame and where that lies in the region.

In camera view the frame is the camera's, as the region shows it.  Where that is the size of the final frame it is
the final frame, to the bit.
"""

import math
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector

from ..export.base.transforms import from_matrix, inverse, world_from_camera
from ..export.scene.camera import PINHOLE, Frame, window_projection
from ..export.scene.options import border, render_border, scene_frame
from ..export.scene.viewpoint import CameraViewpoint, StillViewpoint
from ..passes import Pass
from .shading_settings import COMBINED, shown_pass

_SHOW_TYPES = [
    name
    for name in bpy.types.SpaceView3D.bl_rna.properties.keys()
    if name.startswith("show_object_viewport_")
]


@dataclass(frozen=True)
class Look:
    """What of the scene this view alone shows."""

    hidden: frozenset = frozenset()  # addresses of original objects: local view, local collections
    shown: Pass = COMBINED
    time: float = None  # within the shutter; None: all of it


@dataclass(frozen=True)
class Sight:
    scene: str
    layer: str
    camera: str  # name of the object; "" = the view's own place
    frame: Frame  # in picture pixels
    crop: tuple  # of the frame, (x0, y0, x1, y1)
    place: tuple  # region pixel of the frame's lower left corner
    pixel: int  # region pixels a picture pixel is wide
    look: Look
    # Of the view's own place: (kind, world from camera, 16 numbers, scale, center, clip).
    own: tuple = None

    @property
    def is_empty(self):
        return self.crop[2] <= self.crop[0] or self.crop[3] <= self.crop[1]

    def viewpoint(self, scene):
        """Of export/scene/viewpoint.py, or None where the camera is gone."""
        if not self.camera:
            return StillViewpoint(self.own_record(), self.frame, self.crop, self.look.hidden)
        camera = scene.objects.get(self.camera)
        if camera is None:
            return None
        return CameraViewpoint(camera, self.frame, self.crop, self.look.hidden)

    def own_record(self):
        """The snapshot's camera of the view's own place."""
        kind, matrix, scale, center, clip = self.own
        return {
            "name": "3D view",
            "kind": kind,
            "world_from_camera": np.array(matrix).reshape(1, 4, 4),
            "scale": scale,
            "center": center,
            "clip": clip,
            **PINHOLE,
        }


def read_sight(region, space, region_data, depsgraph, pixel):
    """The Sight of a view.

    Args:
        region, space, region_data: Region, SpaceView3D and RegionView3D of the view.
        depsgraph: the view's, evaluated.
        pixel: region pixels a picture pixel is wide.
    """
    scene = depsgraph.scene
    names = scene.name, depsgraph.view_layer.name
    look = _look(space, depsgraph)
    if region_data.view_perspective == "CAMERA":
        camera = space.camera if space.use_local_camera else scene.camera
        if camera is not None and camera.type == "CAMERA":
            return _through_camera(names, region, region_data, camera, depsgraph, pixel, look)
    frame = Frame(-(-region.width // pixel), -(-region.height // pixel))
    crop = (0, 0, frame.width, frame.height)
    if space.use_render_border:
        crop = border(
            frame,
            space.render_border_min_x,
            space.render_border_min_y,
            space.render_border_max_x,
            space.render_border_max_y,
        )
    own = own_view(region, space, region_data, pixel)
    return Sight(*names, "", frame, crop, (0, 0), pixel, look, own)


def _look(space, depsgraph):
    settings = space.shading.granita
    time = settings.time if settings.use_time else None
    return Look(_hidden(space, depsgraph), shown_pass(settings, depsgraph.view_layer), time)


def _hidden(space, depsgraph):
    shows_all_types = all(getattr(space, name) for name in _SHOW_TYPES)
    if shows_all_types and not (space.local_view or space.use_local_collections):
        return frozenset()
    return frozenset(
        thing.as_pointer()
        for thing in depsgraph.view_layer.objects
        if not thing.evaluated_get(depsgraph).visible_in_viewport_get(space)
    )


def own_view(region, space, region_data, pixel):
    """Sight.own."""
    view = from_matrix(region_data.view_matrix)
    scale, center, is_perspective = window_projection(
        np.array(region_data.window_matrix), region.width / pixel, region.height / pixel
    )
    clip = (space.clip_start, space.clip_end)
    matrix = world_from_camera(inverse(view))
    if not is_perspective:
        # Blender shows as much behind the place of the view as before it.
        matrix = matrix.copy()
        matrix[:3, 3] -= matrix[:3, 2] * space.clip_end
        clip = (space.clip_start, 2.0 * space.clip_end)
    kind = "PERSPECTIVE" if is_perspective else "ORTHOGRAPHIC"
    return kind, tuple(matrix.reshape(-1)), scale, center, clip


def _through_camera(names, region, region_data, camera, depsgraph, pixel, look):
    scene = depsgraph.scene
    render = scene.render
    corners = _camera_frame(region, region_data, camera, depsgraph)
    # A camera that sees nothing is named where the scene is read.
    (x0, y0), (x1, y1) = corners or ((0, 0), (region.width, region.height))
    place = (round(x0), round(y0))
    frame = Frame(max(round((x1 - x0) / pixel), 1), max(round((y1 - y0) / pixel), 1))
    final = scene_frame(render)
    if abs(frame.width - final.width) <= 1 and abs(frame.height - final.height) <= 1:
        frame = final
    crop = render_border(render, frame)
    # What the region does not show is not made.
    crop = (
        max(crop[0], -place[0] // pixel),
        max(crop[1], -place[1] // pixel),
        min(crop[2], -((place[0] - region.width) // pixel)),
        min(crop[3], -((place[1] - region.height) // pixel)),
    )
    return Sight(*names, camera.name, frame, crop, place, pixel, look)


def _camera_frame(region, region_data, camera, depsgraph):
    """Region pixels of the lower left and upper right corner of the camera's frame; None where it has none, of a
    scale of 0, say."""
    evaluated = camera.evaluated_get(depsgraph)
    to_world = evaluated.matrix_world.normalized()
    corners = evaluated.data.view_frame(scene=depsgraph.scene)
    found = []
    for corner in corners:
        x, y, _, w = region_data.perspective_matrix @ Vector((*(to_world @ corner), 1.0))
        if not (w and math.isfinite(x / w) and math.isfinite(y / w)):
            return None
        found.append(((x / w + 1.0) * region.width / 2.0, (y / w + 1.0) * region.height / 2.0))
    return tuple(map(min, *found)), tuple(map(max, *found))
