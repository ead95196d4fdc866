# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines for machines: JSON that can be read back, and Open Job Description's."""

import json

import pytest

from addon.event_log import EventLog


def told(capsys, kind):
    log = EventLog(kind, 7, "Layer")
    log.progress(0.25, 30.0)
    log.warning("image 'Wood' is missing")
    log.error("mesh 'two\nlines' is broken")
    log.layer({"total": 12.3456})
    return capsys.readouterr().out.splitlines()


def test_json_lines(capsys):
    events = [json.loads(line) for line in told(capsys, "json")]
    assert all(e["frame"] == 7 and e["view_layer"] == "Layer" for e in events)
    assert [e["event"] for e in events] == ["progress", "warning", "error", "layer"]
    assert (events[0]["fraction"], events[0]["remaining"]) == (0.25, 30.0)
    assert events[2]["text"] == "mesh 'two\nlines' is broken"
    assert events[3]["seconds"] == {"total": 12.346}


def test_open_job_description(capsys):
    assert told(capsys, "openjd") == [
        "openjd_progress: 25.0",
        "openjd_fail: mesh 'two lines' is broken",
        "openjd_status: frame 7: 12.3 s",
    ]


def test_silence_is_the_default(capsys):
    assert told(capsys, None) == []


@pytest.mark.parametrize("fraction, said", [(-0.1, "0.0"), (1.5, "100.0")])
def test_progress_stays_in_its_range(capsys, fraction, said):
    EventLog("openjd").progress(fraction)
    assert capsys.readouterr().out == f"openjd_progress: {said}\n"
