# SPDX-License-Identifier: GPL-3.0-or-later
"""Until a frame's file is whole it has another name: whoever ends Blender within its writing cuts nothing off.

Blender opens a picture under its own name and fills it.  In background the output path has therefore a prefix, from
the end of a frame's render until it is saved; then the file is renamed, which is done whole or not at all.  Whether
a frame is there already, Blender asks before that, and movies and the compositor's files are not concerned; nor are
frames that other files are named after: the previews of OpenEXR, the drawings of Freestyle's exporter.
"""

import os
from pathlib import Path

import bpy

from .leftover_files import PREFIX

_LONGEST = 255  # bytes of a file's name


class _Renamed:
    """What was changed in a scene, to be put back."""

    scene = None
    filepath = ""
    prefixed = ""
    file = final = Path()


def set_aside(scene):
    """The frame that `scene` saves next will lie beside its place; returns whether.  Nothing is changed where it can be
    seen."""
    put_back(scene)
    render = scene.render
    names_others = render.image_settings.use_preview or render.use_freestyle
    if not bpy.app.background or render.is_movie_format or render.use_multiview or names_others:
        return False
    folder, name = os.path.split(render.filepath)
    final, prefixed = Path(render.frame_path()), os.path.join(folder, PREFIX + name)
    # Links stay links, and what cannot be looked at Blender may try.
    if len(os.fsencode(PREFIX + final.name)) > _LONGEST or os.path.islink(final):
        return False
    _Renamed.scene, _Renamed.filepath = scene.name, render.filepath
    render.filepath = prefixed
    _Renamed.prefixed = render.filepath  # Blender cuts off what is too long
    _Renamed.file, _Renamed.final = Path(render.frame_path()), final
    return True


def put_back(scene):
    """Gives the scene its output path again; returns (file, final path), or None where nothing was set aside."""
    if _Renamed.scene != scene.name:
        return None
    _Renamed.scene = None
    if scene.render.filepath == _Renamed.prefixed:  # else it was changed by another meanwhile
        scene.render.filepath = _Renamed.filepath
    return _Renamed.file, _Renamed.final
