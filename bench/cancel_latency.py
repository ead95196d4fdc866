# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds from a cancel at a random moment until all native threads of the picture have stopped.

    ./dev bench cancel_latency [--moments 200] [--scenes lit feathers demo] [--seed 1] [--bounces 4]
        [--within 6]

480x270, light followed over so many bounces, both as a final frame and as an edited view's picture, whose session keeps
what it can; at moments of the first seconds, `--within`, of what takes longer.  Prints the median, the
.99 quantile and the worst, the processor seconds of all threads likewise (a busy machine makes the others longer), and of
the worst when they were cancelled and how many buckets were done.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROMISED = 0.05


def main():
    from measure import save

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--moments", type=int, default=200)
    parser.add_argument("--scenes", nargs="+", default=["lit", "feathers", "demo"])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--bounces", type=int, default=4)
    parser.add_argument("--within", type=float, default=6.0)
    job = vars(parser.parse_args())
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "rows.json"
        file = Path(folder) / "job.json"
        file.write_text(json.dumps({**job, "file": str(out)}))
        words = ["blender", "-b", "--factory-startup", "--addons", "granita"]
        words += ["--python-exit-code", "1", "--python", __file__, "--", str(file)]
        subprocess.run(words, stdin=subprocess.DEVNULL, check=True)
        save("cancel_latency", json.loads(out.read_text()))


def measured_inside_blender():
    import random
    import time

    import bpy

    sys.path.insert(0, str(HERE))
    import lit_scenes
    import numpy as np
    import render_frames
    import scenes

    bridge = sys.modules["granita.bridge"]
    export_frame = sys.modules["granita.export"].export_frame
    report = sys.modules["granita.export.base.report"].Report
    job = json.loads(Path(sys.argv[sys.argv.index("--") + 1]).read_text())
    chance = random.Random(job["seed"])

    def snapshot_of(name):
        if name == "demo":
            scene = render_frames.build_demo()[0]
        else:
            scene = {**scenes.SCENES, **lit_scenes.SCENES}[name]()
            scene.render.use_motion_blur = True
        scene.render.threads_mode = "AUTO"
        scene.render.resolution_x, scene.render.resolution_y = 480, 270
        scene.render.resolution_percentage = 100
        scene.granita.samples = 64
        render_frames.engines.set_bounces(scene, job["bounces"])
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return export_frame(None, depsgraph, scene.granita, report())

    def begin(snapshot, session):
        core = bridge.load()
        return core.Render(core.Scene(snapshot, session))

    def ended(job):
        """(seconds until it has, processor seconds, whether it was cancelled)"""
        began, processor, was_cancelled = time.perf_counter(), time.process_time(), False
        job.cancel()
        try:
            job.finish()
        except bridge.load().Cancelled:
            was_cancelled = True
        return time.perf_counter() - began, time.process_time() - processor, was_cancelled

    rows = []
    for name in job["scenes"]:
        snapshot = snapshot_of(name)
        for kind in ("final frame", "view"):
            session = bridge.new_session() if kind == "view" else None
            began = time.perf_counter()
            whole = begin(snapshot, session)
            while not whole.done() and time.perf_counter() - began < job["within"]:
                whole.take_tiles(0.05)
            ended(whole)
            seconds = time.perf_counter() - began
            taken = []
            while len(taken) < job["moments"]:
                if session is not None:  # another picture of the same things
                    camera = dict(snapshot["camera"])
                    camera["center"] = np.add(camera["center"], chance.uniform(-2, 2)).tolist()
                    snapshot = {**snapshot, "camera": camera}
                running = begin(snapshot, session)
                moment = chance.uniform(0.0, seconds)
                time.sleep(moment)
                latency, processor, was_cancelled = ended(running)
                if was_cancelled:
                    done = f"{running.buckets_done}/{running.buckets_total}"
                    taken.append((latency, processor, moment, done))
            taken.sort()
            latencies = [one[0] for one in taken]
            processor = sorted(one[1] for one in taken)
            row = {"scene": name, "kind": kind, "within": seconds, "bounces": job["bounces"]}
            row |= {"median": latencies[len(taken) // 2], "most": latencies[-1]}
            row |= {"late": sum(x > PROMISED for x in latencies), "of": len(taken)}
            row |= {".99": latencies[int(0.99 * (len(taken) - 1))], "worst": taken[-5:]}
            row["processor"] = processor[len(taken) // 2], processor[-1]
            print({k: round(v, 4) if isinstance(v, float) else v for k, v in row.items()})
            sys.stdout.flush()
            rows.append(row)
    Path(job["file"]).write_text(json.dumps(rows))


if __name__ == "__main__":
    if "bpy" in sys.modules:
        measured_inside_blender()
    else:
        main()
