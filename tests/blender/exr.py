# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads an OpenEXR file of scanlines without compression: the shortest way from a file that
Blender wrote to the exact bits of every layer and pass, the same in every Blender.

The format: https://openexr.com/en/latest/OpenEXRFileLayout.html
"""

import struct

import numpy as np

_TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


def read(path):
    """Returns {channel name: float32 [height, width], lower-left first}, of the data window."""
    data = open(path, "rb").read()
    if struct.unpack_from("<I", data)[0] != 20000630:
        raise ValueError(f"{path} is not an OpenEXR file")
    if data[5] & 0x1A:
        raise ValueError(f"{path}: tiles, deep data and parts are not read here")
    attributes, at = _header(data, 8)
    if attributes["compression"] != b"\0":
        raise ValueError(f"{path} is compressed")
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels = _channels(attributes["channels"])
    pixels = {name: np.empty((height, width), np.float32) for name, _ in channels}
    for offset in struct.unpack_from(f"<{height}Q", data, at):
        (line,) = struct.unpack_from("<i", data, offset)
        place = offset + 8
        for name, dtype in channels:
            row = np.frombuffer(data, dtype, width, place)
            pixels[name][height - 1 - (line - y0)] = row
            place += row.nbytes
    return pixels


def _header(data, at):
    attributes = {}
    while data[at]:
        name, at = _string(data, at)
        _, at = _string(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def _channels(data):
    found, at = [], 0
    while data[at]:
        name, at = _string(data, at)
        (kind,) = struct.unpack_from("<i", data, at)
        found.append((name, _TYPES[kind]))
        at += 16
    return found


def _string(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1
