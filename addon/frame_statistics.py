# SPDX-License-Identifier: GPL-3.0-or-later
"""What one frame cost: the JSON object that `--granita-stats FILE` appends for it.

frame, scene        number and name
view_layers         names, in the order rendered; the numbers below are their sums
width, height       pixels of the full frame
samples             visibility samples a pixel
device              the executor and device that rendered, in words
seconds             wall time: export, scene (checks and copies), render, total
statistics          the native counters by name; "seconds_<stage>" are processor
                    seconds, summed over threads: together the frame's, but for a tenth
peak_resident_bytes of the whole process, Blender's own memory included
warnings            [{datablock, message, count}]
"""

import json


class StatisticsFileError(Exception):
    """The statistics file cannot be written; the text names it."""


class FrameStatistics:
    """Collects the view layers of a frame, then writes them as one line."""

    def __init__(self):
        self._path = None
        self._record = None

    def open(self, path):
        """`path` of the file to append to, or None.  Raises StatisticsFileError at once, before a
        frame is spent on a file that cannot be written."""
        self._path = path
        if path is not None:
            self._append("")

    def add_layer(self, layer, options, job, warnings):
        """Adds a finished native job.

        `layer`: has layer, scene (names) and seconds (by name); `options`: the snapshot's;
        `warnings`: triples (datablock, message, count).
        """
        if self._record is None or self._record["frame"] != options["frame"]:
            self._record = {
                "frame": int(options["frame"]),
                "scene": layer.scene,
                "view_layers": [],
                "width": int(options["width"]),
                "height": int(options["height"]),
                "samples": int(options["samples"]),
                "device": job.device,
                "seconds": {},
                "statistics": {},
                "warnings": [],
            }
        record = self._record
        record["view_layers"].append(layer.layer)
        for name, value in layer.seconds.items():
            record["seconds"][name] = record["seconds"].get(name, 0.0) + value
        for name, value in job.statistics().items():
            if name != "device":
                merge = max if name.startswith("peak_") else sum
                record["statistics"][name] = merge((record["statistics"].get(name, 0), value))
        for datablock, message, count in warnings:
            entry = {"datablock": datablock, "message": message, "count": int(count)}
            record["warnings"].append(entry)

    def discard(self):
        """Forgets a frame that was not finished."""
        self._record = None

    def write(self):
        """Appends the frame to the file and starts anew.  Raises StatisticsFileError."""
        record, self._record = self._record, None
        if record is not None and self._path is not None:
            record["peak_resident_bytes"] = _peak_resident_bytes()
            self._append(json.dumps(record, default=float) + "\n")

    def _append(self, text):
        try:
            with open(self._path, "a", encoding="utf-8") as file:
                file.write(text)
        except OSError as error:
            raise StatisticsFileError(
                f"statistics file '{self._path}' cannot be written: {error.strerror}"
            ) from error


def _peak_resident_bytes():
    """Linux counts ru_maxrss in KiB.  Imported here: the module is absent elsewhere."""
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
