# SPDX-License-Identifier: GPL-3.0-or-later
"""Status lines: how they read, that there is at most one a second, and what part of the frame they tell."""

import json
import re
from types import SimpleNamespace

import pytest

from addon import status_line
from addon.event_log import EventLog

# The pattern by which AWS Deadline Cloud reads progress from Blender's output.
FARM = re.compile(r"^Fra:.*Sample\s(\d+)\/(\d+)$")


class Engine:
    def __init__(self):
        self.lines = []
        self.progress = []

    def update_stats(self, stats, info):
        self.lines.append(f"Fra:1 Mem:8.00M | {stats}{info}")

    def update_progress(self, fraction):
        self.progress.append(fraction)


@pytest.fixture
def clock(monkeypatch):
    """A clock that the test moves."""
    now = SimpleNamespace(seconds=1000.0)
    monkeypatch.setattr(status_line, "monotonic", lambda: now.seconds)
    monkeypatch.setattr(status_line.StatusLine, "_next", 0.0)
    return now


def job(done, total):
    return SimpleNamespace(buckets_done=done, buckets_total=total, fraction=done / total)


def test_lines_end_as_farms_read_them(clock):
    engine = Engine()
    line = status_line.StatusLine(engine)
    line.exporting()
    for done in (0, 25, 50):
        clock.seconds += 10.0
        line.rendering(job(done, 100))
    assert [FARM.match(text).groups() for text in engine.lines] == [
        ("0", "1"),
        ("0", "100"),
        ("25", "100"),
        ("50", "100"),
    ]
    # 10 s for a quarter: 30 s are left; 20 s for a half: 20 s.
    assert engine.lines[1].endswith(" | Rendered 0% | Sample 0/100")
    assert engine.lines[2].endswith(" | Rendered 25% | Remaining:00:30.00 | Sample 25/100")
    assert engine.lines[3].endswith(" | Rendered 50% | Remaining:00:20.00 | Sample 50/100")
    assert engine.progress == [0.0, 0.25, 0.5]


def percentages(engine):
    return [int(text) for text in re.findall(r"(\d+)%", "\n".join(engine.lines))]


def test_every_hundredth_is_told_as_it_is_done(clock):
    engine = Engine()
    line = status_line.StatusLine(engine)
    for done in range(101):
        clock.seconds += 10.0
        line.rendering(job(done, 100))
    assert percentages(engine) == list(range(101))


def test_a_layer_that_begins_anew_takes_nothing_back(clock):
    """As one does whose graphics card gives up."""
    engine = Engine()
    line = status_line.StatusLine(engine)
    for done in (40, 80, 0, 30, 80, 90):
        clock.seconds += 10.0
        line.rendering(job(done, 100))
    assert percentages(engine) == [40, 80, 80, 80, 80, 90]
    assert engine.progress == sorted(engine.progress)


@pytest.mark.parametrize("rendered, done", [("ABC", [(0, 3), (1, 3), (2, 3)]), ("B", [(0, 1)])])
def test_layers_count_in_the_order_rendered(rendered, done):
    layers = [SimpleNamespace(name=name) for name in rendered]
    engine = SimpleNamespace(get_result=lambda: SimpleNamespace(layers=layers))
    at = [SimpleNamespace(view_layer=layer) for layer in layers]
    assert [status_line.layers_done(engine, depsgraph) for depsgraph in at] == done


def test_a_frame_of_two_layers_goes_once_from_nothing_to_all(clock, capsys):
    engine = Engine()
    for layer in range(2):
        line = status_line.StatusLine(engine, EventLog("json"), layer, 2)
        for done in (0, 50, 100):
            clock.seconds += 10.0
            line.rendering(job(done, 100))
        line.rendered()
    assert percentages(engine) == [0, 25, 50, 50, 75, 100]
    told = [json.loads(text)["fraction"] for text in capsys.readouterr().out.splitlines()]
    assert told == [0.0, 0.25, 0.5, 0.5, 0.5, 0.75, 1.0, 1.0]


def test_joining_tells_parts(clock):
    engine = Engine()
    line = status_line.StatusLine(engine)
    for number in (1, 2, 3):
        clock.seconds += 10.0
        line.joining(number, 4)
    assert [FARM.match(text).groups() for text in engine.lines] == [
        ("1", "4"),
        ("2", "4"),
        ("3", "4"),
    ]
    assert percentages(engine) == [25, 50, 75]


def test_at_most_one_line_a_second_over_all_frames(clock):
    engine = Engine()
    for _frame in range(50):
        line = status_line.StatusLine(engine)
        line.exporting()
        line.rendering(job(1, 2))
        clock.seconds += 0.1
    assert len(engine.lines) == 5


@pytest.mark.parametrize(
    "seconds, text",
    [
        (0.0, "00:00.00"),
        (-1.0, "00:00.00"),
        (62.3, "01:02.30"),
        (59.999, "01:00.00"),
        (3723.5, "01:02:03.50"),
    ],
)
def test_clock(seconds, text):
    assert status_line.clock(seconds) == text
