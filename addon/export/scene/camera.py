# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's camera -> the snapshot's.

Pixels of a camera-space point (x right, y up, z forward):

    perspective   X = cx + sx * x / z        orthographic   X = cx + sx * x

The sensor spans the frame along its fit direction; pixel aspect stretches the other one.  Shift is
in units of the fitted side, and moves the picture against the camera.
"""

import math
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from ..base.report import ExportError
from ..base.transforms import from_matrix, inverse, world_from_camera


@dataclass(frozen=True)
class Frame:
    """Full frame: pixels and the width and height of one pixel (only their ratio matters)."""

    width: int
    height: int
    aspect_x: float = 1.0
    aspect_y: float = 1.0

    def fitted_side(self, sensor_fit):
        """(length of the side that the sensor spans, in pixel aspect units; is it horizontal)."""
        across, up = self.width * self.aspect_x, self.height * self.aspect_y
        horizontal = sensor_fit == "HORIZONTAL" or (sensor_fit == "AUTO" and across >= up)
        return (across if horizontal else up), horizontal


def projection(frame, sensor_fit, span, shift):
    """Pixels from camera space.

    Args:
        frame: Frame.
        sensor_fit: "AUTO", "HORIZONTAL" or "VERTICAL".
        span: what the fitted side sees: sensor size / focal length (perspective), or metres
            (orthographic).
        shift: (x, y), Blender's.

    Returns:
        ((sx, sy), (cx, cy)), pixels.
    """
    side, _ = frame.fitted_side(sensor_fit)
    scale = (side / span / frame.aspect_x, side / span / frame.aspect_y)
    center = (
        frame.width / 2.0 - shift[0] * side / frame.aspect_x,
        frame.height / 2.0 - shift[1] * side / frame.aspect_y,
    )
    return scale, center


def window_projection(matrix, width, height):
    """Pixels from camera space (x right, y up, z forward) of an OpenGL projection.

    Args:
        matrix: [4, 4] clip from view space.
        width, height: pixels of the window.

    Returns:
        ((sx, sy), (cx, cy), whether it is a perspective).
    """
    is_perspective = bool(matrix[3, 3] == 0.0)
    half = np.array([width, height]) / 2.0
    scale = half * (matrix[0, 0], matrix[1, 1])
    if is_perspective:
        center = half * (1.0 - matrix[:2, 2])
    else:
        center = half * (1.0 + matrix[:2, 3])
    return tuple(map(float, scale)), tuple(map(float, center)), is_perspective


def sensor_size(sensor_fit, sensor_width, sensor_height):
    """Millimetres along the fitted side.  AUTO always means the sensor's width, as in Blender."""
    return sensor_height if sensor_fit == "VERTICAL" else sensor_width


def lens_radius(kind, focal_length_mm, f_stop):
    """Metres.  An orthographic lens has no focal length: it counts as one metre, as in Cycles."""
    f_stop = max(f_stop, 1e-5)
    return (
        1.0 / (2.0 * f_stop) if kind == "ORTHOGRAPHIC" else focal_length_mm * 1e-3 / (2.0 * f_stop)
    )


# Of a record without depth of field.
PINHOLE = {
    "lens_radius": 0.0,
    "focus_distance": 10.0,
    "blades": 0,
    "blade_rotation": 0.0,
    "lens_ratio": 1.0,
}
_KINDS = {"PERSP": "PERSPECTIVE", "ORTHO": "ORTHOGRAPHIC"}


def _lens_of(evaluated):
    """What of a Camera counts, of any object: Blender looks through every one.  As in Cycles a light's lens
    sees its cone, and any other's has 50 mm, 35 since 5.1."""
    if evaluated.type == "CAMERA":
        return evaluated.data
    import bpy

    lens = 50.0 if bpy.app.version < (5, 1) else 35.0
    if evaluated.type == "LIGHT":
        cone = getattr(evaluated.data, "spot_size", math.pi / 4.0)  # 45 degrees where it has none
        lens = 16.0 / math.tan(0.5 * cone)
    return SimpleNamespace(
        type="PERSP",
        lens=lens,
        sensor_fit="AUTO",
        sensor_width=36.0,
        sensor_height=24.0,
        shift_x=0.0,
        shift_y=0.0,
        clip_start=1e-5,
        clip_end=1e5,
        dof=SimpleNamespace(use_dof=False, focus_object=None),
    )


