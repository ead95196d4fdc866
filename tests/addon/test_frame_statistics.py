# SPDX-License-Identifier: GPL-3.0-or-later
"""The JSON object of a frame: view layers are summed, files are appended to, failures are named."""

import json
from types import SimpleNamespace

import pytest

from addon.frame_statistics import FrameStatistics, StatisticsFileError

OPTIONS = {"frame": 7, "width": 64, "height": 48, "samples": 4}


def add(statistics, name, frame=7, warnings=()):
    layer = SimpleNamespace(layer=name, scene="Scene", seconds={"export": 0.25, "total": 2.0})
    counters = {"grids_diced": 3, "seconds_dice": 0.5, "peak_grid_bytes": 100, "device": "CPU"}
    job = SimpleNamespace(device="CPU (simd)", statistics=lambda: counters)
    statistics.add_layer(layer, {**OPTIONS, "frame": frame}, job, warnings)


@pytest.fixture
def file(tmp_path):
    return tmp_path / "stats.json"


def read(file):
    return [json.loads(line) for line in file.read_text().splitlines()]


def test_view_layers_are_summed(file):
    statistics = FrameStatistics()
    statistics.open(str(file))
    add(statistics, "First", warnings=[("mesh 'A'", "two NaN", 2)])
    add(statistics, "Second")
    statistics.write()
    (record,) = read(file)
    assert record.pop("peak_resident_bytes") > 2**20
    assert record == {
        "frame": 7,
        "scene": "Scene",
        "view_layers": ["First", "Second"],
        "width": 64,
        "height": 48,
        "samples": 4,
        "device": "CPU (simd)",
        "seconds": {"export": 0.5, "total": 4.0},
        "statistics": {"grids_diced": 6, "seconds_dice": 1.0, "peak_grid_bytes": 100},
        "warnings": [{"datablock": "mesh 'A'", "message": "two NaN", "count": 2}],
    }


def test_frames_are_appended_and_unfinished_ones_left_out(file):
    file.write_text('{"frame": 1}\n')
    statistics = FrameStatistics()
    for frame in (2, 3, 4):
        statistics.open(str(file))
        add(statistics, "Layer", frame)
        if frame == 3:
            statistics.discard()
        statistics.write()
    assert [record["frame"] for record in read(file)] == [1, 2, 4]


def test_without_a_file_nothing_is_written(tmp_path):
    statistics = FrameStatistics()
    statistics.open(None)
    add(statistics, "Layer")
    statistics.write()
    assert list(tmp_path.iterdir()) == []


def test_unwritable_file_is_named_before_the_frame():
    with pytest.raises(StatisticsFileError, match=r"'/nowhere/s\.json' cannot be written"):
        FrameStatistics().open("/nowhere/s.json")


def test_full_disk_is_named():
    statistics = FrameStatistics()
    statistics.open("/dev/full")
    add(statistics, "Layer")
    with pytest.raises(StatisticsFileError, match=r"'/dev/full' cannot be written"):
        statistics.write()
