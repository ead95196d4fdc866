# SPDX-License-Identifier: GPL-3.0-or-later
"""What one frame cost: the JSON object that `--granita-stats FILE` appends for it.

frame, scene        number and name
view_layers         names, in the order rendered; the numbers below are their sums
width, height       pixels of the full frame
samples             visibility samples a pixel
device              the executor and device that rendered, in words
seconds             wall time: export, scene (checks and copies), render, total
statistics          the native counters by name; "seconds_<stage>" are summed over threads
peak_resident_bytes of the whole process, Blender's own memory included
warnings            [{datablock, message, count}]
"""

import json


class StatisticsFileError(Exception):
    """The statistics file cannot be written; the text names it."""


class FrameStatistics:
    """Collects the view layers of a frame, then writes them as one line."""

    def __init__(self):
        self._record = None

    def add_layer(self, layer, options, job, seconds, warnings):
        """Adds a finished native job.

        `layer`: has name and scene_name; `options`: the snapshot's; `seconds`: by name;
        `warnings`: triples (datablock, message, count).
        """
        if self._record is None or self._record["frame"] != options["frame"]:
            self._record = {
                "frame": int(options["frame"]),
                "scene": layer.scene_name,
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
        record["view_layers"].append(layer.name)
        for name, value in seconds.items():
            record["seconds"][name] = record["seconds"].get(name, 0.0) + value
        for name, value in job.statistics().items():
            merge = max if name.startswith("peak_") else sum
            record["statistics"][name] = merge((record["statistics"].get(name, 0), value))
        for datablock, message, count in warnings:
            entry = {"datablock": datablock, "message": message, "count": int(count)}
            record["warnings"].append(entry)

    def discard(self):
        """Forgets a frame that was not finished."""
        self._record = None

    def write(self, path):
        """Appends the frame to `path` ("" or None: nowhere) and starts anew.

        Raises StatisticsFileError.
        """
        record, self._record = self._record, None
        if record is not None and path:
            record["peak_resident_bytes"] = _peak_resident_bytes()
            _append(path, json.dumps(record, default=float) + "\n")


def check_writable(path):
    """Raises StatisticsFileError before a frame is spent on a file that cannot be written."""
    _append(path, "")


def _append(path, text):
    try:
        with open(path, "a", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        raise StatisticsFileError(
            f"statistics file '{path}' cannot be written: {error.strerror}"
        ) from error


def _peak_resident_bytes():
    """Linux counts ru_maxrss in KiB.  Imported here: the module is absent elsewhere."""
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
