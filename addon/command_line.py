# SPDX-License-Identifier: GPL-3.0-or-later
"""Granita's own options on Blender's command line, after `--`.

    --granita-device cpu|gpu|auto   overrides scene.granita.device
    --granita-stats FILE            appends one JSON object a frame (frame_statistics.py)
    --granita-threads N             overrides Blender's thread count; 0 = all

`--granita-device=cpu` is the same.  Other words after `--` belong to others and are left alone.
"""

import sys
from dataclasses import dataclass

PREFIX = "--granita-"


class CommandLineError(Exception):
    """An option is unknown or has a bad value; the text names it."""


@dataclass
class CommandLine:
    device: str | None = None  # AUTO, CPU or GPU
    stats: str | None = None  # path of a file
    threads: int | None = None


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


_READERS = {
    PREFIX + "device": _device,
    PREFIX + "stats": _path,
    PREFIX + "threads": _threads,
}
