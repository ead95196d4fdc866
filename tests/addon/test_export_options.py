# SPDX-License-Identifier: GPL-3.0-or-later
"""Shutter times, borders and seeds worked out by hand."""

from export.base.report import ExportError, Report
from export.scene.camera import Frame
from export.scene.options import border, light_samples, mixed_seed


def test_border_truncates():
    # Sizes that Blender itself gave for this frame and border: 49 by 31.
    assert border(Frame(101, 67), 0.26, 0.25, 0.75, 0.713) == (26, 16, 75, 47)


def test_border_multiplies_in_single_precision():
    # .7 is .69999999 in single precision, but ten times it rounds to 7.
    assert border(Frame(10, 10), 0.0, 0.0, 0.699999988079071, 1.0)[2] == 7


def test_border_stays_inside_the_frame():
    assert border(Frame(10, 10), -1.0, 0.0, 3.0, 1.0) == (0, 0, 10, 10)


def test_mixed_seeds_differ_from_frame_to_frame_and_fit_31_bits():
    seeds = [mixed_seed(seed, frame) for seed in range(20) for frame in range(-50, 50)]
    assert len(set(seeds)) == len(seeds)
    assert all(0 <= seed < 2**31 for seed in seeds)


def test_light_samples_grow_with_samples_beyond_64():
    assert [light_samples(16, samples, 0.0) for samples in (1, 16, 64)] == [16, 16, 16]
    assert [light_samples(16, samples, 0.0) for samples in (128, 256, 1024)] == [32, 64, 256]
    # Sequences of light samples are stratified in powers of two.
    assert [light_samples(3, samples, 0.0) for samples in (100, 127, 200, 300)] == [3, 3, 6, 12]


def test_samples_that_are_a_bound_tell_nothing_of_light():
    assert light_samples(16, 4096, 0.01) == 16


def test_report_counts_each_message_once():
    report = Report()
    report("mesh 'A'", "broken")
    report.warn("mesh 'B'", "broken")
    report.warn("mesh 'A'", "broken")
    assert report.entries() == [("mesh 'A'", "broken", 2), ("mesh 'B'", "broken", 1)]
    assert len(report) == 2


def test_error_names_the_datablock():
    assert str(ExportError("scene 'S'", "has no camera")) == "scene 'S': has no camera"
