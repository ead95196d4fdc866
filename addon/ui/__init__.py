# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: Granita's own, and Blender's that serve it as they are."""

from . import (
    compare_operators,
    culling_panels,
    denoise_operator,
    light_panels,
    linking_panels,
    material_panels,
    motion_panels,
    pass_panels,
    ray_panels,
    render_panels,
    sampling_presets,
    stock_panels,
    view_layer_panels,
    view_panels,
)

_PARTS = (
    sampling_presets,
    render_panels,
    motion_panels,
    ray_panels,
    culling_panels,
    light_panels,
    linking_panels,
    material_panels,
    view_layer_panels,
    pass_panels,
    compare_operators,
    denoise_operator,
    view_panels,
    stock_panels,
)


def register():
    for part in _PARTS:
        part.register()


def unregister():
    for part in reversed(_PARTS):
        part.unregister()
