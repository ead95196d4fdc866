# SPDX-License-Identifier: GPL-3.0-or-later
"""What the log of a session holds: every kind of line, the newest alone, this user's newest crash."""

import os

import pytest

from addon import bridge, session_log
from addon.event_log import EventLog


@pytest.fixture(autouse=True)
def empty(monkeypatch, tmp_path):
    session_log.clear()
    monkeypatch.setattr(bridge, "crash_file", lambda: str(tmp_path / "granita-crash-1.txt"))
    yield tmp_path
    session_log.clear()


def test_what_is_told_is_kept_without_being_asked_for(capsys):
    log = EventLog(None, 7, "Layer")
    log.progress(0.5)
    log.warning("image 'Wood' is missing")
    log.error("mesh 'two\nlines' is broken")
    log.layer({"total": 12.3456})
    assert capsys.readouterr().out == ""
    report, *told = session_log.text("Granita: 1\n").splitlines()
    assert report == "Granita: 1"
    assert [line.partition(" ")[2] for line in told if line] == [
        "frame 7, Layer: warning: image 'Wood' is missing",
        "frame 7, Layer: error: mesh 'two\\nlines' is broken",
        "frame 7, Layer: layer: 12.35 s",
    ]


def test_a_night_of_frames_keeps_the_newest():
    for frame in range(session_log.LINES + 5):
        EventLog(None, frame).warning("again")
    lines = [line for line in session_log.text("").splitlines() if "again" in line]
    assert len(lines) == session_log.LINES
    assert "frame 5: " in lines[0]


def test_silence_is_said():
    assert "No frame told anything" in session_log.text("")


def test_the_newest_crash_is_in_it(empty):
    for number, name in enumerate(("older", "newer", "newest")):
        file = empty / f"granita-crash-{number}.txt"
        file.write_text(f"crash {name}\n")
        os.utime(file, (number, number))
    text = session_log.text("")
    assert "crash newest\n" in text
    assert "older" not in text and "newer" not in text


def test_crashes_of_others_stay_theirs(empty, monkeypatch):
    (empty / "granita-crash-9.txt").write_text("crash of mine\n")
    monkeypatch.setattr(os, "getuid", lambda: os.stat(empty).st_uid + 1)
    assert "mine" not in session_log.text("")
