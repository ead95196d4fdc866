# SPDX-License-Identifier: GPL-3.0-or-later
"""One view through a chain of edits of each kind, in scenes of all that a picture may hold: after each the settled
picture is F12's of that state, bit for bit."""

import numpy as np
import pytest
import view_parts
from view_scenes import EDITS, SCENES

# Each edit in two of the scenes, of different kinds; in order, one on top of the other.
_TURNS = 3


@pytest.mark.parametrize("build", SCENES, ids=lambda build: build.__name__)
def test_a_view_follows_every_edit(scene, render, build):
    build(scene)
    scene.render.resolution_x, scene.render.resolution_y = 48, 32
    view = view_parts.View((48, 32)).look_through_camera()
    try:
        wrong, before = [], view.edited().settle().copy()
        for name in list(EDITS)[SCENES.index(build) % _TURNS :: _TURNS]:
            EDITS[name](scene)
            seen = view.edited().settle()
            planes = render(scene)
            final = np.stack([planes[f"ViewLayer.Combined.{c}"] for c in "RGBA"], axis=-1)
            if not np.array_equal(seen, final):
                same = "as it was" if np.array_equal(seen, before) else ""
                wrong.append((name, float(np.abs(seen - final).max()), same))
            before = seen.copy()
    finally:
        view.look_through_camera().close()
    assert not wrong
