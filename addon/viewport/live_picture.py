# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view shows: linear premultiplied colours, refined in place, and the texture that they are drawn from.

Blender's own matrices, blending and view transform apply: what is drawn in a 3D view is scene linear.
"""

import numpy as np

_LARGEST_HALF = 65504.0


class LivePicture:
    """Arrays hold the lowest row first."""

    def __init__(self):
        self._sight = None  # of what is shown
        self._pixels = None  # float32 [height, width, 4] of its crop
        self._texture = None
        self._prepared = None  # pixels that the texture does not hold yet
        self._exposure = 1.0
        self._changed = False  # since pixels were prepared

    @property
    def is_there(self):
        return self._pixels is not None

    @property
    def pixels(self):
        """What is drawn; None where there is nothing yet."""
        if self._exposure == 1.0 or self._pixels is None:
            return self._pixels
        return self._pixels * np.array([self._exposure] * 3 + [1.0], dtype=np.float32)

    def expose(self, exposure):
        """The film's exposure from now on; whether it is another."""
        changes, self._exposure = exposure != self._exposure, exposure
        self._changed |= changes and self._pixels is not None
        return changes

    def replace(self, sight, pixels, divisor=1):
        """Shows other pixels.

        Args:
            sight: sight.Sight that they are of.
            pixels: float32 [h, w, 4], of `coarse_crop(sight.crop, divisor)`.
            divisor: how many pixels of the sight each is wide.
        """
        if divisor > 1:
            x0, y0, x1, y1 = sight.crop
            left, low = x0 - x0 // divisor * divisor, y0 - y0 // divisor * divisor
            pixels = pixels.repeat(divisor, axis=0).repeat(divisor, axis=1)
            pixels = np.ascontiguousarray(pixels[low : low + y1 - y0, left : left + x1 - x0])
        if self._sight is None or self._sight.crop != sight.crop:
            self._texture = None
        self._sight, self._pixels = sight, pixels
        self._changed = True

    def paste(self, x, y, pixels):
        """Replaces a rectangle whose lower left pixel of the frame is (x, y)."""
        x, y = x - self._sight.crop[0], y - self._sight.crop[1]
        height, width = pixels.shape[:2]
        self._pixels[y : y + height, x : x + width] = pixels
        self._changed = True

    def prepare(self):
        """What has changed is drawn from now on.

        Not for `draw` to do: NumPy lets other threads of Python run, and a render may begin in the middle of a drawing
        (docs/decisions/viewport.md).
        """
        if self._changed:
            self._changed = False
            self._prepared = np.clip(self.pixels, -_LARGEST_HALF, _LARGEST_HALF).reshape(-1)

    def draw(self):
        """Inside `view_draw` alone."""
        if self._texture is None and self._prepared is None:
            return
        import gpu
        from gpu_extras.presets import draw_texture_2d

        sight = self._sight
        height, width = self._pixels.shape[:2]
        if self._prepared is not None:
            buffer = gpu.types.Buffer("FLOAT", len(self._prepared), self._prepared)
            self._texture = gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)
            self._prepared = None
        place = [sight.place[i] + sight.crop[i] * sight.pixel for i in (0, 1)]
        gpu.state.blend_set("ALPHA_PREMULT")
        try:
            draw_texture_2d(self._texture, place, width * sight.pixel, height * sight.pixel)
        finally:
            gpu.state.blend_set("NONE")


def coarse_crop(crop, divisor):
    """The crop of a picture of which each pixel is `divisor` wide."""
    x0, y0, x1, y1 = crop
    return x0 // divisor, y0 // divisor, -(-x1 // divisor), -(-y1 // divisor)
