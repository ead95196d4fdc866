# SPDX-License-Identifier: GPL-3.0-or-later
"""The same frame for Granita and for Cycles: settings that mean the same picture.  Runs inside Blender.

No bounces, as many transparent surfaces as there are, Blackman-Harris 1.5, neither adaptive sampling nor denoising.
"""

import time

import bpy
from mathutils import Vector

# Cycles' box shutter ends at 127/128 of what is asked, from the open end on (measured: 3.4 by a ramp of 100 pixels,
# to 6e-4), a bias of .0045 over the ramp.  Longer by as much it exposes the time that was asked for.
CYCLES_SHUTTER = 128 / 127
# 2^3 + 1 knots: chords of a path within the reference's noise.
CYCLES_MOTION_STEPS = 3


def add_camera(scene, location, target, lens=50.0):
    """Looks at the target; `lens` in millimetres."""
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    item = bpy.data.objects.new("Camera", data)
    item.location = location
    item.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(item)
    scene.camera = item


def set_size(scene, width, height):
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100


def set_motion(scene, engine, opens, shutter):
    """The shutter is open for `shutter` frames (0: no blur) from the frame `opens` on.

    Granita shades in the middle, Blender's own default; Cycles needs START for its shutter to be made up for.
    """
    render = scene.render
    render.use_motion_blur = shutter > 0
    cycles = engine == "CYCLES"
    render.motion_blur_shutter = shutter * (CYCLES_SHUTTER if cycles else 1)
    place = render if hasattr(render, "motion_blur_position") else scene.cycles
    place.motion_blur_position = "START" if cycles else "CENTER"
    for item in scene.objects:
        item.cycles.motion_steps = CYCLES_MOTION_STEPS
    frame, subframe = divmod(opens if cycles else opens + shutter / 2, 1)
    scene.frame_set(int(frame), subframe=subframe)


def set_cycles(scene, samples, seed=0):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples, cycles.seed = samples, seed
    cycles.use_adaptive_sampling, cycles.use_denoising = False, False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 0
    cycles.transmission_bounces = cycles.volume_bounces = 0
    cycles.transparent_max_bounces = 1024
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0.0
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 1.5


def set_bounces(scene, most, tamed=False):
    """Light is followed from surface to surface in either engine; its noise is tamed as a new file does it, or not at all."""
    cycles = scene.cycles
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = most
    cycles.transmission_bounces = most
    cycles.sample_clamp_indirect, cycles.blur_glossy = (10.0, 1.0) if tamed else (0.0, 0.0)
    scene.granita.bounces = "FULL"


def set_granita(scene, samples, **settings):
    scene.render.engine = "GRANITA"
    values = {
        "pixel_filter": "BLACKMAN_HARRIS",
        "filter_width": 1.5,
        "opacity_threshold": 1.0,
        "bounces": "NONE",
    }
    for name, value in {**values, "samples": samples, **settings}.items():
        setattr(scene.granita, name, value)


def normalize_normals(tree):
    """Gives Principled a unit normal: Cycles of Blender 3.4 leaves the one that it interpolates over a deforming face
    shorter than 1, which dims highlights (a fifth of the picture's FLIP before this stood here)."""
    bsdf = tree.nodes["Principled BSDF"]
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    normalize = tree.nodes.new("ShaderNodeVectorMath")
    normalize.operation = "NORMALIZE"
    tree.links.new(geometry.outputs["Normal"], normalize.inputs[0])
    tree.links.new(normalize.outputs["Vector"], bsdf.inputs["Normal"])


def render(scene, path):
    """Renders to linear 32-bit OpenEXR without compression; returns the seconds of the whole frame."""
    image = scene.render.image_settings
    if bpy.app.version >= (5, 0):
        image.media_type = "IMAGE"
    image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR", "32", "NONE"
    scene.view_settings.view_transform = "Standard"
    scene.render.use_file_extension = False
    scene.render.filepath = str(path)
    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    return time.perf_counter() - start
