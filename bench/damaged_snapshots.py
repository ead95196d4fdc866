# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshots damaged by chance, by the hundred thousands, into the native module: none may end or hold its process.

    ./dev bench damaged_snapshots [--count 10000] [--first 0]

tests/closed_form/damaged_parts.py makes and renders them.  Prints how many were refused by name, rendered, cancelled (a large
number made their frames long) and failed; and the numbers of those that crashed, raised what they should not or
took no notice of being cancelled: the exit code is 1 then.
"""

import argparse
import ast
import os
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SCRIPT = Path(__file__).resolve().parent.parent / "tests" / "closed_form" / "damaged_parts.py"
CHUNK = 1000
# A frame that does not end once it is cancelled is told apart from a slow machine by these.
SECONDS_EACH, SECONDS_MORE = 2, 60


def chunk(first, end):
    """Renders numbers from `first` to before `end`, in as many processes as faults ask for.

    Returns: (how frames ended, the numbers that were faults)
    """
    ends, faults = Counter(), []
    while first < end:
        with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
            command = [sys.executable, str(SCRIPT), str(first), str(end - first)]
            process = subprocess.Popen(command, stdout=out, stderr=err)
            try:
                code = process.wait(SECONDS_EACH * (end - first) + SECONDS_MORE)
            except subprocess.TimeoutExpired:
                process.kill()
                code = f"no end ({process.wait()})"
            out.seek(0)
            lines = out.read().splitlines()
            err.seek(0)
            said = err.read().strip().split("\n")[-1]
        numbers = [int(line) for line in lines if line.isdigit()]
        if code == 0:
            return ends + Counter(ast.literal_eval(lines[-1])), faults
        if not numbers:
            raise RuntimeError(f"nothing was rendered: {said}")
        print(f"{numbers[-1]}: exit code {code}, {said[:300]}", flush=True)
        ends["before a fault"] += len(numbers) - 1
        faults.append(numbers[-1])
        first = numbers[-1] + 1
    return ends, faults


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0)
    options = parser.parse_args()
    end = options.first + options.count
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        chunks = [
            pool.submit(chunk, first, min(first + CHUNK, end))
            for first in range(options.first, end, CHUNK)
        ]
    ends = sum((done.result()[0] for done in chunks), Counter())
    faults = [number for done in chunks for number in done.result()[1]]
    print(dict(ends), f"{len(faults)} faults")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
