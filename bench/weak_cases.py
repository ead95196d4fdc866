# SPDX-License-Identifier: GPL-3.0-or-later
"""The weak cases that the chapter names, each measured against its limit, in one run on one thread.

    ./dev bench weak_cases [--runs 11] [--only motion tiny ...]

Medians, in turns; frames are taken in processor seconds, hiding in wall seconds of its stage.  Prints a Markdown table
and writes bench/results/weak_cases.json.  The ripple of the eight filters is a test: tests/native/film/pass_count_test.cpp.
"""

import argparse

import measure
import numpy as np
import snapshot_scenes as scenes
from snapshot_scenes import s


def strobing(table, runs):
    """A line of one pixel moves 40 pixels.  16 passes step 2.5 pixels: their frequency is .4 a pixel."""

    def profile(samples, **options):
        options = {**scenes.DEFAULT_FILTER, "samples": samples, **options}
        snapshot = s.orthographic((64, 16), **options)
        shift = [s.translation(0), s.translation(40)]
        line = s.rectangle(10.3, -20, 11.3, 90)
        s.quad(snapshot, line, s.emission(snapshot), transforms=shift)
        row = s.alpha(snapshot).mean(0)[16:46]  # 30 pixels, 12 periods, away from both ends
        return row / row.mean() - 1

    def spectrum(row):
        return 2 / len(row) * np.abs(np.fft.rfft(row))[1:]

    at = 12 - 1  # .4 cycles a pixel over 30 pixels
    coarse = spectrum(profile(64, sampling="REGULAR", time_samples=16))
    table.row("strobing index of 16 passes, which must be seen", coarse[at], 0.5, least=True)
    noise = spectrum(profile(64))
    over_noise = noise[at] / np.median(noise)
    table.row("strobing index, INDEPENDENT, over the median of the noise", over_noise, 3)
    # The lattice rounds the line's places to 1/8 or 1/32 pixel; what passes add shows with the finer one.
    for samples in (64, 1024):
        ripple = np.ptp(profile(samples, sampling="REGULAR")) / 2
        name = f"ripple of REGULAR with passes of its own, {samples} samples"
        table.row(name, ripple, 0.02, "{:.4f}")


def motion(table, runs):
    """Equal micropolygons, wholly on screen, 100 pixels of motion against 5.

    What moves passes more tiles, whose samples are made, placed and stored whatever sees them: a sheet that is 208 pixels
    wide passes 20 columns of them and not 14, 1.43 times as many, before anything is hidden.  The sheet here is 640
    pixels a side: 48 columns and not 42, 1.14.
    """
    for sampling, limit in (("INTERLEAVED", 1.3), ("INDEPENDENT", 3.0)):
        large = {"size": (960, 960), "margin": (160, 160)}
        cases = {p: scenes.sheet(p, **large, samples=64, sampling=sampling) for p in (5, 100)}
        counts = {s.render(c)["statistics"]["points_diced"] for c in cases.values()}
        if len(counts) != 1:
            raise AssertionError(f"points of micropolygons differ: {counts}")
        taken = measure.interleaved(cases, measure.hide_seconds, runs)
        table.row(f"hiding at 100 px over 5 px, {sampling}", taken[100] / taken[5], limit)


