# SPDX-License-Identifier: GPL-3.0-or-later
"""Two pictures of a 3D view beside each other in the Image Editor: one that was kept, and the one that it shows now."""

import bpy
import numpy as np

from ..viewport import loop

IMAGE = "Granita Comparison"
_GAP = 8  # pixels between the two


class _OfView:
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context):
        view = _view(context)
        return view is not None and view.is_settled and view.picture.is_there


class GRANITA_OT_keep_picture(_OfView, bpy.types.Operator):
    """Keep this view's picture, to compare later ones with it"""

    bl_idname = "view3d.granita_keep_picture"
    bl_label = "Keep"

    def execute(self, context):
        view = _view(context)
        view.kept_pixels = view.picture.pixels.copy()
        return {"FINISHED"}


class GRANITA_OT_compare_pictures(_OfView, bpy.types.Operator):
    """Show the picture that was kept, left, beside the one of now in the Image Editor"""

    bl_idname = "view3d.granita_compare_pictures"
    bl_label = "Compare"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and _view(context).kept_pixels is not None

    def execute(self, context):
        view = _view(context)
        image = _show(beside(view.kept_pixels, view.picture.pixels))
        for window in context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "IMAGE_EDITOR":
                    area.spaces.active.image = image
                    return {"FINISHED"}
        self.report({"INFO"}, f"The image '{IMAGE}' is made; no Image Editor is open to show it")
        return {"FINISHED"}


def beside(left, right):
    """float32 [max height, sum of widths and a gap, 4] of two pictures [h, w, 4], lowest rows level."""
    height = max(len(left), len(right))
    width = left.shape[1] + _GAP + right.shape[1]
    pixels = np.zeros((height, width, 4), dtype=np.float32)
    pixels[: len(left), : left.shape[1]] = left
    pixels[: len(right), left.shape[1] + _GAP :] = right
    return pixels


def _show(pixels):
    """The image with these pixels, scene linear with alpha associated."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.get(IMAGE)
    if image is not None and tuple(image.size) != (width, height):
        bpy.data.images.remove(image)
        image = None
    if image is None:
        image = bpy.data.images.new(IMAGE, width, height, alpha=True, float_buffer=True)
        image.alpha_mode = "PREMUL"
    image.pixels.foreach_set(pixels.reshape(-1))
    image.update()
    return image


def _view(context):
    return loop.view_of(context.area) if context.area is not None else None


register, unregister = bpy.utils.register_classes_factory(
    (GRANITA_OT_keep_picture, GRANITA_OT_compare_pictures)
)
