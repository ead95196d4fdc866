# SPDX-License-Identifier: GPL-3.0-or-later
"""Random edits under Rendered shading, in a window under Xvfb: no crash, no leak, the last picture that of a view
which has seen nothing of it.

    ./dev bench viewport_robustness [SEED ...]
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from measure import save
from window_pixels import Screen

HERE = Path(__file__).resolve().parent
EDITS = 1000
EDITOR = HERE.parent / "tests" / "blender" / "viewport_edits.py"


def run(seed, edits, timeout=3600, **job):
    """(exit code, entries of the log, what Blender said)."""
    with tempfile.TemporaryDirectory() as folder, Screen(1000, 760) as screen:
        log, file = Path(folder) / "log", Path(folder) / "job.json"
        log.touch()
        file.write_text(json.dumps({"seed": seed, "edits": edits, "log": str(log), **job}))
        done = subprocess.run(
            ["blender", "--factory-startup", "--addons", "granita", "--window-geometry"]
            + ["0", "0", "1000", "760", "--python", str(EDITOR)]
            + ["--", str(file)],
            env={**os.environ, "DISPLAY": screen.name, "LIBGL_ALWAYS_SOFTWARE": "1"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=timeout,
        )
        entries = [json.loads(line) for line in log.read_text().splitlines()]
        return done.returncode, entries, done.stdout


def main(seeds):
    rows = []
    for seed in [int(seed) for seed in seeds] or (1, 2, 3):
        code, entries, said = run(seed, EDITS)
        heaps = [entry["heap"] for entry in entries if entry.get("heap")]
        end = entries[-1]
        row = {"seed": seed, "rc": code, "edits": sum("edit" in entry for entry in entries)}
        row["failed"] = sorted({entry["failed"] for entry in entries if "failed" in entry})
        row |= {"same": end.get("same"), "tracebacks": said.count("Traceback"), "heap": heaps}
        print(row, end.get("error", ""))
        rows.append(row)
    save("viewport_robustness", rows)


if __name__ == "__main__":
    main(sys.argv[1:])
