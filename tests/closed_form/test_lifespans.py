# SPDX-License-Identifier: GPL-3.0-or-later
"""Things that appear or vanish within the shutter: of every kind of geometry, moving or still, in the picture and in
shadows.
"""

import numpy as np
import pytest
import snapshots as s


def square(snapshot, **more):
    s.quad(snapshot, s.rectangle(-50, -50, 100, 100), s.emission(snapshot), **more)


def cage(snapshot, **more):
    points, faces = s.rectangle(-50, -50, 100, 100), [(0, 1, 2, 3)]
    s.mesh(snapshot, points, faces, s.emission(snapshot), subdivision={"scheme": "SIMPLE"}, **more)


def small_faces(snapshot, **more):
    """A hundred faces a pixel and less wide, which share grids."""
    side = np.linspace(-1, 33, 60)
    x, y = np.meshgrid(side, side)
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, 5.0)], 1)
    first = (np.arange(59)[:, None] * 60 + np.arange(59)).ravel()
    faces = np.stack([first, first + 1, first + 61, first + 60], 1)
    s.mesh(snapshot, points, faces, s.emission(snapshot), **more)


def hair(snapshot, **more):
    elements(snapshot, "CURVES", [(-20, 16, 5), (0, 16, 5), (20, 16, 5), (60, 16, 5)], 60.0, more)
    snapshot["geometries"][-1]["curve_sizes"] = np.array([4], np.int32)


def spheres(snapshot, **more):
    elements(snapshot, "POINTS", [(16, 16, 90)], 60.0, more)


def elements(snapshot, kind, points, radius, more):
    snapshot["geometries"].append(
        {
            "name": "points 'P'",
            "kind": kind,
            "points": np.array([points], np.float32),
            "radius": np.full((1, len(points)), radius, np.float32),
        }
    )
    s.instance(snapshot, len(snapshot["geometries"]) - 1, s.emission(snapshot), **more)


@pytest.mark.parametrize("build", [square, cage, small_faces, hair, spheres])
@pytest.mark.parametrize("shift", [0.0, 6.0])
def test_everything_covers_its_share_of_the_shutter(executor, build, shift):
    """64 samples of a pixel lie in as many equal parts of the shutter: each end is off by one at most."""
    snapshot = s.orthographic((16, 16), samples=64, executor=executor)
    build(
        snapshot,
        transforms=[s.translation(-shift / 2), s.translation(shift / 2)],
        lifespan=(0.31, 0.73),
    )
    assert np.abs(s.alpha(snapshot)[4:12, 4:12] - 0.42).max() <= 2 / 64


@pytest.mark.parametrize("passes", [0, 16])
@pytest.mark.parametrize("run", ["REFERENCE", "SIMD", "COMPUTE", "RASTER"])
def test_regular_passes(run, passes):
    """Of passes of their own, as many as an end needs to be off by .02 at most; of 16, by half of one."""
    snapshot = s.orthographic(
        (16, 16), samples=4, sampling="REGULAR", time_samples=passes, executor=run
    )
    square(snapshot, lifespan=(0.31, 1.0))
    limit = 0.5 / passes if passes else 0.02
    assert np.abs(s.alpha(snapshot) - 0.69).max() <= limit + 1e-6


@pytest.mark.parametrize("sampling", ["INDEPENDENT", "REGULAR"])
@pytest.mark.parametrize("run", ["REFERENCE", "SIMD", "COMPUTE", "RASTER"])
@pytest.mark.parametrize("shift", [0.0, 9.0])
def test_two_that_take_turns_are_one(run, sampling, shift):
    """Bit by bit, in front of a background and of each other."""

    def picture(lifespans):
        snapshot = s.orthographic(
            (24, 16), samples=16, time_samples=8, sampling=sampling, executor=run
        )
        s.quad(snapshot, s.rectangle(4, -5, 12, 30, 8), s.emission(snapshot, (0.2, 0.5, 0.1)))
        color = s.emission(snapshot, (0.9, 0.3, 0.6))
        for lifespan in lifespans:
            ways = [s.translation(0), s.translation(shift, shift / 3)] if shift else None
            corners = s.rectangle(1.3, 2.1, 10.2, 12.7, 5)
            s.quad(snapshot, corners, color, transforms=ways, lifespan=lifespan)
        return s.render(snapshot)["combined"]

    # And one that never is: as many passes, whose mean rounds the same.
    expected = picture([(0.0, 1.0), (0.2, 0.2)])
    assert np.array_equal(picture([(0.0, 0.37), (0.37, 1.0)]), expected)


def test_a_caster_shades_for_as_long_as_it_exists(executor):
    """A sun straight above, which is seen from below: of the light that falls on the floor, a lid that exists for
    .42 of the shutter takes as much.  1024 rays a point, stratified in time: each end is off by one."""
    snapshot = lit_floor(executor, lid=(0.31, 0.73))
    light, shaded = (
        s.render(scene)["combined"][8, 8, 0] for scene in (lit_floor(executor), snapshot)
    )
    assert light > 0.1
    assert shaded / light == pytest.approx(1 - 0.42, abs=2 / 1024 + 1e-5)


def test_light_falls_on_what_is_there_while_it_is(executor):
    """A lid over the floor until .37, the floor from then on: nothing is in its light."""
    alone = s.render(lit_floor(executor, floor=(0.37, 1.0)))["combined"]
    lidded = s.render(lit_floor(executor, lid=(0.0, 0.37), floor=(0.37, 1.0)))["combined"]
    # One ray tells of a sun, or 1024 equal ones, whose sum in float rounds.
    assert lidded == pytest.approx(alone, rel=1024 * 2.0**-24) and alone[8, 8, 0] > 0.05


def lit_floor(executor, lid=None, floor=(0.0, 1.0)):
    """Seen from above (+z is away from the camera), the lid by the sun alone."""
    snapshot = s.orthographic((16, 16), samples=16, light_samples=1024, executor=executor)
    snapshot["lights"] = [
        {
            "name": "Sun",
            "kind": "SUN",
            # Shines along its -z, which is +z here.
            "world_from_light": np.diag([1.0, -1.0, -1.0, 1.0])[None],
            "color": (1, 1, 1),
            "energy": 1.0,
            "sun_angle": 0.0,
        }
    ]
    s.quad(snapshot, s.rectangle(-5, -5, 30, 30, 50), lifespan=floor)
    if lid is not None:
        s.quad(snapshot, s.rectangle(-9, -9, 40, 40, 9), lifespan=lid)
        snapshot["instances"]["flags"] = [3, 2]
    return snapshot


@pytest.mark.parametrize("broken", [(0.6, 0.4), (np.nan, 1.0), (0.0, np.nan)])
def test_what_is_no_interval_is_named(broken):
    import granita_core

    snapshot = s.orthographic((16, 16))
    square(snapshot, lifespan=broken)
    with pytest.raises(granita_core.SceneError, match="object 'Object 0'.*lifespan"):
        s.render(snapshot)


@pytest.mark.parametrize("broken", [(0.6, 0.4), (np.nan, 1.0), (0.0, np.nan)])
def test_of_lamps_likewise(broken):
    import granita_core

    snapshot = s.orthographic((16, 16))
    lamp = {"name": "Lamp", "kind": "SUN", "world_from_light": np.eye(4)[None]}
    lamp |= {"color": (1, 1, 1), "energy": 1.0, "lifespan": np.float32(broken)}
    snapshot["lights"] = [lamp]
    with pytest.raises(granita_core.SceneError, match="light 'Lamp'.*lifespan"):
        s.render(snapshot)
