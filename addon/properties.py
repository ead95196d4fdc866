# SPDX-License-Identifier: GPL-3.0-or-later
"""`scene.granita`: the settings that Blender itself does not have.

The names and the numbers of the enumerations are API: files keep them.  No property has an
`update` callback: with one, Blender 4.2 as a Python module crashes when it ends.
"""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty

# A bucket is a set of 16-pixel tiles.
TILE_PIXELS = 16


_NOT_ANIMATED = {"options": set()}


def _number(kind, name, description, default, limits, usual=None, **more):
    """`limits`: (least, most); sliders end at those of `usual`."""
    (least, most), (low, high) = limits, usual or limits
    ends = {"min": least, "max": most, "soft_min": low, "soft_max": high}
    return kind(name=name, description=description, default=default, **ends, **more)


def _whole(*values, **more):
    return _number(IntProperty, *values, **more)


def _real(*values, **more):
    return _number(FloatProperty, *values, **{"precision": 2, **more})


def _switch(name, description, default, **more):
    return BoolProperty(name=name, description=description, default=default, **more)


def _choice(name, description, default, *items, **more):
    """`items`: (identifier, name, description), numbered as they stand."""
    numbered = tuple((*item, number) for number, item in enumerate(items))
    return EnumProperty(name=name, description=description, default=default, items=numbered, **more)


