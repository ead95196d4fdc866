# SPDX-License-Identifier: GPL-3.0-or-later
"""A digest of all that a picture depends on: parts of one frame have the same."""

import hashlib
from functools import lru_cache
from pathlib import Path

import numpy as np

# No bit of the picture depends on these (docs/scene_snapshot.md); `crop` is what parts differ in.
_FREE = {"crop", "device", "executor", "threads", "bucket_size", "z_batch_size"}
_FREE |= {"list_memory", "memory"}


def picture_digest(snapshot):
    """Hex digits for a scene snapshot.

    Image files count by name and size: machines of a farm have them in folders of their own, with
    dates of their own.
    """
    options = {key: value for key, value in snapshot["options"].items() if key not in _FREE}
    images = [{**image, "path": _file(image["path"])} for image in snapshot.get("images", ())]
    digest = hashlib.blake2b(digest_size=16)
    _add(digest, {**snapshot, "options": options, "images": images})
    return digest.hexdigest()


@lru_cache(maxsize=4)
def file_digest(path):
    """Hex digits for a file's content; "" where it cannot be read."""
    try:
        return hashlib.blake2b(Path(path).read_bytes(), digest_size=16).hexdigest()
    except OSError:
        return ""


def _file(path):
    try:
        return (Path(path).name, Path(path).stat().st_size) if path else ""
    except OSError:
        return (Path(path).name, None)


def _add(digest, value):
    if isinstance(value, dict):
        digest.update(b"{%d" % len(value))
        for key in sorted(value):
            _add(digest, key)
            _add(digest, value[key])
    elif isinstance(value, (list, tuple)):
        digest.update(b"[%d" % len(value))
        for item in value:
            _add(digest, item)
    elif isinstance(value, np.ndarray):
        digest.update(f"{value.dtype.str}{value.shape}".encode())
        digest.update(np.ascontiguousarray(value).data)
    else:
        plain = value.item() if isinstance(value, np.generic) else value
        if not isinstance(plain, (str, bytes, int, float, type(None))):
            raise TypeError(f"a snapshot with a {type(plain).__name__} has no digest")
        digest.update(f"{type(plain).__name__} {plain!r}\n".encode("utf-8", "surrogateescape"))
