# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist and the farm read while a frame renders.

In background every `update_stats` prints a line, and farm managers read their progress from its
end (AWS Deadline Cloud: `^Fra:.*Sample\\s(\\d+)\\/(\\d+)$`) and take the words of failures anywhere
in it for failures: each line ends in `Sample k/n`, k buckets of n, and holds no user's names.
"Remaining:" is Cycles' word, for the view layer that renders; the percentage before it, which Cycles
has only as Blender's bar, is of the whole frame.
"""

from time import monotonic

from .event_log import EventLog

SECONDS_BETWEEN_LINES = 1.0


def layers_done(engine, depsgraph):
    """(number, of how many) of the view layers that the frame has behind it, in the order rendered.

    The result has those that are rendered.  The scene does not tell: in background its `use_single_layer` counts for
    nothing, in a window `render(layer=...)` leaves it unset.
    """
    layer = depsgraph.view_layer.name
    names = [each.name for each in engine.get_result().layers]
    return (names.index(layer), len(names)) if layer in names else (0, 1)


class StatusLine:
    """At most one line a second, over all frames of the process."""

    _next = 0.0

    def __init__(self, engine, log=None, done=0, layers=1):
        """`log`: an EventLog, which hears of the same.  This is of one view layer, after `done` of `layers`."""
        self._engine = engine
        self._log = log or EventLog()
        self._done, self._layers = done, layers
        self._fraction = 0.0  # of this layer
        self._started = None

    def exporting(self):
        self._show("Exporting | Sample 0/1")

    def rendering(self, job):
        """`job`: a granita_core.Render."""
        now = monotonic()
        if self._started is None:
            self._started = now
        # Where the graphics card gives up, the CPU begins anew.
        self._fraction = max(self._fraction, job.fraction)
        self._engine.update_progress(self._of_frame())
        remaining = None
        text = f"Sample {job.buckets_done}/{job.buckets_total}"
        if job.fraction > 0.0:
            remaining = (now - self._started) * (1.0 - job.fraction) / job.fraction
            text = f"Remaining:{clock(remaining)} | {text}"
        self._show(f"Rendered {self._percent()}% | {text}", remaining)

    def joining(self, number, count):
        """So many parts of a frame are joined."""
        self._fraction = number / count
        self._engine.update_progress(self._of_frame())
        self._show(f"Joined {self._percent()}% | Sample {number}/{count}")

    def rendered(self):
        """The layer is done: of this machines hear whenever it is."""
        self._fraction = 1.0
        self._log.progress(self._of_frame(), 0.0)

    def _of_frame(self):
        return (self._done + self._fraction) / self._layers

    def _percent(self):
        """Whole ones that are done; a hundredth that sums a little short counts."""
        return int(100.0 * self._of_frame() + 1e-6)

    def _show(self, text, remaining=None):
        now = monotonic()
        if now >= StatusLine._next:
            StatusLine._next = now + SECONDS_BETWEEN_LINES
            self._engine.update_stats("", text)
            self._log.progress(self._of_frame(), remaining)


def clock(seconds):
    """62.3 -> "01:02.30", as Blender writes its times."""
    minutes, seconds = divmod(round(max(seconds, 0.0), 2), 60.0)
    hours, minutes = divmod(int(minutes), 60)
    return (f"{hours:02}:" if hours else "") + f"{minutes:02}:{seconds:05.2f}"
