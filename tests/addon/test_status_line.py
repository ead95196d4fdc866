# SPDX-License-Identifier: GPL-3.0-or-later
"""Status lines: how they read, and that there is at most one a second."""

import re
from types import SimpleNamespace

import pytest

from addon import status_line

# The pattern by which AWS Deadline Cloud reads progress from Blender's output.
FARM = re.compile(r"^Fra:.*Sample\s(\d+)\/(\d+)$")


class Engine:
    def __init__(self):
        self.lines = []

    def update_stats(self, stats, info):
        self.lines.append(f"Fra:1 Mem:8.00M | {stats}{info}")


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
    assert "Remaining" not in engine.lines[1]
    assert "Remaining:00:30.00 |" in engine.lines[2]
    assert "Remaining:00:20.00 |" in engine.lines[3]


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
