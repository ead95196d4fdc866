# SPDX-License-Identifier: GPL-3.0-or-later
"""No half picture under a frame's name: what Blender wrote of a Granita frame is looked at.

On a full disk Blender's own writer of OpenEXR leaves half a file, says "Saved" and ends with exit code 0 (measured in
3.4, with every engine), and that of PNG leaves half a file beside its error.  Such a file is taken away, and the
process of a farm ends with 1.  What is whole gets the frame's name (`unfinished_file.py`).  Where Blender could not even
open a file it ends with 1 by itself, but tells machines nothing and of PNG a wrong reason: the right one is told here.
"""

import os
import shutil
import sys
import time
from pathlib import Path

import bpy

from . import command_line, final_file, leftover_files, unfinished_file
from .event_log import EventLog
from .export.base.report import escaped
from .handlers import registration
from .whole_file import fault, is_whole


class _Frame:
    """Of the render that runs."""

    began = 0.0
    number = 0  # a cancelled animation has gone back to its scene's own
    scene = ""
    is_given_up = False  # an engine has said why
    problem = ""
    swept = None  # the folder that was looked through last


def problem():
    """What became of an earlier frame of this render; empty where all is well."""
    return _Frame.problem


def _render_begins(*_):
    _Frame.problem, _Frame.swept = "", None


def _frame_begins(scene, *_):
    unfinished_file.put_back(scene)
    _Frame.began, _Frame.number = time.time(), scene.frame_current
    _Frame.scene, _Frame.is_given_up = scene.name, False


def is_given_up():
    """Once an engine left a frame undone: Blender saves none."""
    _Frame.is_given_up = True


def is_rendered():
    """Once a frame's engines are done: what is left is the compositor and the saving."""
    scene = None if _Frame.is_given_up else bpy.data.scenes.get(_Frame.scene)
    if scene and scene.render.engine == "GRANITA" and unfinished_file.set_aside(scene):
        _sweep(Path(scene.render.frame_path()).parent)


def _sweep(folder):
    """Once for all frames of a render: a farm's folder may hold a hundred thousand."""
    if folder == _Frame.swept:
        return
    _Frame.swept = folder
    for path in leftover_files.sweep(folder):
        print(
            f"Granita: removed '{escaped(path)}', half a file of a render that was ended",
            flush=True,
        )


def _is_saved(scene, *_):
    """Of what nobody saved there is no file; of other files nothing is known here."""
    aside = unfinished_file.put_back(scene)
    if scene.render.engine != "GRANITA" or not aside or not aside[0].exists():
        return
    if lost := _name_it(*aside):
        _lose(lost)


def _look_at_written(scene, *_):
    if scene.render.engine != "GRANITA":
        return
    for path in _take_away(scene):
        _lose(f"'{path}' was not written whole and is removed: the disk may be full")
    if _Frame.problem and bpy.app.background and bpy.app.binary_path:
        shutil.rmtree(bpy.app.tempdir, ignore_errors=True)
        sys.stdout.flush()
        os._exit(1)


def _look_at_cancelled(scene, *_):
    if scene.render.engine != "GRANITA":
        return
    if aside := unfinished_file.put_back(scene):
        file, final = aside
        if lost := _name_it(file, final) if file.exists() else _unopened(file, final):
            _tell(lost)
    # In a window nothing was begun: what lies there without an end is another's.
    for path in _take_away(scene) if bpy.app.background else ():
        print(f"Granita: removed '{escaped(str(path))}', half of a file", flush=True)


def _lose(text):
    _Frame.problem = text
    _tell(text)


def _tell(text):
    EventLog(command_line.log_kind(), _Frame.number).error(text)
    # A frame that was written is no longer the engine's: it cannot fail any more.
    print(f"Error: Granita: {escaped(text)}", file=sys.stderr, flush=True)


def _name_it(file, final):
    """Gives a whole file the frame's name; returns what is wrong."""
    try:
        if not (cause := fault(file)):
            final_file.take_name(file, final)
            print(f"Saved: '{escaped(str(final))}'", flush=True)
            return ""
        file.unlink()
    except OSError as error:
        return f"'{final}' could not be written: {error.strerror}; the frame is in '{file}'"
    left = "; the one that was there before is left" if final.exists() else ""
    return f"'{final}' was not written whole and is removed: {cause}{left}"


def _unopened(file, final):
    """Of a frame of which Blender left nothing; empty where nothing hinders it: then somebody stopped Blender before."""
    cause = final_file.why_not_opened(file)
    return f"'{final}' could not be written: {cause}" if cause else ""


def _take_away(scene):
    """Removes those files of the frame that this render began and did not end; returns their names."""
    taken = []
    for path in [] if scene.render.is_movie_format else _paths(scene):
        try:
            # The clock of a network's file system may be a little behind.
            if path.stat().st_mtime >= _Frame.began - 2.0 and not is_whole(path):
                path.unlink()
                taken.append(path)
        except OSError:
            continue  # there is none, or none of ours
    return taken


def _paths(scene):
    """Of an animation's frame, and of a still's."""
    render = scene.render
    still = bpy.path.abspath(render.filepath)
    ending = render.file_extension if render.use_file_extension else ""
    names = {render.frame_path(frame=_Frame.number), still}
    if not still.lower().endswith(ending):
        names.add(still + ending)
    return [Path(name) for name in sorted(names) if name]


register, unregister = registration(
    ("render_init", _render_begins),
    ("render_pre", _frame_begins),
    ("render_post", _is_saved),
    ("render_write", _look_at_written),
    ("render_cancel", _look_at_cancelled),
)