class GranitaSceneSettings(bpy.types.PropertyGroup):
    device: _choice(
        "Device",
        "What computes the picture",
        "AUTO",
        ("AUTO", "Automatic", "The CPU"),
        ("CPU", "CPU", "All processor cores that Blender may use"),
        ("GPU", "GPU", "OpenGL 4.5; without it the CPU, with a warning"),
        **_NOT_ANIMATED,
    )
    samples: _whole(
        "Samples",
        "Visibility samples a pixel, each with its own place, time and lens point. "
        "More samples: less noise in edges, motion blur and depth of field. Powers of two, best "
        "of four (16, 64, 256), are the cleanest for their time",
        64,
        (1, 4096),
        usual=(1, 1024),
    )
    preview_samples: _whole(
        "Preview Samples",
        "Visibility samples a pixel of the finished picture in a 3D view. They cost little beside dicing and "
        "shading: as many as of the final frame show what it will be",
        64,
        (1, 4096),
        usual=(1, 1024),
    )
    preview_moving: _choice(
        "While Moving",
        "Size of the first picture of an edit in a 3D view, before the picture itself",
        "AUTO",
        ("AUTO", "Automatic", "As large as a tenth of a second allows"),
        ("2", "1/2", "Half as wide and high: finer, later"),
        ("4", "1/4", "A quarter as wide and high"),
        ("8", "1/8", "An eighth as wide and high: at once"),
        **_NOT_ANIMATED,
    )
    preview_pause: _switch(
        "Pause",
        "3D views stay as they are, whatever is edited: nothing is read and nothing rendered",
        False,
        **_NOT_ANIMATED,
    )
    sampling: _choice(
        "Sampling",
        "How samples are spread over pixels, the shutter and the lens",
        "INDEPENDENT",
        (
            "INDEPENDENT",
            "Independent",
            "Every sample has its own shutter time and lens point: fine grain",
        ),
        (
            "INTERLEAVED",
            "Interleaved",
            "Neighbouring pixels share a few hundred times and lens points",
        ),
        (
            "REGULAR",
            "Regular",
            "The same sample pattern in every pixel, repeated for a number of shutter times (the classic "
            "multipass method). Fast on a GPU; may show strobing",
        ),
    )
    time_samples: _whole(
        "Time Samples",
        "Regular sampling: shutter times and lens points for which the sample pattern is repeated; "
        "more cost more and strobe less. 0 = as many as the filter and the motion ask for",
        0,
        (0, 4096),
    )
    pixel_filter: _choice(
        "Pixel Filter",
        "How samples are averaged into pixels",
        "BLACKMAN_HARRIS",
        ("BOX", "Box", "Plain average: hard and aliased"),
        ("TENT", "Tent", "Linear falloff (natural width 2)"),
        ("GAUSSIAN", "Gaussian", "Soft"),
        ("BLACKMAN_HARRIS", "Blackman-Harris", "Soft, with less ringing; the usual choice"),
        ("MITCHELL", "Mitchell", "Slightly sharpening (natural width 4)"),
        ("CATMULL_ROM", "Catmull-Rom", "Sharpening (natural width 4)"),
        ("LANCZOS", "Lanczos", "Strongly sharpening, may ring (natural width 6)"),
        ("BSPLINE", "B-Spline", "Very soft, never rings (natural width 4)"),
    )
    filter_width: _real(
        "Filter Width",
        "Width of the pixel filter, in pixels. Box, Gaussian and Blackman-Harris: "
        "the number means what it means in Cycles; the others: the whole support",
        1.5,
        (0.01, 32.0),
        usual=(0.01, 10.0),
    )
    film_exposure: _real(
        "Exposure",
        "Brightness of the picture and of its passes of light, before the compositor: 2 is twice as "
        "bright. Cycles' Film Exposure counts where its add-on is enabled",
        1.0,
        (0.0, 10.0),
    )
    noise_threshold: _real(
        "Noise Threshold",
        "Error of displayed colour below which a tile of 16 x 16 pixels takes no more samples; Samples is then the "
        "most that any takes. 0.01 is hardly seen; 0: every pixel takes all Samples",
        0.0,
        (0.0, 1.0),
        usual=(0.0, 0.1),
        precision=4,
    )
    min_samples: _whole(
        "Min Samples",
        "Samples that every pixel takes at least, where there is a Noise Threshold. Fewer may miss what is small",
        16,
        (1, 4096),
    )
    light_samples: _whole(
        "Light Samples",
        "Shadow rays from each shaded point to each light that has a size and to the world, and ways of bounced light; "
        "for up to 64 Samples: 128 and more take twice as many, 256 four times, where there is no Noise Threshold",
        16,
        (1, 4096),
        usual=(1, 64),
    )
    bounces: _choice(
        "Bounces",
        "How far light is followed from surface to surface: reflections, light off walls",
        "FULL",
        ("NONE", "None", "Lamps, meshes that shine and the world alone light surfaces: fastest"),
        ("FAST", "Fast", "Two bounces at most, within Cycles' limits"),
        (
            "FULL",
            "Full",
            "As many as Cycles' Light Paths allow: the picture that the file has there",
        ),
    )
    shading_threshold: _real(
        "Shading Threshold",
        "Bend of displayed colour between neighbouring shading points from which on samples are shaded by "
        "themselves, for 64 Samples; it shrinks as these grow. Smaller: edges of shadows, textures and cut-outs, "
        "highlights and light that changes within the shutter are finer, and take longer. 0: wherever colour bends by more than its noise; 1000: never",
        0.06,
        (0.0, 1000.0),
        usual=(0.0, 1.0),
    )
    seed: _whole("Seed", "Another number gives another pattern of noise", 0, (0, 2**31 - 1))
    animate_seed: _switch(
        "Animate Seed", "Another pattern of noise in every frame", False, **_NOT_ANIMATED
    )
    dicing_rate: _real(
        "Dicing Rate",
        "Edge length of a micropolygon, in pixels. Smaller: finer geometry and "
        "displacement, more memory and time",
        1.0,
        (0.05, 100.0),
        usual=(0.25, 8.0),
    )
    shading_rate: _real(
        "Shading Rate",
        "Distance between shaded points, in pixels; 0 = at the micropolygons' corners",
        0.0,
        (0.0, 100.0),
        usual=(0.0, 8.0),
    )
    motion_factor: _real(
        "Motion Factor",
        "How much coarser geometry and shading are where motion blurs them: faster, and softer if more. "
        "1 = micropolygons no shorter than a sixteenth of the motion, which does not show; 0 = as fine as "
        "if it stood still",
        1.0,
        (0.0, 16.0),
        usual=(0.0, 4.0),
    )
    focus_factor: _real(
        "Focus Factor",
        "How much coarser geometry and shading are where they are out of focus: faster, and softer if "
        "more. 1 = micropolygons no smaller than a sixteenth of the circle of confusion, which does not "
        "show; 0 = as fine as if it were sharp",
        1.0,
        (0.0, 16.0),
        usual=(0.0, 4.0),
    )
    grid_size: _whole(
        "Grid Size",
        "Most micropolygons in a grid, the unit that is shaded at once",
        256,
        (1, 65536),
        **_NOT_ANIMATED,
    )
    bucket_size: _whole(
        "Bucket Size",
        "Edge of the square that a thread renders at a time, in pixels: a multiple of "
        "16 (others are rounded up); with many samples a pixel it is less. "
        "It changes memory and time, never the picture",
        64,
        (TILE_PIXELS, 1024),
        step=TILE_PIXELS,
        **_NOT_ANIMATED,
    )
    z_batch_size: _whole(
        "Z-Batch Size",
        "Transparent grids that are taken together: peeled (Regular sampling on the GPU), or hidden "
        "before full samples are looked for (else). Changes the time, never the picture",
        26,
        (1, 65536),
    )
    opacity_threshold: _real(
        "Opacity Threshold",
        "Surfaces behind this much accumulated opacity (0 to 1) are ignored; 1 = never",
        0.996,
        (0.0, 1.0),
        precision=3,
    )
    motion_steps: _whole(
        "Motion Steps",
        "Most moments in the shutter at which moving and deforming geometry is read, "
        "rounded up to an odd number. Only paths that bend are read that often; between the moments "
        "things move on straight lines",
        17,
        (1, 129),
        usual=(1, 33),
        **_NOT_ANIMATED,
    )


class GranitaObjectSettings(bpy.types.PropertyGroup):
    """Read only where Cycles' add-on, whose settings of the same names win, is not enabled."""

    use_motion_blur: _switch(
        "Motion Blur", "The object, or the camera, is blurred by its motion", True
    )
    use_deform_motion: _switch("Deformation", "The object is blurred by its deformation too", True)
    motion_steps: _whole(
        "Steps",
        "The object is read at 2 to this power moments of the shutter, and one, at least",
        1,
        (1, 7),
    )


_OWNERS = (
    (bpy.types.Scene, GranitaSceneSettings),
    (bpy.types.Object, GranitaObjectSettings),
)


def register():
    for owner, settings in _OWNERS:
        bpy.utils.register_class(settings)
        owner.granita = PointerProperty(type=settings)


def unregister():
    for owner, settings in reversed(_OWNERS):
        del owner.granita
        bpy.utils.unregister_class(settings)
