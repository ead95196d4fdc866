# SPDX-License-Identifier: GPL-3.0-or-later
"""Where parts lie, and what Blender itself saves of a frame of which one part alone was rendered.

Blender saves a picture for every frame that it renders.  Of a part it must not have the frame's name, nor
pass through the compositor, whose file outputs have names of their own: for the length of the
render it goes to the folder of parts.
"""

from pathlib import Path

import bpy

from .. import command_line
from ..handlers import registration
from .frame_cut import CUT


def folder_of(options, filepath):
    """The folder that the command line names, else one beside the output path."""
    if options.parts:
        return Path(bpy.path.abspath(options.parts))
    path = bpy.path.abspath(filepath)
    return (
        Path(path) / "parts"
        if path.endswith(("/", "\\"))
        else Path(path.rstrip("#_.- ") + ".parts")
    )


class _Redirected:
    """What was changed in a scene, to be put back."""

    scene = None
    filepath = ""
    use_compositing = use_sequencer = False


def output_path(scene):
    """The output path that the file has."""
    return _Redirected.filepath if _Redirected.scene == scene.name else scene.render.filepath


def redirect(scene, *_):
    """Before Blender copies the render settings."""
    if scene.render.engine != "GRANITA":
        return
    try:
        options = command_line.parse()
    except command_line.CommandLineError:
        return  # told by the render
    if options.part is None and options.cut is None:
        return
    put_back(scene)
    render = scene.render
    _Redirected.scene, _Redirected.filepath = scene.name, render.filepath
    _Redirected.use_compositing = render.use_compositing
    _Redirected.use_sequencer = render.use_sequencer
    number, count = options.part or (CUT, options.cut)
    folder = folder_of(options, render.filepath)
    render.filepath = str(folder / f"part_{number}-of-{count}_####")
    render.use_compositing = render.use_sequencer = False


def put_back(scene, *_):
    if _Redirected.scene != scene.name:
        return
    render = scene.render
    render.filepath = _Redirected.filepath
    render.use_compositing = _Redirected.use_compositing
    render.use_sequencer = _Redirected.use_sequencer
    _Redirected.scene = None


register, unregister = registration(
    ("render_init", redirect), ("render_complete", put_back), ("render_cancel", put_back)
)
