# SPDX-License-Identifier: GPL-3.0-or-later
"""Part files: the exact values of every pass in a rectangle of a frame, with what they belong to.

    "granita part 1\\n"   what it is
    SHA-256              of all that follows: a file cut short or changed is found
    length               of the header, 8 bytes, little-endian
    header               JSON, below
    values               float32 [height, width, channels] pass by pass, lowest row first

The header has `part` [k, n], `rect` and `crop` (pixels of the frame), `passes` [[name, channels]] and,
as given by whoever wrote it, what the picture is of.
"""

import contextlib
import hashlib
import json
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..whole_file import flush

MAGIC = b"granita part 1\n"


class PartError(Exception):
    """A part cannot be written, read or joined; the text names its file and says why."""


@dataclass
class Part:
    header: dict
    passes: dict  # name -> float32 [height, width, channels]


def file_name(frame, layer, part):
    """In a folder of parts; a view layer's name may hold what no file's may."""
    plain = "".join(c if c.isalnum() or c in "-_" else f"%{ord(c):x}" for c in layer)
    return f"{frame:04}.{plain}.{part[0]}-of-{part[1]}.part"


def write(path, header, passes):
    """Leaves a whole file under the name, or none.  Raises PartError."""
    header = {**header, "passes": [[name, v.shape[2]] for name, v in passes.items()]}
    text = json.dumps(header).encode()
    chunks = [len(text).to_bytes(8, "little"), text]
    chunks += [np.ascontiguousarray(v, dtype="<f4").tobytes() for v in passes.values()]
    digest = hashlib.sha256()
    for chunk in chunks:
        digest.update(chunk)
    path = Path(path)
    unfinished = path.with_name(f"{path.name}.{os.getpid()}.unfinished")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with open(unfinished, "wb") as file:
            file.writelines([MAGIC, digest.digest(), *chunks])
            flush(file)
        os.replace(unfinished, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            unfinished.unlink()
        raise PartError(f"part file '{path}' cannot be written: {error.strerror}") from error


def read(path):
    """Returns the Part.  Raises PartError where there is none, or not all of it."""
    try:
        data = Path(path).read_bytes()
    except FileNotFoundError as error:
        raise PartError(f"a part is missing: there is no file '{path}'") from error
    except OSError as error:
        raise PartError(f"part file '{path}' cannot be read: {error.strerror}") from error
    if not data.startswith(MAGIC):
        raise PartError(f"'{path}' is not a part file of this version of Granita")
    begin = len(MAGIC) + 32
    if hashlib.sha256(memoryview(data)[begin:]).digest() != data[len(MAGIC) : begin]:
        raise PartError(f"part file '{path}' is damaged: render this part again")
    length = int.from_bytes(data[begin : begin + 8], "little")
    at = begin + 8 + length
    header = json.loads(data[begin + 8 : at])
    x0, y0, x1, y1 = header["rect"] or (0, 0, 0, 0)
    passes = {}
    for name, channels in header["passes"]:
        shape = (y1 - y0, x1 - x0, channels)
        end = at + 4 * shape[0] * shape[1] * channels
        # A slice is a copy, and so aligned as Blender wants it.
        passes[name] = np.frombuffer(data[at:end], "<f4").reshape(shape)
        at = end
    return Part(header, passes)
