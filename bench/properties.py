# SPDX-License-Identifier: GPL-3.0-or-later
"""Flips every property of small scenes, one at a time, and compares what Cycles and Granita make of it.

    ./dev bench properties [--blender 3.4 4.5] [--only PATTERN] [--anew]

6,000 flips of 32 by 32 pixels in each Blender: 40 minutes for both, on two cores with other work.  What was found so far is
kept in out/properties-VERSION.jsonl, so that a run that was stopped goes on; --anew begins again.  Writes
bench/results/properties.json: how many flips ended how, the faults, what the table allows and what Granita warned of.
A fault is where Cycles' picture changes and Granita's does not (or otherwise), or the other way round, without a
warning and without an entry in docs/manual/not_read.toml.  Ends with 1 where there is one.
"""

import argparse
import collections
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "properties"))
import exceptions  # noqa: E402
import worker  # noqa: E402

CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "granita"
RESULT = ROOT / "bench" / "results" / "properties.json"
FAULTS = ("differs", "silent", "own", "fails", "crash", "broken")
# Flips that end Blender are left out one by one: so many a version at most.
MOST_CRASHES = 60


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--blender", nargs="+", default=["3.4", "4.5"])
    parser.add_argument("--only", default="*", metavar="PATTERN", help="names of probes")
    parser.add_argument("--anew", action="store_true")
    options = parser.parse_args()
    table = exceptions.entries(exceptions.read_parts())
    results = json.loads(RESULT.read_text()) if RESULT.exists() else {}
    faulty = False
    for version in options.blender:
        results[version] = summary(run(version, options.only, options.anew), table)
        faulty |= bool(results[version]["faults"])
        print(f"Blender {version}: {results[version]['counts']}", flush=True)
        for fault in results[version]["faults"]:
            print("  {verdict}: {identifier}".format(**fault), flush=True)
    RESULT.write_text(json.dumps(results, indent=1) + "\n")
    sys.exit(1 if faulty else 0)


def command(version):
    script = str(ROOT / "tests" / "properties" / "worker.py")
    if version == "3.4":
        return (
            "blender -b --factory-startup --addons granita --python-exit-code 3 --python".split()
            + [script, "--"]
        )
    return [
        str(CACHE / f"bpy-{version}" / "bin" / "python"),
        str(ROOT / "tools" / "bpy_host.py"),
        script,
    ]


def run(version, pattern, anew):
    """[record], the last of each flip."""
    file = ROOT / "out" / f"properties-{version}.jsonl"
    file.parent.mkdir(exist_ok=True)
    if anew and file.exists():
        file.unlink()
    for _ in range(MOST_CRASHES):
        ended = subprocess.run([*command(version), str(file), pattern], stdout=subprocess.DEVNULL)
        if ended.returncode == 0:
            break
    return list(worker.read(file).values())


def summary(records, table):
    """What is kept of a version's run."""
    flips = [
        r for r in records if not (r["identifier"].startswith("probe ") and r["verdict"] == "done")
    ]
    faults, allowed = [], collections.defaultdict(int)
    for record in flips:
        if record["verdict"] not in FAULTS:
            continue
        entry = exceptions.listed(record, table)
        if entry is None:
            faults.append(record)
        else:
            allowed[entry["what"]] += 1
    return {
        "counts": dict(collections.Counter(r["verdict"] for r in flips).most_common()),
        "faults": faults,
        "listed": dict(sorted(allowed.items())),
        "warned": sorted({r["key"] for r in flips if r["verdict"] == "warned"}),
    }


if __name__ == "__main__":
    main()
