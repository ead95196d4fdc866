# SPDX-License-Identifier: GPL-3.0-or-later
"""The file under a frame's own name: whole, another's as it was, or none."""

import contextlib
import os
import shutil

from .whole_file import flush


def take_name(file, final):
    """Where `final` may be filled but not replaced (another's in a sticky folder, one that is mounted), it is filled.
    Raises OSError, and `file` is left: `final` is then as it was, gone, or, where it may not be removed either, empty."""
    try:
        os.replace(file, final)
    except OSError:
        _fill(final, file)
        file.unlink()


def _fill(final, file):
    with open(file, "rb") as source:
        target = open(final, "wb")
        try:
            with target:
                shutil.copyfileobj(source, target)
                flush(target)
        except OSError:  # it is closed: nothing is written any more
            _remove_or_empty(final)
            raise


def _remove_or_empty(file):
    """An empty file is no half picture to anybody.  Of both failures the first is what there is to tell."""
    try:
        file.unlink()
    except OSError:
        with contextlib.suppress(OSError):
            os.truncate(file, 0)


def why_not_opened(file):
    """The operating system's reason, asked by trying again what Blender tried; empty where it has none any more.
    Nothing is left of the trial."""
    missing = [folder for folder in file.parents if not os.path.lexists(folder)]
    try:
        with contextlib.suppress(FileExistsError):
            file.parent.mkdir(parents=True)
        file.touch(exist_ok=False)
        file.unlink()
    except OSError as error:
        return error.strerror
    finally:
        for folder in missing:  # the innermost first
            with contextlib.suppress(OSError):
                folder.rmdir()
    return ""
