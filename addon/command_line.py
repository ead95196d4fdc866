# SPDX-License-Identifier: GPL-3.0-or-later
"""Granita's own options on Blender's command line, after `--`.

    --granita-device cpu|gpu|auto   overrides scene.granita.device
    --granita-stats FILE            appends one JSON object a frame (frame_statistics.py)
    --granita-threads N             overrides Blender's thread count; 0 = all
    --granita-memory MIB            a frame for which the process would hold more is given up (frame_memory.py)
    --granita-log json|openjd       lines for machines on the standard output (event_log.py)
    --granita-part K/N              renders the K-th of N parts of the frame into a part file (parts/)
    --granita-cut N                 looks at the frame and cuts it into N parts of about the same cost
    --granita-merge N               joins the N part files of the frame instead of rendering it
    --granita-parts FOLDER          of the part files; default: beside the output, named after it

`--granita-device=cpu` is the same.  Other words after `--` belong to others and are left alone.
"""

import sys
from dataclasses import dataclass
from itertools import pairwise

from .event_log import KINDS as LOG_KINDS

PREFIX = "--granita-"
MOST_PARTS = 4096
MOST_MEMORY = 1 << 30  # MiB


class CommandLineError(Exception):
    """An option is unknown or has a bad value; the text names it."""


@dataclass
class CommandLine:
    device: str | None = None  # AUTO, CPU or GPU
    stats: str | None = None  # path of a file
    threads: int | None = None
    memory: int | None = None  # MiB
    log: str | None = None  # of event_log.KINDS
    part: tuple | None = None  # (K, N)
    cut: int | None = None  # N
    merge: int | None = None  # N
    parts: str | None = None  # path of a folder


def parse(argv=None):
    """Returns the CommandLine of `argv` (default: this process).  Raises CommandLineError."""
    values = CommandLine()
    for option, value in _options(argv):
        reader = _READERS.get(option)
        if reader is None:
            raise CommandLineError(f"unknown option {option} (known: {', '.join(_READERS)})")
        if not value:
            raise CommandLineError(f"option {option} needs a value")
        setattr(values, option[len(PREFIX) :], reader(option, value))
    if sum(value is not None for value in (values.part, values.cut, values.merge)) > 1:
        raise CommandLineError("--granita-part, -cut and -merge exclude one another")
    return values


def log_kind(argv=None):
    """Of event_log.KINDS, what `--granita-log` asks for, whatever is wrong with other options; None without it."""
    named = [value for option, value in _options(argv) if option == PREFIX + "log"]
    return named[-1] if named and named[-1] in LOG_KINDS else None


def _options(argv):
    """(option, value) in turn; a value is empty where there is none."""
    argv = sys.argv if argv is None else argv
    words = argv[argv.index("--") + 1 :] if "--" in argv else []
    for word, after in pairwise([*words, ""]):
        if word.startswith(PREFIX):
            option, has_value, value = word.partition("=")
            value = value if has_value else after
            yield option, "" if value.startswith("--") else value


def _device(option, value):
    if value.lower() not in ("cpu", "gpu", "auto"):
        raise CommandLineError(f"option {option}: '{value}' is not one of cpu, gpu, auto")
    return value.upper()


def _path(option, value):
    return value


def _number(least, most):
    def read(option, value):
        if not (value.isascii() and value.isdigit() and least <= int(value) <= most):
            text = f"'{value}' is not a number from {least} to {most}"
            raise CommandLineError(f"option {option}: {text}")
        return int(value)

    return read


def _log(option, value):
    if value not in LOG_KINDS:
        raise CommandLineError(f"option {option}: '{value}' is not one of {', '.join(LOG_KINDS)}")
    return value


_parts = _number(1, MOST_PARTS)


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
    PREFIX + "threads": _number(0, 1024),
    PREFIX + "memory": _number(1, MOST_MEMORY),
    PREFIX + "log": _log,
    PREFIX + "part": _part,
    PREFIX + "cut": _parts,
    PREFIX + "merge": _parts,
    PREFIX + "parts": _path,
}
