# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

settings = bpy.context.scene.granita

settings.samples = 64
settings.preview_samples = 64
settings.noise_threshold = 0.0
settings.min_samples = 16
settings.sampling = "INDEPENDENT"
settings.time_samples = 0
settings.light_samples = 16
settings.shading_threshold = 0.06
settings.opacity_threshold = 0.996
settings.dicing_rate = 1.0
settings.shading_rate = 0.0
settings.motion_factor = 1.0
settings.focus_factor = 1.0
