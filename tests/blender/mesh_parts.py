# SPDX-License-Identifier: GPL-3.0-or-later
"""A cube for tests of exported meshes."""

import pytest
import scene_parts

# A cube by hand: the numbers of its corners are what tests count on.
CUBE = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
CUBE_FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


@pytest.fixture(name="cube")
def cube_in_view(scene):
    scene_parts.add_camera(scene)
    return scene_parts.add_mesh(scene, "Cube", CUBE, CUBE_FACES)
