# SPDX-License-Identifier: GPL-3.0-or-later
"""The chapter's figures with scenes of our own: pictures, and what they cost.

    PYTHONPATH=<folder of granita_core> python3 bench/figures.py [--only 9.4 9.8 ...] [--out docs/figures]

Seconds are processor seconds of the process, user and system, as in the chapter; the least of `--runs` runs, executors
interleaved.  docs/figures.md says what each figure shows.
"""

import argparse
import json
import resource
import sys
from pathlib import Path

import figure_files as files
import figure_scenes as scenes
import numpy as np
import plot
import snapshots as s

RATES = [1, 4, 16, 36]
MULTIPASS, STOCHASTIC = "raster (OpenGL), REGULAR", "simd (CPU), INDEPENDENT"


def picture(snapshot):
    return s.render(snapshot)["combined"]


def shown(snapshot):
    return files.display(picture(snapshot))


def seconds(snapshot):
    """Of the whole frame on one thread; opening OpenGL and compiling shaders included."""
    snapshot["options"]["threads"] = 1
    before = resource.getrusage(resource.RUSAGE_SELF)
    s.render(snapshot)
    after = resource.getrusage(resource.RUSAGE_SELF)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def timed(runs, makers):
    """{name: least seconds} of {name: maker of a snapshot}, interleaved."""
    least = dict.fromkeys(makers, np.inf)
    for _ in range(runs):
        for name, make in makers.items():
            least[name] = min(least[name], seconds(make()))
    return {name: round(value, 3) for name, value in least.items()}


def curve(runs, out, name, title, x_name, values, makers):
    """Draws seconds over `values`; makers: {name: maker of a snapshot from a value}."""
    rows = {
        value: timed(runs, {n: lambda m=m, v=value: m(v) for n, m in makers.items()})
        for value in values
    }
    curves = {n: [(v, rows[v][n]) for v in values] for n in makers}
    panel = plot.Panel(title, curves, from_origin=True)
    plot.save(out / f"{name}.svg", [panel], x_name, "processor seconds")
    return {str(value): row for value, row in rows.items()}


def figure_9_4(out, runs):
    """16,000 transparent spheres; then z-batches and threshold on fewer, where peeling without them still ends."""
    files.write_png(out / "9.4.png", shown(scenes.particles(16000, scenes.independent(16))))

    def few(z_batch_size, threshold):
        options = scenes.regular(4) | {"z_batch_size": z_batch_size, "dicing_rate": 4.0}
        return scenes.particles(800, options | {"opacity_threshold": threshold, "bucket_size": 64})

    makers = {
        "one batch, no threshold": lambda: few(65536, 1.0),
        "z-batches of 26, no threshold": lambda: few(26, 1.0),
        "z-batches of 26, threshold .95": lambda: few(26, 0.95),
        "simd, threshold .95": lambda: scenes.particles(
            800, scenes.independent(4) | {"opacity_threshold": 0.95, "dicing_rate": 4.0}
        ),
    }
    return timed(runs, makers)


def figure_9_5(out, runs):
    images = [picture(scenes.planes(t, 160, scenes.regular(16))) for t in (1.0, 0.2)]
    batches = [picture(scenes.planes(0.2, 160, scenes.regular(16), b)) for b in (1, 3)]
    files.write_png(out / "9.5.png", files.side_by_side([[files.display(i) for i in images]]))
    return {
        "alpha behind three planes or more": float(images[1][60, 60, 3]),
        "pixels that differ between z-batches of 1, 3 and 26": sum(
            int((b != images[1]).any(axis=2).sum()) for b in batches
        ),
    }


def figure_9_6(out, runs):
    once = scenes.triangles_in_motion(scenes.independent(1, "RASTER"))
    result = s.render(once)
    many = scenes.triangles_in_motion(scenes.independent(256))
    pictures = [files.display(result["combined"]), shown(many)]
    enlarged = [files.enlarge(p, 4) for p in pictures]
    files.write_png(out / "9.6.png", files.side_by_side([enlarged]))
    statistics = result["statistics"]
    keys = ("gl_primitives", "sample_tests_static", "sample_tests_moving")
    return {key: statistics[key] for key in keys}


