# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist and the farm read while a frame renders.

In background every `update_stats` prints a line, and farm managers read their progress from its
end (AWS Deadline Cloud: `^Fra:.*Sample\\s(\\d+)\\/(\\d+)$`) and take the words of failures anywhere
in it for failures: each line ends in `Sample k/n`, k buckets of n, and holds no user's names.
"""

from time import monotonic

from .event_log import EventLog

SECONDS_BETWEEN_LINES = 1.0


class StatusLine:
    """At most one line a second, over all frames of the process."""

    _next = 0.0

    def __init__(self, engine, log=None):
        """`log`: an EventLog, which hears of the same."""
        self._engine = engine
        self._log = log or EventLog()
        self._started = None

    def exporting(self):
        self._show("Exporting | Sample 0/1", 0.0)

    def rendering(self, job):
        """`job`: a granita_core.Render."""
        now = monotonic()
        if self._started is None:
            self._started = now
        remaining = None
        text = f"Sample {job.buckets_done}/{job.buckets_total}"
        if job.fraction > 0.0:
            remaining = (now - self._started) * (1.0 - job.fraction) / job.fraction
            text = f"Remaining:{clock(remaining)} | {text}"
        self._show(text, job.fraction, remaining)

    def _show(self, text, fraction, remaining=None):
        now = monotonic()
        if now >= StatusLine._next:
            StatusLine._next = now + SECONDS_BETWEEN_LINES
            self._engine.update_stats("", text)
            self._log.progress(fraction, remaining)


def clock(seconds):
    """62.3 -> "01:02.30", as Blender writes its times."""
    minutes, seconds = divmod(round(max(seconds, 0.0), 2), 60.0)
    hours, minutes = divmod(int(minutes), 60)
    return (f"{hours:02}:" if hours else "") + f"{minutes:02}:{seconds:05.2f}"
