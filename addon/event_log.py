# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines for machines on the standard output, asked for by `--granita-log`.

json    one object a line: {"event": "progress" | "warning" | "error" | "layer", "frame", ...}
openjd  what Open Job Description takes from a task's output: openjd_progress, openjd_status,
        openjd_fail (https://github.com/OpenJobDescription/openjd-specifications, "How Jobs Are Run")

Blender's own lines stay beside them.  What is told is told in both forms of output: to the artist
in words, here in fields.  The session's log keeps it too, asked for or not.
"""

import json
import sys

from . import session_log

KINDS = ("json", "openjd")


class EventLog:
    def __init__(self, kind=None, frame=0, layer=""):
        """`kind`: of KINDS, or None: then nothing is written."""
        self._kind = kind
        self._about = {"frame": int(frame), "view_layer": layer}

    def progress(self, fraction, remaining=None):
        """`fraction` of the frame; `remaining` in seconds of the view layer, None where it is not known yet."""
        if self._kind == "json":
            self._json("progress", fraction=round(fraction, 4), remaining=remaining)
        elif self._kind == "openjd":
            _print(f"openjd_progress: {100.0 * min(max(fraction, 0.0), 1.0):.1f}")

    def warning(self, text):
        session_log.note("warning", self._about, text)
        if self._kind == "json":
            self._json("warning", text=text)

    def error(self, text):
        session_log.note("error", self._about, text)
        if self._kind == "json":
            self._json("error", text=text)
        elif self._kind == "openjd":
            _print(f"openjd_fail: {_line(text)}")

    def layer(self, seconds):
        """A view layer is done; `seconds` by stage."""
        session_log.note("layer", self._about, f"{seconds.get('total', 0.0):.2f} s")
        if self._kind == "json":
            self._json("layer", seconds={name: round(s, 3) for name, s in seconds.items()})
        elif self._kind == "openjd":
            frame = self._about["frame"]
            _print(f"openjd_status: frame {frame}: {seconds.get('total', 0.0):.1f} s")

    def _json(self, event, **values):
        _print(json.dumps({"event": event, **self._about, **values}))


def _line(text):
    """Names of datablocks may hold anything; a line is a line."""
    return " ".join(text.split())


def _print(line):
    print(line, file=sys.stdout, flush=True)
