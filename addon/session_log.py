# SPDX-License-Identifier: GPL-3.0-or-later
"""What final frames of this process told the artist, for "Open Log" in the preferences.

Blender's own list of reports goes with its window and is not kept in the background.  The newest lines
alone stay: a night of frames does not grow it.
"""

import os
import time
from collections import deque
from pathlib import Path

from . import bridge
from .export.base.report import escaped

LINES = 1000
NAME = "granita-log.txt"
_lines = deque(maxlen=LINES)


def note(kind, about, text):
    """`kind`: "warning", "error" or "layer"; `about`: frame and view layer."""
    place = f"frame {about['frame']}" + (f", {about['view_layer']}" if about["view_layer"] else "")
    _lines.append(escaped(f"{time.strftime('%H:%M:%S')} {place}: {kind}: {text}"))


def text(system_report):
    """The whole log: the report, what was told, and the newest crash that a process left here."""
    parts = [system_report, "".join(f"{line}\n" for line in _lines) or "No frame told anything.\n"]
    if crash := _newest_crash():
        parts.append(f"The newest crash, {crash}:\n{crash.read_text(errors='replace')}")
    return "\n".join(parts)


def _newest_crash():
    """Of this user: the folder is everyone's."""
    files = Path(bridge.crash_file()).parent.glob("granita-crash-*.txt")
    found = [(file.stat(), file) for file in files]
    user = os.getuid() if hasattr(os, "getuid") else 0  # as stat says where there is none
    own = [(status.st_mtime, file) for status, file in found if status.st_uid == user]
    return max(own)[1] if own else None


def clear():
    _lines.clear()
