# SPDX-License-Identifier: GPL-3.0-or-later
"""Flips properties inside one Blender and writes a line of JSON each: worker.py RESULTS [PATTERN].

What RESULTS already holds is not done again.  A line is written before a flip is rendered, too: a flip that
ends Blender is known by it and left out when the worker is started again.
"""

import fnmatch
import json
import sys
import traceback
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "blender")]


def main(results, pattern="*"):
    from all_probes import all_probes
    from session import Session
    from verdict import Judge
    from walk import flips

    done = read(results)
    session = Session()
    with open(results, "a", buffering=1) as out:

        def write(record):
            out.write(json.dumps(record) + "\n")

        for probe in all_probes():
            if not fnmatch.fnmatch(probe.name, pattern) or ("probe " + probe.name) in done:
                continue
            try:
                _scene, roots = session.build(probe)
                judge = None
                for flip in flips(probe, roots):
                    if flip.identifier in done:
                        continue
                    if judge is None:
                        judge = Judge(session, probe)
                        write(judge.baseline().record())
                    write({"identifier": flip.identifier, "key": flip.key, "verdict": "crash"})
                    write(judge.judge(flip).record())
            except Exception:
                traceback.print_exc()
                write({"identifier": f"probe {probe.name}", "key": probe.name, "verdict": "broken"})
                continue
            write({"identifier": f"probe {probe.name}", "key": probe.name, "verdict": "done"})
    session.close()


def read(results):
    """{identifier: record}, the last of each."""
    if not Path(results).exists():
        return {}
    with open(results) as lines:
        return {record["identifier"]: record for record in map(json.loads, lines)}


if __name__ == "__main__":
    own = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    main(*own)
