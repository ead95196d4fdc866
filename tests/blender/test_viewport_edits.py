# SPDX-License-Identifier: GPL-3.0-or-later
"""A few dozen random edits under Rendered shading, in a window under Xvfb (bench/viewport_robustness.py has a thousand):
Blender ends as it should, and the last picture is that of a view which has seen nothing of them."""

import json
from pathlib import Path

import window_host

pytestmark = window_host.needed


def test_random_edits_leave_a_picture_as_a_fresh_view_has_it(tmp_path):
    log, job = tmp_path / "log", tmp_path / "job.json"
    log.touch()
    job.write_text(json.dumps({"seed": 7, "edits": 40, "log": str(log), "pause": 0.1}))
    script = Path(__file__).with_name("viewport_edits.py")
    code, said = window_host.run(script, job)
    entries = [json.loads(line) for line in log.read_text().splitlines()]
    assert code == 0 and "Traceback" not in said, said
    assert not [entry["failed"] for entry in entries if "failed" in entry]
    assert len({entry["edit"] for entry in entries if "edit" in entry}) > 15
    assert entries[-1].get("end") and entries[-1]["same"], entries[-5:]
    assert set(entries[-1]["scenes"]) <= {"Scene", "Other"}
