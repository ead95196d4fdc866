# SPDX-License-Identifier: GPL-3.0-or-later
"""How the benches take time, and the table that they print."""

import json
import statistics
import time
from dataclasses import dataclass, field
from pathlib import Path

from snapshot_scenes import s as snapshots

RESULTS = Path(__file__).resolve().parent / "results"


def render(snapshot, clock=time.process_time):
    """(result, seconds: the processor's, or those of a clock) of a whole frame."""
    start = clock()
    result = snapshots.render(snapshot)
    return result, clock() - start


def frame_seconds(snapshot):
    return render(snapshot)[1]


def hide_seconds(snapshot):
    return snapshots.render(snapshot)["statistics"]["seconds_hide"]


def interleaved(cases, seconds, runs):
    """Medians of `seconds(snapshot)` for each of {name: snapshot}, taken in turns."""
    taken = {name: [] for name in cases}
    for _ in range(runs):
        for name, snapshot in cases.items():
            taken[name].append(seconds(snapshot))
    return {name: statistics.median(values) for name, values in taken.items()}


@dataclass
class Table:
    """Rows of what was measured against its limit, printed as they come."""

    rows: list = field(default_factory=list)

    def header(self):
        print("| what | measured | limit | |\n|---|---|---|---|", flush=True)

    def row(self, what, value, limit, form="{:.2f}", least=False):
        """Held where the value is at most the limit, or at least."""
        held = bool(value >= limit if least else value <= limit)
        self.rows.append({"what": what, "measured": value, "limit": limit, "held": held})
        bound = ("at least " if least else "") + form.format(limit)
        word = "held" if held else "NOT HELD"
        print(f"| {what} | {form.format(value)} | {bound} | {word} |", flush=True)

    def save(self, name):
        save(name, self.rows)


def save(name, rows):
    """Writes bench/results/NAME.json."""
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / f"{name}.json").write_text(json.dumps(rows, indent=1) + "\n")


def save_over(name, measured, identity):
    """Saves the rows beside those of earlier runs that have another identity(row), and returns all."""
    file = RESULTS / f"{name}.json"
    new = {identity(row) for row in measured}
    kept = (
        [r for r in json.loads(file.read_text()) if identity(r) not in new] if file.exists() else []
    )
    rows = sorted(kept + measured, key=identity)
    save(name, rows)
    return rows
