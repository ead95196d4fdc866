# SPDX-License-Identifier: GPL-3.0-or-later
"""From where a picture is taken: through a camera of the scene, which may move and focus, or from a place that
stands still, as a 3D view does outside of its camera."""

from dataclasses import dataclass

from ..base.blur_settings import blurs, fewest_segments
from .camera import Frame, camera_knot, camera_record, follows_object, lens_knot


@dataclass
class CameraViewpoint:
    """An object that the scene is seen through."""

    camera: object  # original Object; a handler may delete it when time is moved
    frame: Frame
    crop: tuple  # pixels of the frame that are made, (x0, y0, x1, y1)
    hidden: frozenset = frozenset()  # addresses of original objects that are not seen from here

    culls = True  # what Simplify leaves out by its place

    def __post_init__(self):
        # Read while it is sure to be there.
        self.blurs = blurs(self.camera)
        self.fewest_segments = fewest_segments(self.camera)

    def record(self, depsgraph, report):
        """The snapshot's camera at the depsgraph's time, with one knot: camera.camera_record."""
        return camera_record(self.camera, self.frame, depsgraph, report)

    def knot(self, depsgraph, at_frame):
        return camera_knot(self.camera, self.frame, depsgraph, at_frame)

    def lens(self, depsgraph, at_frame):
        return lens_knot(self.camera, self.frame, depsgraph, at_frame)

    def follows_object(self, depsgraph):
        return follows_object(self.camera, depsgraph)


@dataclass
class StillViewpoint:
    """A pinhole that no animation moves."""

    still_record: dict  # as of camera.camera_record
    frame: Frame
    crop: tuple
    hidden: frozenset = frozenset()

    blurs = False
    fewest_segments = 1
    culls = False  # nothing is read anew as one looks around

    def record(self, _depsgraph, _report):
        return dict(self.still_record)

    def knot(self, _depsgraph, at_frame):
        return at_frame["world_from_camera"][0]

    def lens(self, _depsgraph, _at_frame):
        return None

    def follows_object(self, _depsgraph):
        return False