def figure_9_7(out, runs):
    rows = [
        [shown(scenes.radial_pattern(make(n))) for n in RATES]
        for make in (scenes.regular, scenes.independent)
    ]
    files.write_png(out / "9.7.png", files.side_by_side(rows))
    reference = picture(scenes.radial_pattern(scenes.independent(4096)))[..., 3]
    return {
        str(n): {
            name: rmse(picture(scenes.radial_pattern(make(n)))[..., 3], reference)
            for name, make in (("REGULAR", scenes.regular), ("INDEPENDENT", scenes.independent))
        }
        for n in RATES
    }


def rmse(image, reference):
    return round(float(np.sqrt(np.mean((image - reference) ** 2))), 5)


def figure_9_8(out, runs):
    makers = {
        "REGULAR": lambda n: scenes.creature(scenes.regular(16, n)),
        "INDEPENDENT": lambda n: scenes.creature(scenes.independent(n)),
    }
    images = {name: [picture(make(n)) for n in RATES] for name, make in makers.items()}
    rows = [[files.display(image) for image in row] for row in images.values()]
    files.write_png(out / "9.8.png", files.side_by_side(rows))
    reference = picture(scenes.creature(scenes.independent(2048)))
    return {
        name: dict(zip(map(str, RATES), (rmse(i, reference) for i in row)))
        for name, row in images.items()
    }


def figure_9_9(out, runs):
    makers = {
        MULTIPASS: lambda n: scenes.creature(scenes.regular(n), 0.0),
        STOCHASTIC: lambda n: scenes.creature(scenes.independent(n), 0.0),
    }
    title = "9.9: samples, nothing moves"
    return curve(runs, out, "9.9", title, "samples a pixel", [1, 4, 16, 36, 64, 100, 144], makers)


def figure_9_10(out, runs):
    makers = {
        MULTIPASS: lambda n: scenes.creature(scenes.regular(16, n)),
        STOCHASTIC: lambda n: scenes.creature(scenes.independent(n)),
    }
    title = "9.10: time samples, 40 pixels of motion"
    return curve(runs, out, "9.10", title, "time samples", [1, 4, 8, 16, 32, 48, 64], makers)


def figure_motion(out, runs):
    """As many passes as pixels of motion, which is what avoids strobing, against 64 samples of their own."""
    makers = {
        MULTIPASS + ", 4 samples a pass": lambda n: scenes.creature(
            scenes.regular(4, max(1, n)), n
        ),
        STOCHASTIC + ", 64 samples": lambda n: scenes.creature(scenes.independent(64), n),
    }
    title = "Long ways: a pass a pixel"
    return curve(runs, out, "motion", title, "pixels of motion", [0, 5, 20, 50, 100], makers)


def figure_9_11(out, runs):
    files.write_png(out / "9.11.png", shown(scenes.army(800, scenes.regular(36))))
    makers = {
        MULTIPASS: lambda: scenes.army(800, scenes.regular(36)),
        STOCHASTIC: lambda: scenes.army(800, scenes.independent(36)),
    }
    return timed(runs, makers)


def figure_9_12(out, runs):
    pair = [shown(scenes.feathers(scenes.independent(64), moving, 200)) for moving in (False, True)]
    files.write_png(out / "9.12.png", files.side_by_side([pair]))
    rows = {}
    for moving in (False, True):
        makers = {
            MULTIPASS: lambda m=moving: scenes.feathers(scenes.regular(4, 64), m, 64),
            STOCHASTIC: lambda m=moving: scenes.feathers(scenes.independent(64), m, 64),
        }
        rows["moving" if moving else "still"] = timed(runs, makers)
    return rows


FIGURES = {
    "9.4": figure_9_4,
    "9.5": figure_9_5,
    "9.6": figure_9_6,
    "9.7": figure_9_7,
    "9.8": figure_9_8,
    "9.9": figure_9_9,
    "9.10": figure_9_10,
    "motion": figure_motion,
    "9.11": figure_9_11,
    "9.12": figure_9_12,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=FIGURES, default=list(FIGURES))
    parser.add_argument("--out", type=Path, default=Path(__file__).parent.parent / "docs/figures")
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    record = options.out / "measured.json"
    measured = json.loads(record.read_text()) if record.exists() else {}
    for name in options.only:
        measured[name] = FIGURES[name](options.out, options.runs)
        print(name, json.dumps(measured[name], indent=1), file=sys.stderr)
    record.write_text(json.dumps(measured, indent=1) + "\n")


if __name__ == "__main__":
    main()
