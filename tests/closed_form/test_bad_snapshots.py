# SPDX-License-Identifier: GPL-3.0-or-later
"""What a snapshot must not hold is refused by an error that names the datablock and what is wrong with it."""

import numpy as np
import pytest
import snapshots as s
from process_parts import HERE, last_printed

import granita_core


def wrong(path, value):
    """A square before a camera, of which the entry at `path` is `value`; a callable makes it of what was there."""
    snapshot = s.orthographic((16, 16))
    s.quad(snapshot, s.rectangle(2, 2, 12, 12), s.emission(snapshot))
    *folders, key = path
    place = snapshot
    for folder in folders:
        place = place[folder]
    place[key] = value(place[key]) if callable(value) else value
    return snapshot


@pytest.mark.parametrize(
    "path, value, says",
    [
        (("options", "sampels"), 16, "scene options: 'sampels' is unknown"),
        (("options", "samples"), 0, "'samples'"),
        (("options", "samples"), "many", "'samples' must be a number"),
        (("options", "sampling"), "RANDOM", "'sampling' is 'RANDOM', expected one of INDEPENDENT"),
        (("options", "bucket_size"), 17, "'bucket_size' must be a multiple"),
        (("options", "frame_time"), np.nan, "'frame_time' must be finite"),
        (("camera", "fstop"), 2.8, "camera 'Camera': 'fstop' is unknown"),
        (("camera", "world_from_camera"), np.full((1, 4, 4), np.inf), "holds a value that is not"),
        (("camera", "lens_knots"), np.ones((2, 3)), "'lens_knots' must have shape [any, 2]"),
        (("camera", "lens_knots"), np.array([[0.1, np.nan]]), "must hold finite radii"),
        (("camera", "scale"), np.zeros(2), "camera 'Camera': 'scale' must be positive"),
        (("geometries", 0, "points"), lambda p: p[..., :2], "'points' must have shape"),
        (("geometries", 0, "corner_verts"), lambda c: c + 9, "corner_verts"),
    ],
    ids=lambda value: "/".join(map(str, value)) if isinstance(value, tuple) else "",
)
def test_it_is_refused_by_name(path, value, says):
    with pytest.raises(granita_core.SceneError) as error:
        s.render(wrong(path, value))
    assert says in str(error.value)


def test_none_of_a_few_damaged_by_chance_ends_the_process():
    """`./dev bench damaged_snapshots` is the same by the hundred thousands."""
    ends = last_printed(HERE / "damaged_parts.py", 0, 300)
    assert ends["refused"] > 30 and ends["rendered"] > 30
