# SPDX-License-Identifier: GPL-3.0-or-later
"""Ray Visibility of a world, which Cycles' add-on brings."""

import bpy
import export_probe
import pytest
import scene_parts as parts


@pytest.mark.parametrize("hidden", ["camera", "diffuse", "glossy"])
def test_rays_that_see_it_all_the_same_are_named(scene, hidden):
    parts.add_camera(scene)
    scene.world = bpy.data.worlds.new("Sky")
    _, report, _ = export_probe.through_engine(scene)
    assert len(report) == 0
    setattr(scene.world.cycles_visibility, hidden, False)
    _, report, _ = export_probe.through_engine(scene)
    ((datablock, message, _),) = report.entries()
    assert datablock == "world 'Sky'" and hidden in message
