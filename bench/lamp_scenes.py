# SPDX-License-Identifier: GPL-3.0-or-later
"""Many small lamps over spheres on a floor, of the same power together; nothing moves, no bounces."""

import numpy as np
from lit_scenes import checker, lamp, plane, textured
from scenes import add_camera, add_spheres, empty

WATTS = 8000.0


def lamps(count):
    scene = empty(320)
    add_spheres(scene, "ShaderNodeBsdfDiffuse", None, (-7, -4, 0), (7, 4, 2), 30)
    plane(scene, "Floor", textured("Floor", checker(0.7)))
    random = np.random.default_rng(11)
    for place, part in zip(
        random.uniform((-9, -6, 1), (9, 6, 7), (count, 3)),
        random.uniform(0.3, 1.7, count),
        strict=True,
    ):
        lamp(scene, "POINT", WATTS / count * part, place, shadow_soft_size=0.1)
    add_camera(scene, (0, -8, 18), focal=45, tilt=0.4)
    return scene


SCENES = {f"lamps_{count}": lambda count=count: lamps(count) for count in (10, 100, 1000)}
