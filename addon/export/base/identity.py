# SPDX-License-Identifier: GPL-3.0-or-later
"""Identities of placed things that survive a change of time, of frame and of the rest of the scene.

They come from names and Blender's persistent ids alone: hiding one object leaves the keys of all
others as they were, and with the keys the order of ties and the seeds of shading.
"""

import hashlib

import numpy as np

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MASK = 0xFFFFFFFF


def name_hash(prototype):
    """64-bit hash of what is placed and of what places it, by full name (with the library)."""
    parent = prototype.parent.name_full if prototype.parent is not None else ""
    system = (prototype.system,) if prototype.system else ()
    text = "\0".join((prototype.type, prototype.source.name_full, parent, *system))
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "little")


def combine(hashes, persistent_ids):
    """Unique 64-bit identities.

    Args:
        hashes: uint64 [n], of the names.
        persistent_ids: int32 [n, 8], Blender's.

    Returns:
        uint64 [n].  Things that Blender itself cannot tell apart are told apart by their order.
    """
    identity = _scramble(hashes)
    for column in persistent_ids.T:
        identity = _scramble(identity + column.astype(np.uint64))
    return distinct(identity)


def distinct(identity):
    """uint64 [n], unique: all but the first of equal identities replaced, by their order."""
    return _separate(identity, lambda value, ordinal: _scramble(value + ordinal))


def short_keys(identity):
    """uint32 [n], unique, of unique uint64 identities; nearly always the upper half.

    Halves that meet by chance are moved on in the order of the identities, so that the result does
    not depend on the order of the list.
    """
    order = np.argsort(identity, kind="stable")
    upper = (identity[order] >> np.uint64(32)).astype(np.uint64)
    moved = _separate(upper, lambda value, ordinal: (value + ordinal) & np.uint64(_MASK))
    keys = np.empty(len(identity), dtype=np.uint32)
    keys[order] = moved.astype(np.uint32)
    return keys


def random_of_name(name):
    """Object Info's Random of what is no instance: 0 to 1, as Cycles has it, so pictures agree."""
    return _jenkins(_string_hash(name), 0) / _MASK


def _scramble(values):
    """Splitmix64's finalizer (Steele et al. 2014): one bit in changes half of those out."""
    with np.errstate(over="ignore"):
        values = values + _GOLDEN
        values = (values ^ (values >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        values = (values ^ (values >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return values ^ (values >> np.uint64(31))


def _separate(values, move):
    """Moves all but the first of equal values by `move(value, ordinal)` until none are equal."""
    values = values.copy()
    while len(values):
        order = np.argsort(values, kind="stable")
        ordered = values[order]
        starts = np.concatenate(([True], ordered[1:] != ordered[:-1]))
        if starts.all():
            break
        run = np.cumsum(starts) - 1
        ordinal = np.arange(len(values)) - np.flatnonzero(starts)[run]
        again = ordinal > 0
        with np.errstate(over="ignore"):
            ordered[again] = move(ordered[again], ordinal[again].astype(np.uint64))
        values[order] = ordered
    return values


def _string_hash(text):
    value = 0
    for byte in text.encode():
        value = (value * 37 + byte) & _MASK
    return value


def _jenkins(x, y):
    """Bob Jenkins' lookup3 over two words (burtleburtle.net/bob/c/lookup3.c, public domain)."""

    def rotate(v, k):
        return ((v << k) | (v >> (32 - k))) & _MASK

    a = b = c = (0xDEADBEEF + (2 << 2) + 13) & _MASK
    b = (b + y) & _MASK
    a = (a + x) & _MASK
    c = ((c ^ b) - rotate(b, 14)) & _MASK
    a = ((a ^ c) - rotate(c, 11)) & _MASK
    b = ((b ^ a) - rotate(a, 25)) & _MASK
    c = ((c ^ b) - rotate(b, 16)) & _MASK
    a = ((a ^ c) - rotate(c, 4)) & _MASK
    b = ((b ^ a) - rotate(a, 14)) & _MASK
    c = ((c ^ b) - rotate(b, 24)) & _MASK
    return c
