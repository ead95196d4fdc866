# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as SVG in panels, logarithmic or from the origin: what the benches draw, without a plotting library."""

import math
from dataclasses import dataclass
from xml.sax.saxutils import escape

WIDTH, HEIGHT, LEFT, TOP = 300, 230, 52, 34
LETTER = 5  # wide, about
COLORS = ("#0b6e99", "#d9730d", "#0f7b6c", "#ad1a72", "#777777", "#6940a5")
MOST_DOTS = 40  # on a curve; a longer one is a line alone


@dataclass
class Panel:
    title: str
    curves: dict  # name -> [(x, y)]; all positive where logarithmic
    levels: tuple = ()  # y values with a line across
    from_origin: bool = False  # both axes linear from 0; else both logarithmic


def logarithmic(values, begin, end):
    """(place of a value between two coordinates, ticks), with a little room on both sides; ticks are 1, 2, 5 times
    powers of ten."""
    low, high = min(values) / 1.3, max(values) * 1.3
    span = math.log(high / low)
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    ticks = [m * 10.0**d for d in decades for m in (1, 2, 5) if low <= m * 10.0**d <= high]
    return lambda v: begin + (end - begin) * math.log(v / low) / span, ticks


def linear(values, begin, end):
    """The same from 0; five ticks or fewer, 1, 2 or 5 times a power of ten apart."""
    high = 1.05 * max(values)
    least = high / 5.0
    decade = 10.0 ** math.floor(math.log10(least))
    step = next(m * decade for m in (1, 2, 5, 10) if m * decade >= least)
    ticks = [i * step for i in range(math.floor(high / step) + 1)]
    return lambda v: begin + (end - begin) * v / high, ticks


def draw_panel(panel, colors, x_label, y_label):
    points = [p for curve in panel.curves.values() for p in curve]
    scale = linear if panel.from_origin else logarithmic
    x_of, x_ticks = scale([p[0] for p in points], LEFT, WIDTH - 10)
    y_of, y_ticks = scale([*(p[1] for p in points), *panel.levels], HEIGHT - 36, TOP)
    out = [f'<text x="{LEFT}" y="{TOP - 20}" font-weight="bold">{escape(panel.title)}</text>']
    for x in x_ticks:
        out.append(f'<path d="M{x_of(x):.1f} {TOP}V{HEIGHT - 36}" stroke="#eee"/>')
        out.append(f'<text x="{x_of(x):.1f}" y="{HEIGHT - 22}" text-anchor="middle">{x:g}</text>')
    for y in y_ticks:
        out.append(f'<path d="M{LEFT} {y_of(y):.1f}H{WIDTH - 10}" stroke="#eee"/>')
        out.append(f'<text x="{LEFT - 4}" y="{y_of(y) + 3:.1f}" text-anchor="end">{y:g}</text>')
    for y in panel.levels:
        out.append(
            f'<path d="M{LEFT} {y_of(y):.1f}H{WIDTH - 10}" stroke="#999" stroke-dasharray="4 3"/>'
        )
    for name, curve in panel.curves.items():
        places = [f"{x_of(x):.1f} {y_of(y):.1f}" for x, y in curve]
        out.append(f'<path d="M{"L".join(places)}" fill="none" stroke="{colors[name]}"/>')
        out += [
            f'<circle cx="{p.split()[0]}" cy="{p.split()[1]}" r="2.5" fill="{colors[name]}"/>'
            for p in (places if len(places) <= MOST_DOTS else ())
        ]
    out.append(
        f'<text x="{WIDTH - 10}" y="{HEIGHT - 8}" text-anchor="end">{escape(x_label)}</text>'
    )
    out.append(f'<text x="4" y="{TOP - 8}">{escape(y_label)}</text>')
    return out


def save(path, panels, x_label, y_label, columns=3):
    """Writes the panels with one legend; a curve's name has the same colour in all."""
    names = list(dict.fromkeys(name for panel in panels for name in panel.curves))
    colors = {name: COLORS[i % len(COLORS)] for i, name in enumerate(names)}
    columns = min(columns, len(panels))
    rows = math.ceil(len(panels) / columns)
    width, top = columns * WIDTH, rows * HEIGHT
    room = 34 + LETTER * max(map(len, names))
    in_line = max((width - LEFT) // room, 1)
    height = top + 6 + 14 * math.ceil(len(names) / in_line)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{max(width, 450)}" '
        'font-family="sans-serif" font-size="9" fill="#333">',
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for i, panel in enumerate(panels):
        out.append(f'<g transform="translate({i % columns * WIDTH} {i // columns * HEIGHT})">')
        out += [*draw_panel(panel, colors, x_label, y_label), "</g>"]
    for i, name in enumerate(names):
        x, y = LEFT + room * (i % in_line), top + 9 + 14 * (i // in_line)
        out.append(f'<path d="M{x} {y - 3}h18" stroke="{colors[name]}" stroke-width="2"/>')
        out.append(f'<text x="{x + 22}" y="{y}">{escape(name)}</text>')
    path.write_text("\n".join([*out, "</svg>"]) + "\n")
