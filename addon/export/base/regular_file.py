# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a scene names, opened only where they are files: opening a pipe waits for who writes into it, and
reading a device may never end."""

import os
import stat


def open_regular_file(path, mode="r", **options):
    """As open().  Raises OSError where the path is something else, ValueError where it can name nothing."""
    if not _is_regular(path):
        raise OSError(f"{path} is no file")
    return open(path, mode, **options)


def is_no_file(path):
    """Whether something else is there."""
    try:
        return not _is_regular(path)
    except (OSError, ValueError):
        return False


def _is_regular(path):
    return stat.S_ISREG(os.stat(path).st_mode)