def growth(table, runs):
    """Exponents of hiding: with micropolygons, of a pixel to a quarter of one, and with samples."""
    for pixels in (0, 20):
        rates = {r: scenes.sheet(pixels, samples=64, dicing_rate=r) for r in (1.0, 0.25)}
        taken = measure.interleaved(rates, measure.hide_seconds, max(1, runs // 2))
        row = f"exponent of hiding with micropolygons, {pixels} px"
        # Both edges are a quarter as long.
        table.row(row, np.log(taken[0.25] / taken[1.0]) / np.log(16), 1.05)
        samples = {n: scenes.sheet(pixels, samples=n) for n in (16, 1024)}
        taken = measure.interleaved(samples, measure.hide_seconds, max(1, runs // 2))
        row = f"exponent of hiding with samples, {pixels} px"
        table.row(row, np.log(taken[1024] / taken[16]) / np.log(1024 / 16), 1.05)


def feathers(table, runs):
    cases = {a: scenes.feathers(a, samples=64) for a in (0.0, 0.5)}
    taken = measure.interleaved(cases, measure.frame_seconds, runs)
    table.row("moving feathers over still ones, frame, 64 samples", taken[0.5] / taken[0.0], 3)


def tiny(table, runs):
    """A million grids of one micropolygon against one face of as many."""
    raster = {"executor": "RASTER", "sampling": "REGULAR"}
    for what, seconds, limit, executor in (
        ("hiding", measure.hide_seconds, 1.5, {}),
        ("frame", measure.frame_seconds, 4.0, {}),
        ("frame, RASTER", measure.frame_seconds, 4.0, raster),
    ):
        cases = {
            whole: scenes.tiles(1000, whole, samples=16, **executor) for whole in (True, False)
        }
        taken = measure.interleaved(cases, seconds, max(1, runs // 4))
        table.row(f"a million tiny grids over one face, {what}", taken[False] / taken[True], limit)


def threshold(table, runs):
    """Batches of any size give the same bits; the threshold's bias is bounded by what it leaves."""

    def feathers(executor, batch, opacity_threshold):
        sampling = "REGULAR" if executor == "RASTER" else "INDEPENDENT"
        options = {
            "samples": 16,
            "sampling": sampling,
            "time_samples": 1,
            "crop": (100, 60, 164, 124),
        }
        options |= {"executor": executor, "z_batch_size": batch}
        return s.render(scenes.feathers(**options, opacity_threshold=opacity_threshold))["combined"]

    for executor in ("SIMD", "RASTER"):
        exact, first = feathers(executor, 26, 1.0), feathers(executor, 1, 0.9)
        different = sum(
            int((feathers(executor, batch, 0.9) != first).sum()) for batch in (10, 1000, 65536)
        )
        table.row(
            f"values that z-batches of 1, 10, 1000 and all change, {executor}", different, 0, "{}"
        )
        table.row(f"bias of the threshold .9, {executor}", float(np.abs(exact - first).max()), 0.1)


PASSES = ["Depth", "Mist", "Position", "Normal", "UV", "Object Index", "Material Index"]
PASSES += ["Diffuse Color", "Glossy Color", "Emission", "Environment", "Shadow"]


def passes(table, runs):
    cases = {n: scenes.spheres(20.0, samples=64, passes=PASSES[:n]) for n in (1, 12)}
    counters = [s.render(c)["statistics"] for c in cases.values()]
    names = (
        "micropolygons",
        "sample_tests_static",
        "sample_tests_moving",
        "sample_hits",
        "points_shaded",
    )
    different = sum(counters[0][name] != counters[1][name] for name in names)
    table.row("counters of visibility that 12 passes change", different, 0, "{}")
    taken = measure.interleaved(cases, measure.frame_seconds, runs)
    table.row("12 passes over one, frame", taken[12] / taken[1], 2.0)


def coincident(table, runs):
    """Two layers in one place: 1 - (1 - .3)(1 - .6)."""
    for executor in ("REFERENCE", "SIMD", "COMPUTE", "RASTER"):
        sampling = "REGULAR" if executor == "RASTER" else "INDEPENDENT"
        snapshot = s.orthographic((16, 16), samples=16, executor=executor, sampling=sampling)
        for alpha in (0.3, 0.6):
            s.quad(snapshot, s.rectangle(-9, -9, 30, 30), s.emission(snapshot, (1, 1, 1), alpha))
        error = float(np.abs(s.alpha(snapshot) - 0.72).max())
        table.row(f"error of coincident layers, {executor}", error, 2e-6, "{:.1e}")


def unused(table, runs):
    """What is not used is not paid for: counters, and a corner of one bucket with everything in it."""

    def scene(corner, moves=0.0, alpha=None):
        snapshot = scenes.spheres(samples=64)
        if corner:
            s.quad(
                snapshot,
                s.rectangle(4, 4, 12, 12, 50),
                s.emission(snapshot, (1, 1, 1), alpha),
                transforms=scenes.shift(moves),
            )
        return snapshot

    still = s.render(scene(True))["statistics"]
    used = ("sample_tests_moving", "fragments_stored", "buckets_moving", "buckets_transparent")
    table.row(
        "moving tests and lists of a still, opaque frame", sum(still[n] for n in used), 0, "{}"
    )
    one = s.render(scene(True, 3.0, 0.5))["statistics"]
    most = max(one["buckets_moving"], one["buckets_transparent"])
    table.row("buckets with motion or lists for one thing inside one", most, 1, "{}")
    cases = {"still": scene(True), "one": scene(True, 3.0, 0.5)}
    taken = measure.interleaved(cases, measure.frame_seconds, runs)
    table.row(
        "a frame with motion and lists in one bucket over one without",
        taken["one"] / taken["still"],
        1.1,
    )


CASES = {
    c.__name__: c
    for c in (strobing, motion, growth, feathers, tiny, threshold, passes, coincident, unused)
}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=11)
    parser.add_argument("--only", nargs="+", choices=CASES, default=CASES)
    options = parser.parse_args()
    table = measure.Table()
    table.header()
    for name in options.only:
        CASES[name](table, options.runs)
    table.save("weak_cases")


if __name__ == "__main__":
    main()
