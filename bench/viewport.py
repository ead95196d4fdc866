# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds from an edit to what the window shows: the first changed picture and the last change; pictures a second in
a drag.  Granita's view beside Cycles' (which shows no motion blur), each in a Blender of its own under Xvfb.

    ./dev bench viewport [SCENE ...]

What counts are the screen's own pixels, read 200 times a second.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from measure import save
from window_pixels import Screen, Watch

HERE = Path(__file__).resolve().parent
EDITS = (
    "shutter",
    "f-stop",
    "focus",
    "lamp strength",
    "lamp color",
    "material color",
    "pass",
    "back from pass",
    "object moved",
    "frame",
    "orbit",
    "to camera",
)
DRAGS = ("shutter", "f-stop", "lamp color", "material color")
ENGINES = ("GRANITA", "CYCLES")
REST = {"GRANITA": 6.0, "CYCLES": 20.0}


def watched(job):
    """The log of one Blender, and every change of what its view shows."""
    with tempfile.TemporaryDirectory() as folder, Screen(1000, 760) as screen:
        log, file = Path(folder) / "log", Path(folder) / "job.json"
        log.touch()
        blend = str(Path(folder) / "scene.blend")
        file.write_text(json.dumps({**job, "log": str(log), "blend": blend}))
        script = ["--python", str(HERE / "viewport_window.py"), "--", str(file)]
        blender = ["blender", "--factory-startup", "--addons", "granita"]
        subprocess.run([blender[0], "-b", *blender[1:], *script], check=True, capture_output=True)
        blender = subprocess.Popen(
            [*blender, "--window-geometry", "0", "0", "1000", "760", blend, *script],
            env={**os.environ, "DISPLAY": screen.name, "LIBGL_ALWAYS_SOFTWARE": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        watch = None
        while blender.poll() is None:
            time.sleep(0.1)
            if watch is None:
                boxes = [entry["box"] for entry in entries(log) if "box" in entry]
                if boxes:
                    watch = Watch(screen, boxes[0])
                    watch.start()
        if watch is None or not entries(log)[-1].get("end"):
            raise RuntimeError(blender.stdout.read()[-3000:] + log.read_text()[-500:])
        watch.end()
        return entries(log), watch.changes


def entries(log):
    return [json.loads(line) for line in log.read_text().splitlines()]


def table(found, changes):
    """{edit: (seconds to the first change, to the last)}, {drag: pictures a second}."""
    edits, drags = {}, {}
    for this, following in zip(found, found[1:], strict=False):
        if "edit" in this:
            times = [t for t, _ in changes if this["time"] < t < following["time"]]
            first, last = (times[0], times[-1]) if times else (float("nan"),) * 2
            edits[this["edit"]] = (first - this["time"], last - this["time"])
        elif "drag" in this:
            seen = [crc for t, crc in changes if this["time"] < t < following["time"]]
            drags[this["drag"]] = len(seen) / (following["time"] - this["time"])
    return edits, drags


def main(names):
    rows = []
    for name in names or ("lit", "moving"):
        for engine in ENGINES:
            job = {"scene": name, "engine": engine, "samples": 64, "rest": REST[engine]}
            found, changes = watched({**job, "edits": EDITS, "drags": DRAGS})
            edits, drags = table(found, changes)
            counts = [entry["counts"] for entry in found if "counts" in entry]
            for edit, (first, last) in edits.items():
                print(f"{name:8} {engine:8} {edit:16} first {first:6.2f} settled {last:6.2f}")
                row = {"scene": name, "engine": engine, "edit": edit}
                rows.append({**row, "first": round(first, 3), "settled": round(last, 3)})
            for drag, rate in drags.items():
                print(f"{name:8} {engine:8} drag {drag:16} {rate:5.1f} pictures a second")
                rows.append({"scene": name, "engine": engine, "drag": drag, "rate": round(rate, 1)})
            if counts:
                print(counts)
    save("viewport", rows)


if __name__ == "__main__":
    main(sys.argv[1:])
