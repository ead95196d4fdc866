# SPDX-License-Identifier: GPL-3.0-or-later
"""What the last picture of a view has cost, for its sidebar."""

from dataclasses import dataclass, field

_STAGES = (
    ("open", "Opening"),
    ("dice", "Dicing"),
    ("ray_build", "Ray structure"),
    ("hide", "Hiding"),
    ("shade", "Shading"),
    ("resolve", "Compositing"),
)


# Objects that are named.
DEAREST = 5


@dataclass
class Costs:
    frame: float = 0.0  # seconds of Blender's thread: reading the frame
    shutter: float = 0.0  # reading the whole shutter
    first: float = 0.0  # until the first picture
    divisor: int = 1  # pixels of the view that one of its pixels is wide
    whole: float = 0.0  # of the picture itself
    statistics: dict = field(default_factory=dict)  # of its job
    # [(name, seconds that threads dice and shade it, micropolygons)], dearest first
    objects: list = field(default_factory=list)

    def lines(self):
        """[(label, value)]."""
        found = [
            ("Reading the frame", _seconds(self.frame)),
            ("Reading the shutter", _seconds(self.shutter)),
            ("First picture", f"{_seconds(self.first)}, 1:{self.divisor}"),
            ("Picture", _seconds(self.whole)),
        ]
        for name, label in _STAGES:
            if f"seconds_{name}" in self.statistics:
                found.append(
                    (f"    {label} (processor)", _seconds(self.statistics[f"seconds_{name}"]))
                )
        for name, label in (("points_shaded", "Shaded points"), ("micropolygons", "Micropolygons")):
            if name in self.statistics:
                found.append((label, f"{self.statistics[name]:,}"))
        return found

    def object_lines(self):
        """[(name, value)] of the dearest objects."""
        return [
            (
                name,
                _seconds(seconds) + (f", {micropolygons:,} micropolygons" if micropolygons else ""),
            )
            for name, seconds, micropolygons in self.objects
        ]


def _seconds(value):
    return f"{value * 1000:.0f} ms" if value < 1.0 else f"{value:.1f} s"
