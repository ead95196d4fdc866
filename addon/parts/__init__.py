# SPDX-License-Identifier: GPL-3.0-or-later
"""One frame over many machines: parts of it are rendered by themselves and joined again.

    blender ... -f 1 -- --granita-part 3/8     renders the third of eight parts into a part file
    blender ... -f 1 -- --granita-cut 8        before: parts of equal cost, by a coarse look
    blender ... -f 1 -- --granita-merge 8      reads all eight instead of rendering

The joined frame goes the way of every frame (passes, compositor, colour management, file format)
and is bit-equal to one rendered whole: no pixel depends on the crop (docs/architecture.md).
"""
