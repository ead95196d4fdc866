# SPDX-License-Identifier: GPL-3.0-or-later
"""What shadow catchers lose of their light, where it is known: all of it, none, or half."""

import numpy as np
import pytest
import snapshots as s
from session_parts import Kept, matte
from test_volumes import absorption, box, filled

SIZE = 32
SEEN, CATCHER = 123, 128
UNSEEN = SEEN - 1
TOWARDS = np.diag([1.0, -1.0, -1.0, 1.0])  # along the view, +z


def sun(**values):
    return {
        "name": "Sun",
        "kind": "SUN",
        "world_from_light": TOWARDS[None],
        "energy": np.pi,
    } | values


def plate(lights=None, behind=False, **options):
    """A catcher before all of the frame, and above it, unseen, what takes the sun from its left half."""
    options = {"samples": 16, "light_samples": 4, "film_transparent": True, **options}
    snapshot = s.orthographic((SIZE, SIZE), **options)
    material = matte(snapshot, (0.8, 0.5, 0.2))
    s.quad(snapshot, s.rectangle(-99, -99, 99, 99, 10.0), material)
    s.quad(snapshot, s.rectangle(-99, -99, SIZE / 2, 99, 5.0), material)
    flags = [SEEN | CATCHER, UNSEEN]
    if behind:
        s.quad(snapshot, s.rectangle(-99, -99, 99, 99, 20.0), s.emission(snapshot, (1, 1, 1)))
        flags.append(SEEN)
    snapshot["instances"]["flags"] = flags
    snapshot["lights"] = [sun()] if lights is None else lights
    return snapshot


