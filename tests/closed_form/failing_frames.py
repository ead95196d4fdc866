# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of which one allocation fails (failing_new.cpp is preloaded).

`python failing_frames.py STEP` lets each STEP-th allocation of the frames of damaged_parts.whole() fail in turn, and prints where it is
and how many ended how.  One that is rendered all the same, and a last one of each, have the bits of a whole one.
"""

import ctypes
import sys
from collections import Counter

import damaged_parts
import numpy as np

import granita_core


def outcome(snapshot, expected):
    """`expected`: a whole frame."""
    try:
        frame = granita_core.render(snapshot)
    except MemoryError:
        return "MemoryError"
    except granita_core.Error as error:
        # What fails within a library of others may not say of what.
        assert "memory" in str(error) or "Embree" in str(error), error
        return type(error).__name__
    if frame["warnings"] != expected["warnings"]:
        return "warned"  # an image that there was no memory to decode is magenta, as one that is damaged
    np.testing.assert_array_equal(frame["combined"], expected["combined"])
    return "rendered"


def main(step):
    library = ctypes.CDLL(None)
    library.fail_new_after.argtypes = [ctypes.c_long]
    library.asked_new.restype = ctypes.c_long
    ends = Counter()
    for index, snapshot in enumerate(damaged_parts.whole()):
        granita_core.render(snapshot)  # what is made once for all frames
        library.fail_new_after(-1)
        expected = granita_core.render(snapshot)
        for number in range(index % step, library.asked_new(), step):
            print(index, number, flush=True)
            library.fail_new_after(number)
            ends[outcome(snapshot, expected)] += 1
            library.fail_new_after(-1)
        assert outcome(snapshot, expected) == "rendered"
    print(dict(ends))


if __name__ == "__main__":
    main(int(sys.argv[1]))
