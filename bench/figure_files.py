# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as PNG and curves as SVG, with nothing but NumPy."""

import struct
import zlib

import numpy as np

COLORS = ["#1b6ca8", "#c8452d", "#3a8f4d", "#8a5ca8"]
MOST_DOTS = 40  # on a curve; a longer one is a line alone


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


def ticks(low, high):
    """About five round numbers in the range."""
    step = 10.0 ** np.floor(np.log10((high - low) / 2))
    while (high - low) / step > 6:
        step *= 2 if round(step / 10 ** np.floor(np.log10(step))) != 2 else 2.5
    return np.arange(np.ceil(low / step), high / step + 1e-9) * step


def write_curves(path, title, x_name, y_name, curves, room=1.05):
    """Straight lines through points from the origin's axes; curves: {name: (x, y)}.

    Args:
        room: the axis of y, in highest values; the names stand in its upper left corner.
    """
    width, height, left, bottom, top = 460, 300, 60, 44, 30
    x_high = max(max(x) for x, _ in curves.values())
    y_high = room * max(max(y) for _, y in curves.values())

    def place(x, y):
        return (
            left + (width - left - 20) * x / x_high,
            height - bottom - (height - bottom - top) * y / y_high,
        )

    def text(x, y, words, anchor="middle", more=""):
        return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{words}</text>'

    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}"'
        ' font-family="sans-serif" font-size="11">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
        text(width / 2, 16, title, more=' font-size="13"'),
        text((left + width) / 2, height - 8, x_name),
        text(14, height / 2, y_name, more=f' transform="rotate(-90 14 {height / 2})"'),
    ]
    for value in ticks(0, x_high):
        x, y = place(value, 0)
        out += [text(x, y + 15, f"{value:g}")]
    for value in ticks(0, y_high):
        x, y = place(0, value)
        end = place(x_high, value)[0]
        out += [
            text(x - 5, y + 4, f"{value:g}", "end"),
            f'<path d="M{x:.1f} {y:.1f}H{end:.1f}" stroke="#dddddd"/>',
        ]
    for i, (name, (x, y)) in enumerate(curves.items()):
        color = COLORS[i % len(COLORS)]
        points = [place(a, b) for a, b in zip(x, y)]
        line = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
        out += [f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="2"/>']
        dots = points if len(points) <= MOST_DOTS else []
        out += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3" fill="{color}"/>' for a, b in dots]
        out += [text(left + 14, top + 14 + 15 * i, name, "start", f' fill="{color}"')]
    path.write_text("\n".join([*out, "</svg>\n"]))