@pytest.mark.parametrize("behind", [False, True])
def test_shadow_is_black_and_light_is_not_there(behind):
    """And what is behind is not seen.  Columns beside the edge may be shadow in part."""
    combined = s.render(plate(behind=behind))["combined"]
    assert np.all(combined[..., :3] == 0.0)
    assert np.all(combined[:, : SIZE // 2 - 1, 3] == 1.0)
    assert np.all(combined[:, SIZE // 2 + 1 :, 3] == 0.0)


def test_the_world_is_seen_where_light_is():
    snapshot = plate(film_transparent=False)
    s.constant_world(snapshot, 0.5)
    snapshot["world"]["lights_scene"] = False
    combined = s.render(snapshot)["combined"]
    assert combined[:, SIZE // 2 + 1 :, :3] == pytest.approx(0.5, abs=1e-6)
    assert np.all(combined[:, : SIZE // 2 - 1, :3] == 0.0)
    assert np.all(combined[..., 3] == 1.0)


@pytest.mark.parametrize("film", [False, True])
def test_the_pass_says_by_how_much(film):
    """Half of the light is of a lamp that is composed in, which casts a shadow too."""
    lights = [sun(), sun(name="Lamp", lights_catchers=False)]
    snapshot = plate(lights, film_transparent=film, passes=["Combined", "Shadow Catcher"])
    made = s.render(snapshot)
    caught = made["passes"]["Shadow Catcher"]
    assert caught[:, : SIZE // 2 - 1] == pytest.approx(0.0, abs=1e-6)
    assert caught[:, SIZE // 2 + 1 :] == pytest.approx(2.0, abs=1e-6)
    assert np.all(made["combined"] == 0.0)  # they cut out then


def test_a_channel_without_light_of_the_plate_loses_nothing():
    """Whatever lamps there are besides, as in Cycles."""
    lights = [sun(color=(1.0, 0.0, 0.0)), sun(name="Lamp", energy=1e6, lights_catchers=False)]
    made = s.render(plate(lights, passes=["Combined", "Shadow Catcher"]))
    caught = made["passes"]["Shadow Catcher"][:, SIZE // 2 + 1 :]
    assert np.all(caught[..., 1:] == 1.0) and np.all(caught[..., 0] > 1e5)
    assert np.isfinite(made["combined"]).all()


def before(snapshot, opacity):
    """Something black before all of the frame that lets a part of what is behind through."""
    veil = s.emission(snapshot, (0, 0, 0), opacity)
    s.quad(snapshot, s.rectangle(-99, -99, 99, 99, 1.0), veil)
    # Seen, and nothing else: light goes past it.
    snapshot["instances"]["flags"] = np.append(snapshot["instances"]["flags"], 1)
    return snapshot


@pytest.mark.parametrize("executor", ["SIMD", "REFERENCE"])
def test_the_pass_is_of_the_plate_alone_behind_a_veil(executor):
    snapshot = before(plate(passes=["Combined", "Shadow Catcher"], executor=executor), 0.5)
    made = s.render(snapshot)
    caught = made["passes"]["Shadow Catcher"]
    assert caught[:, : SIZE // 2 - 1] == pytest.approx(0.0, abs=1e-5)
    assert caught[:, SIZE // 2 + 1 :] == pytest.approx(1.0, abs=1e-5)
    assert made["combined"][..., 3] == pytest.approx(0.5, abs=1e-5)


def test_fog_is_composed_in():
    """It takes as much of what shines on the catcher as of what is seen of it."""
    snapshot = plate(passes=["Combined", "Shadow Catcher"])
    fog = filled(snapshot, absorption(np.log(2.0) / 2.0))
    box(snapshot, (-50, -50, 2), (90, 90, 4), fog)
    snapshot["instances"]["flags"] = np.append(snapshot["instances"]["flags"], SEEN)
    made = s.render(snapshot)
    caught = made["passes"]["Shadow Catcher"]
    assert caught[:, : SIZE // 2 - 1] == pytest.approx(0.0, abs=1e-4)
    assert caught[:, SIZE // 2 + 1 :] == pytest.approx(0.5, abs=1e-4)
    assert made["combined"][..., 3] == pytest.approx(0.5, abs=1e-4)


@pytest.mark.parametrize("passes", [["Combined"], ["Combined", "Shadow Catcher"]])
def test_a_session_catches_what_a_frame_does(passes):
    """Lamps that change shade catchers again, at their edges by samples."""
    kept = Kept()
    for energy in (np.pi, 1.0, 9.0):
        snapshot = plate(
            [sun(energy=energy), sun(name="Lamp", lights_catchers=False)], passes=passes
        )
        s.constant_world(snapshot, 0.5)
        assert np.array_equal(kept.picture(snapshot), Kept().picture(snapshot))
    snapshot["lights"][1]["lights_catchers"] = True
    assert np.array_equal(kept.picture(snapshot), Kept().picture(snapshot))


def test_an_output_of_the_material_changes_nothing():
    """Its attributes have other numbers with it: the light of the plate reads the same ones."""
    pictures = []
    for aovs in ([], [{"name": "Place", "kind": "COLOR"}]):
        snapshot = plate(passes=["Combined", "Shadow Catcher"], aovs=aovs, light_samples=16)
        s.constant_world(snapshot, 0.5)
        snapshot["world"]["lights_scene"] = True
        snapshot["materials"][0] = {
            "name": "Grey",
            "surface": (2, "BSDF"),
            "nodes": [
                {"type": "ShaderNodeTexCoord", "inputs": {}},
                {
                    "type": "ShaderNodeOutputAOV",
                    "inputs": {"Color": ("LINK", 0, "UV")},
                    "properties": {"name": "Place"},
                },
                {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": ("LINK", 0, "Generated")}},
            ],
        }
        pictures.append(s.render(snapshot)["passes"]["Shadow Catcher"])
    assert np.array_equal(*pictures)
    assert 0.1 < pictures[0].mean() < 0.9


def test_a_holdout_catches_nothing():
    snapshot = plate()
    snapshot["instances"]["flags"][0] |= 4
    assert np.all(s.render(snapshot)["combined"] == 0.0)


@pytest.mark.parametrize("bounces", [0, 2])
def test_bits_do_not_depend_on_buckets_threads_and_crop(bounces):
    def picture(**options):
        snapshot = plate(passes=["Combined", "Shadow Catcher"], bounces=bounces, **options)
        made = s.render(snapshot)
        return np.concatenate([made["combined"], made["passes"]["Shadow Catcher"]], axis=-1)

    whole = picture()
    for options in ({"bucket_size": 16}, {"threads": 1}):
        assert np.array_equal(whole, picture(**options))
    assert np.array_equal(whole[8:24, 4:20], picture(crop=np.int32([4, 8, 20, 24])))


def test_the_raster_executor_says_that_it_has_none():
    with pytest.raises(Exception, match="catches shadows"):
        s.render(plate(executor="RASTER", sampling="REGULAR"))


def test_a_valley_that_catches_nothing_is_not_there():
    """Its slopes light each other: what grids tell each other would not be what those of the plate know."""
    snapshot = s.orthographic((SIZE, SIZE), samples=16, light_samples=4, bounces=2, grid_size=64)
    s.constant_world(snapshot, 1.0)
    snapshot["options"]["film_transparent"] = True
    snapshot["world"]["lights_scene"] = True
    across = np.linspace(-8, 40, 9)
    points = np.array([(x, y, 40.0 - 1.5 * abs(x - 16)) for x in across for y in across])
    faces = [
        (9 * i + j, 9 * i + j + 1, 9 * i + j + 10, 9 * i + j + 9)
        for i in range(8)
        for j in range(8)
    ]
    s.mesh(snapshot, points, faces, matte(snapshot, (0.8, 0.8, 0.8)))
    snapshot["instances"]["flags"] = [SEEN | CATCHER]
    assert s.render(snapshot)["combined"][..., 3].max() < 1e-4