def camera_record(camera, frame, depsgraph, report):
    """The snapshot's camera at the depsgraph's time, with one knot.

    Args:
        camera: original object.
        frame: Frame.
        depsgraph: evaluated; `depsgraph.scene.camera` is frozen, so the evaluated copy is asked.

    Raises:
        ExportError: names the camera: panoramic, without a size, or no lens.
    """
    evaluated = camera.evaluated_get(depsgraph)
    name = f"camera '{camera.name}'"
    data = _lens_of(evaluated)
    if evaluated.type != "CAMERA":
        report(name, f"is no camera object: seen through a lens of {data.lens:.3g} mm")
    if data.type not in _KINDS:
        raise ExportError(name, f"the lens type {data.type} is not supported")
    kind = _KINDS[data.type]
    matrix = camera_matrix(camera, depsgraph)
    if matrix is None:
        raise ExportError(name, "its scale is zero, or its transform not finite")
    found = _projection(data, kind, frame)
    if found is None:
        raise ExportError(name, "sees nothing: its focal length or its scale is not usable")
    if not data.clip_end > data.clip_start:
        raise ExportError(name, f"clips everything: {data.clip_start:g} m to {data.clip_end:g} m")
    scale, center = found
    record = {
        "name": camera.name,
        "kind": kind,
        "world_from_camera": matrix[None],
        "scale": scale,
        "center": center,
        "clip": (data.clip_start, data.clip_end),
        **PINHOLE,
    }
    if data.dof.use_dof:
        _add_lens(record, data, evaluated, depsgraph, report)
    return record


def _projection(data, kind, frame):
    """(scale, center) of evaluated camera data; None where it sees nothing."""
    if kind == "PERSPECTIVE":
        span = sensor_size(data.sensor_fit, data.sensor_width, data.sensor_height) / data.lens
    else:
        span = data.ortho_scale
    if not (math.isfinite(span) and span > 0.0):
        return None
    return projection(frame, data.sensor_fit, span, (data.shift_x, data.shift_y))


def camera_knot(camera, frame, depsgraph, at_frame):
    """float64 [4, 4] world from camera at the depsgraph's time, as the camera of the frame sees it.

    The projection is linear in x, y and z, so a focal length, an orthographic scale or a shift that
    changes within the shutter is the same as a space that is scaled and sheared in x and y: with the
    frame's own projection, points land where the other one puts them.

    Args:
        camera: original object.
        frame: Frame.
        depsgraph: evaluated at a time of the shutter.
        at_frame: `camera_record` at the frame.

    Returns:
        None where the camera has no extent or sees nothing.
    """
    matrix = camera_matrix(camera, depsgraph)
    data = _lens_of(camera.evaluated_get(depsgraph))
    found = _projection(data, at_frame["kind"], frame)
    if matrix is None or found is None:
        return None
    return matrix @ inverse(other_projection(at_frame, *found))


def other_projection(at_frame, scale, center):
    """float64 [4, 4] on camera space: what another scale and center (pixels) make of points."""
    change = np.eye(4)
    column = 2 if at_frame["kind"] == "PERSPECTIVE" else 3
    for axis in (0, 1):
        change[axis, axis] = scale[axis] / at_frame["scale"][axis]
        change[axis, column] = (center[axis] - at_frame["center"][axis]) / at_frame["scale"][axis]
    return change


def lens_knot(camera, frame, depsgraph, at_frame):
    """float64 [2] radius and focus distance, metres, at the depsgraph's time.

    Circles of confusion are the scale times the radius, so a larger scale (a longer focal length) is
    a wider lens under the frame's scale.

    Args:
        as of `camera_knot`, which has found the camera usable at this time.

    Returns:
        None where the camera focuses on itself.
    """
    evaluated = camera.evaluated_get(depsgraph)
    data, kind = _lens_of(evaluated), at_frame["kind"]
    focus = _focus_distance(data.dof, evaluated, depsgraph)
    if not _can_focus(focus):
        return None
    scale, _ = _projection(data, kind, frame)
    radius = lens_radius(kind, data.lens, data.dof.aperture_fstop)
    return np.array([radius * (scale[0] / at_frame["scale"][0]), focus])


def follows_object(camera, depsgraph):
    """Whether the camera focuses on an object, which a handler of another add-on may delete."""
    return _lens_of(camera.evaluated_get(depsgraph)).dof.focus_object is not None


def camera_matrix(camera, depsgraph):
    """float64 [4, 4] world from camera at the depsgraph's time; None when it has no extent."""
    return world_from_camera(from_matrix(camera.evaluated_get(depsgraph).matrix_world))


def _add_lens(record, data, evaluated, depsgraph, report):
    focus = _focus_distance(data.dof, evaluated, depsgraph)
    if not _can_focus(focus):
        report(f"camera '{evaluated.name}'", "focuses on itself: rendered without depth of field")
        return
    record.update(
        lens_radius=lens_radius(record["kind"], data.lens, data.dof.aperture_fstop),
        focus_distance=focus,
        blades=data.dof.aperture_blades,
        blade_rotation=data.dof.aperture_rotation,
        lens_ratio=data.dof.aperture_ratio,
    )


def _can_focus(distance):
    return math.isfinite(distance) and distance > 0.0


def _focus_distance(dof, evaluated, depsgraph):
    """Metres along the view direction, to the focus object (or its bone) where there is one."""
    if dof.focus_object is None:
        return dof.focus_distance
    target = dof.focus_object.evaluated_get(depsgraph)
    place = target.matrix_world
    bone = getattr(dof, "focus_subtarget", "")
    if bone and target.type == "ARMATURE" and bone in target.pose.bones:
        place = place @ target.pose.bones[bone].matrix
    view = evaluated.matrix_world.col[2].to_3d().normalized()
    return abs((evaluated.matrix_world.translation - place.translation).dot(view))
