# SPDX-License-Identifier: GPL-3.0-or-later
"""A fault in mid-frame: Blender ends as it always does, and a report says what was rendered."""

import signal

import render_host

# Between two tiles, while the native job runs.
FAULT = """
import os, signal
import granita.passes as passes
def fault(*_):
    os.kill(os.getpid(), signal.SIGSEGV)
passes.deliver = fault
"""


def test_a_fault_leaves_a_report(blend, tmp_path):
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    outcome = render_host.run(blend, tmp_path / "out", FAULT, env={"TMPDIR": str(temporary)})
    # Blender's own handler has the last word, where it is a program.
    assert outcome.code in (-signal.SIGSEGV, 128 + signal.SIGSEGV), outcome.output
    assert outcome.files == []
    (report,) = temporary.glob("granita-crash-*.txt")
    assert f"a report of the crash is in {report}" in outcome.output
    text = report.read_text()
    assert text.startswith("Granita ended by SIGSEGV\nGranita 0.1.0, build ")
    assert "scene 'Scene', view layer 'ViewLayer', frame 1," in text
    assert "scene.blend'" in text
    assert "granita_core" in text.partition("Backtrace")[2]


def test_a_good_frame_leaves_none(blend, tmp_path):
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    outcome = render_host.run(blend, tmp_path / "out", env={"TMPDIR": str(temporary)})
    assert outcome.code == 0
    assert not list(temporary.glob("granita-crash-*"))
