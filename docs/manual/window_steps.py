# SPDX-License-Identifier: GPL-3.0-or-later
"""Steps in a window of Blender, which draws between any two of them."""

import bpy


def take_steps(steps):
    """`steps`: a generator that yields the seconds to wait, and quits Blender at its end; what it raises quits it too."""

    def step():
        try:
            return next(steps, None)
        except BaseException:
            bpy.ops.wm.quit_blender()
            raise

    bpy.app.timers.register(step, first_interval=1.0)
