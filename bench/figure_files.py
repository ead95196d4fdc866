# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as PNG, with nothing but NumPy."""

import struct
import zlib

import numpy as np


def display(picture, background=0.05):
    """Linear premultiplied RGBA, lowest row first, to sRGB bytes, top row first, over a grey."""
    rgb = picture[::-1, :, :3] + background * (1 - picture[::-1, :, 3:])
    rgb = np.clip(rgb, 0, 1)
    curve = np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * rgb ** (1 / 2.4) - 0.055)
    return np.round(255 * curve).astype(np.uint8)


def side_by_side(rows, gap=6):
    """Rows of pictures of one size each, on white."""
    lines = []
    for row in rows:
        space = np.full((row[0].shape[0], gap, 3), 255, np.uint8)
        parts = [part for picture in row for part in (picture, space)]
        lines += [np.concatenate(parts[:-1], 1)]
        lines += [np.full((gap, lines[0].shape[1], 3), 255, np.uint8)]
    return np.concatenate(lines[:-1])


def enlarge(picture, factor):
    return picture.repeat(factor, 0).repeat(factor, 1)


def write_png(path, pixels):
    height, width = pixels.shape[:2]

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], 1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 9))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + data + chunk(b"IEND", b""))
