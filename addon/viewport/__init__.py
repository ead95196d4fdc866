# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered shading in 3D views: what final renders show, motion blur and lens included, while one works.

    view_update, view_draw -> live_view (what has changed) -> scene_reading (a snapshot of it)
                           -> native job, coarse first -> live_picture -> the view

Blender's own thread reads the scene and takes finished tiles between two events (loop.py), native threads do the rest:
it waits for them no longer than the window takes to be drawn, for the first picture of an edit alone.  No thread of
Python's is made, and no reference to anything of Blender's outlives a call.
"""
