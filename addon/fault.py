# SPDX-License-Identifier: GPL-3.0-or-later
"""A fault of ours, which no artist can mend: its traceback goes to the standard error, for whoever reports it."""

import sys
import traceback

from .export.base.report import escaped


def traced(error):
    """Prints an exception's traceback; returns it in a line, "KeyError: 'x'", not escaped."""
    lines = "".join(traceback.format_exception(error)).splitlines()
    print("\n".join(escaped(line) for line in lines), file=sys.stderr)
    return f"{type(error).__name__}: {error}"
