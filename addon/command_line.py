# SPDX-License-Identifier: GPL-3.0-or-later
"""Granita's own options on Blender's command line, after `--`.

    --granita-device cpu|gpu|auto   overrides scene.granita.device
    --granita-stats FILE            appends one JSON object a frame (frame_statistics.py)
    --granita-threads N             overrides Blender's thread count; 0 = all
    --granita-log json|openjd       lines for machines on the standard output (event_log.py)
    --granita-part K/N              renders the K-th of N parts of the frame into a part file (parts/)
    --granita-merge N               joins the N part files of the frame instead of rendering it
    --granita-parts FOLDER          of the part files; default: beside the output, named after it

`--granita-device=cpu` is the same.  Other words after `--` belong to others and are left alone.
"""

import sys
from dataclasses import dataclass

from .event_log import KINDS as LOG_KINDS

PREFIX = "--granita-"
MOST_PARTS = 4096


class CommandLineError(Exception):
    """An option is unknown or has a bad value; the text names it."""


@dataclass
class CommandLine:
    device: str | None = None  # AUTO, CPU or GPU
    stats: str | None = None  # path of a file
    threads: int | None = None
    log: str | None = None  # of event_log.KINDS
    part: tuple | None = None  # (K, N)
    merge: int | None = None  # N
    parts: str | None = None  # path of a folder


def parse(argv=None):
    """Returns the CommandLine of `argv` (default: this process).  Raises CommandLineError."""
    argv = sys.argv if argv is None else argv
    words = iter(argv[argv.index("--") + 1 :] if "--" in argv else [])
    values = CommandLine()
    for word in words:
        if not word.startswith(PREFIX):
            continue
        option, has_value, value = word.partition("=")
        reader = _READERS.get(option)
        if reader is None:
            raise CommandLineError(f"unknown option {option} (known: {', '.join(_READERS)})")
        if not has_value:
            value = next(words, "")
        if not value or value.startswith("--"):
            raise CommandLineError(f"option {option} needs a value")
        setattr(values, option[len(PREFIX) :], reader(option, value))
    if values.part and values.merge:
        raise CommandLineError("--granita-part and --granita-merge exclude one another")
    return values


def _device(option, value):
    if value.lower() not in ("cpu", "gpu", "auto"):
        raise CommandLineError(f"option {option}: '{value}' is not one of cpu, gpu, auto")
    return value.upper()


def _path(option, value):
    return value


def _threads(option, value):
    if not (value.isascii() and value.isdigit() and int(value) <= 1024):
        raise CommandLineError(f"option {option}: '{value}' is not a number from 0 to 1024")
    return int(value)


def _log(option, value):
    if value not in LOG_KINDS:
        raise CommandLineError(f"option {option}: '{value}' is not one of {', '.join(LOG_KINDS)}")
    return value


def _parts(option, value):
    if not (value.isascii() and value.isdigit() and 1 <= int(value) <= MOST_PARTS):
        raise CommandLineError(f"option {option}: '{value}' is not a number from 1 to {MOST_PARTS}")
    return int(value)


def _part(option, value):
    number, slash, count = value.partition("/")
    if not slash:
        raise CommandLineError(f"option {option}: '{value}' is not K/N, as 3/8")
    count = _parts(option, count)
    if not (number.isascii() and number.isdigit() and 1 <= int(number) <= count):
        raise CommandLineError(f"option {option}: there is no part '{number}' of {count}")
    return int(number), count


_READERS = {
    PREFIX + "device": _device,
    PREFIX + "stats": _path,
    PREFIX + "threads": _threads,
    PREFIX + "log": _log,
    PREFIX + "part": _part,
    PREFIX + "merge": _parts,
    PREFIX + "parts": _path,
}
