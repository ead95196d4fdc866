# SPDX-License-Identifier: GPL-3.0-or-later
"""`scene.granita`: the settings that Blender itself does not have.

The names and the numbers of the enumerations are API: files keep them.  No property has an
`update` callback: with one, Blender 4.2 as a Python module crashes when it ends.
"""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty

# A bucket is a set of 16-pixel tiles.
TILE_PIXELS = 16


class GranitaSceneSettings(bpy.types.PropertyGroup):
    device: EnumProperty(
        name="Device",
        description="What computes the picture",
        items=(
            ("AUTO", "Automatic", "The graphics card where there is a usable one, else the CPU", 0),
            ("CPU", "CPU", "All processor cores that Blender may use", 1),
            (
                "GPU",
                "GPU",
                "OpenGL 4.5; without it the CPU, with a warning",
                2,
            ),
        ),
        default="AUTO",
        options=set(),
    )
    samples: IntProperty(
        name="Samples",
        description="Visibility samples a pixel, each with its own place, time and lens point. "
        "More samples: less noise in edges, motion blur and depth of field",
        default=64,
        min=1,
        max=4096,
        soft_max=1024,
    )
    sampling: EnumProperty(
        name="Sampling",
        description="How time and lens points are shared between samples",
        items=(
            ("INDEPENDENT", "Independent", "Every sample has its own time and lens point", 0),
            (
                "INTERLEAVED",
                "Interleaved",
                "A few hundred times and lens points, shared",
                1,
            ),
            (
                "REGULAR",
                "Regular",
                "The same square lattice at every time sample",
                2,
            ),
        ),
        default="INDEPENDENT",
    )
    time_samples: IntProperty(
        name="Time Samples",
        description="Regular sampling: moments (and lens points) at which the lattice is repeated; "
        "0 = chosen from the filter and the motion",
        default=0,
        min=0,
        max=4096,
    )
    pixel_filter: EnumProperty(
        name="Pixel Filter",
        description="How samples are averaged into pixels",
        items=(
            ("BOX", "Box", "Plain average: hard and aliased", 0),
            ("TENT", "Tent", "Linear falloff (natural width 2)", 1),
            ("GAUSSIAN", "Gaussian", "Soft", 2),
            ("BLACKMAN_HARRIS", "Blackman-Harris", "Soft, with less ringing; the usual choice", 3),
            ("MITCHELL", "Mitchell", "Slightly sharpening (natural width 4)", 4),
            ("CATMULL_ROM", "Catmull-Rom", "Sharpening (natural width 4)", 5),
            ("LANCZOS", "Lanczos", "Strongly sharpening, may ring (natural width 6)", 6),
            ("BSPLINE", "B-Spline", "Very soft, never rings (natural width 4)", 7),
        ),
        default="BLACKMAN_HARRIS",
    )
    filter_width: FloatProperty(
        name="Filter Width",
        description="Width of the pixel filter, in pixels. Box, Gaussian and Blackman-Harris: "
        "the number means what it means in Cycles; the others: the whole support",
        default=1.5,
        min=0.01,
        max=32.0,
        soft_max=10.0,
        precision=2,
    )
    light_samples: IntProperty(
        name="Light Samples",
        description="Shadow rays from each shaded point to each light that has a size",
        default=8,
        min=1,
        max=4096,
        soft_max=64,
    )
    seed: IntProperty(
        name="Seed",
        description="Another number gives another pattern of noise",
        default=0,
        min=0,
    )
    animate_seed: BoolProperty(
        name="Animate Seed",
        description="Another pattern of noise in every frame",
        default=False,
        options=set(),
    )
    dicing_rate: FloatProperty(
        name="Dicing Rate",
        description="Edge length of a micropolygon, in pixels. Smaller: finer geometry and "
        "displacement, more memory and time",
        default=1.0,
        min=0.05,
        max=100.0,
        soft_min=0.25,
        soft_max=8.0,
        precision=2,
    )
    shading_rate: FloatProperty(
        name="Shading Rate",
        description="Distance between shaded points, in pixels; 0 = at the micropolygons' corners",
        default=0.0,
        min=0.0,
        max=100.0,
        soft_max=8.0,
        precision=2,
    )
    motion_factor: FloatProperty(
        name="Motion Factor",
        description="How much more coarsely what moves is diced and shaded along its way: "
        "with 1 its micropolygons are no shorter than a sixteenth of the way; 0 = as if it "
        "stood still",
        default=1.0,
        min=0.0,
        max=16.0,
        soft_max=4.0,
        precision=2,
    )
    focus_factor: FloatProperty(
        name="Focus Factor",
        description="How much more coarsely what is out of focus is diced and shaded: with 1 its "
        "micropolygons are no smaller than a sixteenth of its circle of confusion; 0 = as if it "
        "were sharp",
        default=1.0,
        min=0.0,
        max=16.0,
        soft_max=4.0,
        precision=2,
    )
    grid_size: IntProperty(
        name="Grid Size",
        description="Most micropolygons in a grid, the unit that is shaded at once",
        default=256,
        min=1,
        max=65536,
        options=set(),
    )
    bucket_size: IntProperty(
        name="Bucket Size",
        description="Edge of the square that a thread renders at a time, in pixels: a multiple of "
        "16 (others are rounded up). It changes memory and time, never the picture",
        default=64,
        min=TILE_PIXELS,
        max=1024,
        step=TILE_PIXELS,
        options=set(),
    )
    z_batch_size: IntProperty(
        name="Z-Batch Size",
        description="Regular sampling on the GPU: transparent grids that are peeled together. "
        "Changes the time, never the picture",
        default=26,
        min=1,
        max=65536,
    )
    opacity_threshold: FloatProperty(
        name="Opacity Threshold",
        description="Surfaces behind this much accumulated opacity (0 to 1) are ignored; 1 = never",
        default=0.996,
        min=0.0,
        max=1.0,
        precision=3,
    )
    motion_steps: IntProperty(
        name="Motion Steps",
        description="Most moments in the shutter at which moving and deforming geometry is read, "
        "rounded up to an odd number. Only paths that bend are read that often; between the moments "
        "things move on straight lines",
        default=17,
        min=1,
        max=129,
        soft_max=33,
        options=set(),
    )


class GranitaObjectSettings(bpy.types.PropertyGroup):
    """Read only where Cycles' add-on, whose settings of the same names win, is not enabled."""

    use_motion_blur: BoolProperty(
        name="Motion Blur",
        description="The object, or the camera, is blurred by its motion",
        default=True,
    )
    use_deform_motion: BoolProperty(
        name="Deformation",
        description="The object is blurred by its deformation too",
        default=True,
    )
    motion_steps: IntProperty(
        name="Steps",
        description="The object is read at 2 to this power moments of the shutter, and one, at least",
        default=1,
        min=1,
        max=7,
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
