# SPDX-License-Identifier: GPL-3.0-or-later
"""Half files of frames whose process was ended while it wrote them: told by their names, and swept.

Farms share folders, so a file may be that of a frame which another machine writes at this moment.  The name says which
machine, which start of it and which process.  One that did run here and does so no longer ended; of all others nothing
is known, and no frame takes a day to be saved.  What is whole is somebody's frame that could not take its name, and
stays.
"""

import hashlib
import os
import platform
import re
import secrets
import stat
import time
from pathlib import Path

from .whole_file import is_whole

_DAY = 24 * 3600.0


def _processes():
    """What tells apart whose numbers of processes these are: starts of a machine, and containers, which share names."""
    try:
        start = Path("/proc/sys/kernel/random/boot_id").read_text()
        told = start + os.readlink("/proc/self/ns/pid")
    except OSError:
        return ""
    return hashlib.sha256(told.encode()).hexdigest()[:8]


_PROCESSES = _processes()
_OURS = f".unfinished-{platform.node()}-{_PROCESSES or 'unknown'}-"
# Of two machines that render the same frame neither may fill the other's file.
PREFIX = f"{_OURS}{os.getpid()}-{secrets.token_hex(3)}-"
_LEFTOVER = re.compile(r"\.unfinished-.+-(?:[0-9a-f]{8}|unknown)-(\d+)-[0-9a-f]{6}-.", re.DOTALL)


def sweep(folder):
    """Removes what ended processes left in a folder; returns the paths, sorted.  What cannot be looked at stays."""
    try:
        entries = [entry for entry in os.scandir(folder) if entry.name.startswith(".unfinished-")]
    except OSError:
        return []
    return sorted(entry.path for entry in entries if _is_leftover(entry) and _remove(entry.path))


def _is_leftover(entry):
    if not (named := _LEFTOVER.match(entry.name)):
        return False
    try:
        status = entry.stat(follow_symlinks=False)
        if not stat.S_ISREG(status.st_mode):
            return False
        ended = _has_ended(entry.name, int(named[1])) or time.time() - status.st_mtime > _DAY
        return ended and not is_whole(entry.path)
    except OSError:
        return False


def _has_ended(name, process):
    """Whether it ran here and does so no longer; False where that cannot be told."""
    if os.name != "posix" or not _PROCESSES or not name.startswith(f"{_OURS}{process}-"):
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False
    return False


def _remove(path):
    try:
        os.unlink(path)
    except OSError:
        return False
    return True
