# SPDX-License-Identifier: GPL-3.0-or-later
"""A session makes again what an edit changes and nothing else, and the picture is that of a frame alone."""

import copy
import os
import struct
import zlib

import numpy as np
import pytest
import snapshots as s
from session_parts import (
    DOWN,
    Kept,
    bent_card,
    displaced_cube,
    later_frame,
    matte,
    moved_camera,
    moved_card,
    other_color,
    other_lens,
    other_light,
    other_world,
    scene,
    see_through_card,
    shining_cube,
    slightly_other_lens,
    sun,
    unlit_card,
    without_cube,
)

# The edit, and how many geometries' parts and ray shapes are made anew of the three.
EDITS = {
    "nothing": (lambda snapshot: None, 0, 0),
    "samples": (lambda snapshot: snapshot["options"].update(samples=16), 0, 0),
    "lens": (other_lens, 0, 0),
    "light": (other_light, 0, 0),
    "colour": (other_color, 0, 0),
    "place of a polygon": (moved_card, 0, 0),
    "view": (moved_camera, 0, 1),  # the cage: rays meet it as closely as it is seen
    "opacity": (see_through_card, 0, 1),
    "shape": (bent_card, 1, 1),
    "frame time": (later_frame, 3, 3),
    "deletion": (without_cube, 0, 0),
}


# What of the whole picture's work is done again after an edit: buckets hidden, grids diced, shaded.
ALL, FEWER, NONE = "all", "fewer", "none"
STAGES = {
    "nothing": (lambda snapshot: None, NONE, NONE, NONE),
    "filter": (lambda snapshot: snapshot["options"].update(pixel_filter="TENT"), NONE, NONE, NONE),
    "film": (lambda snapshot: snapshot["options"].update(film_transparent=False), NONE, NONE, NONE),
    "light": (other_light, NONE, NONE, ALL),
    "light samples": (lambda s: s["options"].update(light_samples=4), NONE, NONE, ALL),
    "world": (other_world, NONE, NONE, ALL),
    "light linking": (unlit_card, NONE, NONE, ALL),
    "colour": (other_color, NONE, NONE, FEWER),
    "what shines": (shining_cube, NONE, NONE, ALL),
    "lens": (slightly_other_lens, ALL, ALL, NONE),
    "opacity": (see_through_card, ALL, ALL, ALL),
    "place of a polygon": (moved_card, ALL, ALL, ALL),
    "view": (moved_camera, ALL, ALL, ALL),
    "samples": (lambda snapshot: snapshot["options"].update(samples=16), ALL, ALL, ALL),
    "shape": (bent_card, ALL, ALL, ALL),
}


@pytest.mark.parametrize("name", EDITS)
def test_an_edit_makes_again_what_it_changes(name):
    edit, geometries, rays = EDITS[name]
    kept = Kept()
    first = scene()
    kept.follow(first)
    np.testing.assert_array_equal(kept.made(), (3, 3))
    second = copy.deepcopy(first)
    edit(second)
    kept.follow(second)
    np.testing.assert_array_equal(kept.made() - 3, (geometries, rays))


def part(count, whole):
    return NONE if count == 0 else ALL if count == whole else FEWER


@pytest.mark.parametrize("refines", [False, True])
@pytest.mark.parametrize("name", STAGES)
def test_an_edit_costs_the_stages_that_read_it(name, refines):
    edit, *expected = STAGES[name]
    first = scene()
    first["options"]["refine_samples"] = refines
    kept = Kept()
    kept.picture(first)
    second = copy.deepcopy(first)
    edit(second)
    alone = kept.follow(second)
    done, whole = kept.statistics, alone["statistics"]
    buckets = whole["buckets_moving"]  # a lens is there
    found = [
        part(buckets - done["buckets_seen_before"], buckets),
        part(done["grids_diced"], whole["grids_diced"]),
        part(done["grids_shaded"], whole["grids_shaded"]),
    ]
    assert found == expected
    assert job_warnings(kept, second) == alone["warnings"]


@pytest.mark.parametrize("edit", [slightly_other_lens, other_lens])
def test_bounced_light_is_that_of_the_lens(edit):
    """What the card and the cube hide of the floor depends on it: its points get other numbers of ways."""
    first = scene()
    first["options"].update(bounces=2, dicing_rate=2.0)
    first["camera"].update(lens_radius=0.3)
    kept = Kept()
    kept.picture(first)
    second = copy.deepcopy(first)
    edit(second)
    kept.follow(second)


@pytest.mark.parametrize("name", ["nothing", "filter", "film"])
def test_bounced_light_stays_where_nothing_of_it_is_other(name):
    """Of a coarse picture that shows a pass, too: one light sample, none shaded by itself."""
    first = scene()
    first["options"].update(bounces=2, light_samples=1, refine_samples=False, passes=["Normal"])
    kept = Kept()
    kept.picture(first)
    second = copy.deepcopy(first)
    STAGES[name][0](second)
    kept.follow(second)
    assert kept.statistics["grids_shaded"] == 0


@pytest.mark.parametrize("transparent", [False, True])
def test_another_pass_costs_shading_at_most(transparent):
    """What is transparent is seen anew, as passes may look behind the end of its colour."""
    snapshot = scene()
    snapshot["options"].update(refine_samples=False, pass_alpha_threshold=0.5)
    if transparent:
        see_through_card(snapshot)
    kept, shaded, hidden = Kept(), [], []
    for shown in (None, "Normal", None, "Normal", "Mist", None, "Normal"):
        snapshot["options"]["passes"] = [shown] if shown else []
        alone = s.render(snapshot)
        expected = alone["passes"][shown] if shown else alone["combined"]
        np.testing.assert_array_equal(kept.picture(snapshot, shown), expected)
        done, whole = kept.statistics, alone["statistics"]
        buckets = whole["buckets_moving"]
        shaded.append(part(done["grids_shaded"], whole["grids_shaded"]))
        hidden.append(part(buckets - done["buckets_seen_before"], buckets))
    if transparent:
        assert hidden == 7 * [ALL]
    else:
        assert hidden == [ALL] + 6 * [NONE]
        assert shaded == [ALL, ALL, NONE, NONE, ALL, NONE, ALL]


def test_a_pass_holds_after_an_edit_that_was_made_without_it():
    kept, snapshot = Kept(), scene()
    for edit, shown in ((None, "Normal"), (other_color, None), (None, "Normal")):
        snapshot["options"]["passes"] = [shown] if shown else []
        if edit:
            edit(snapshot)
        picture = kept.picture(snapshot, shown)
    np.testing.assert_array_equal(picture, s.render(snapshot)["passes"]["Normal"])
    assert 0 < kept.statistics["grids_shaded"] < s.render(snapshot)["statistics"]["grids_shaded"]


# Buckets hidden, grids shaded, shapes for rays made.
DISPLACED_STAGES = {
    "nothing": (lambda snapshot: None, NONE, NONE, 0),
    "light": (other_light, NONE, ALL, 0),
    "colour of the floor": (other_color, NONE, FEWER, 0),
    "lens": (slightly_other_lens, ALL, NONE, 0),
    "height": (lambda snapshot: displaced_cube(snapshot, 0.2), ALL, ALL, 1),
    "colour": (lambda snapshot: displaced_cube(snapshot, color=(1, 0, 0)), ALL, ALL, 1),
    "view": (moved_camera, ALL, ALL, 1),
    "place of a polygon": (moved_card, ALL, ALL, 1),
}


@pytest.mark.parametrize("name", DISPLACED_STAGES)
def test_what_is_displaced_is_moved_again_where_its_offsets_may_be_others(name):
    edit, *expected = DISPLACED_STAGES[name]
    first, kept = scene(), Kept()
    displaced_cube(first)
    first["options"]["refine_samples"] = False
    kept.picture(first)
    made = kept.session.ray_shapes_made
    second = copy.deepcopy(first)
    edit(second)
    alone = kept.follow(second)
    done, whole = kept.statistics, alone["statistics"]
    buckets = whole["buckets_moving"]
    found = [
        part(buckets - done["buckets_seen_before"], buckets),
        part(done["grids_shaded"], whole["grids_shaded"]),
        kept.session.ray_shapes_made - made,
    ]
    assert found == expected


def test_displaced_faces_of_a_few_pixels_are_shaded_by_later_pictures():
    # What the first picture has hidden, and only tells others, is what the later ones' displacement is asked for no more.
    first, kept = scene(), Kept()
    displaced_cube(first)
    x, y = np.meshgrid(np.linspace(-2, 2, 31), np.linspace(-2, 2, 31))
    corner = np.arange(30 * 31).reshape(30, 31)[:, :-1].ravel()
    faces = np.stack([corner, corner + 31, corner + 32, corner + 1], 1).tolist()
    for z in (6.0, 6.5):
        s.mesh(first, np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], 1), faces, 2)
    first["options"].update(bounces=2, dicing_rate=0.5)
    kept.follow(first)
    for edit in (other_light, other_color, other_world):
        later = copy.deepcopy(first)
        edit(later)
        kept.follow(later)
        kept.follow(first)


def test_a_material_that_comes_to_hold_out_is_hidden_anew():
    first, second = scene(), scene()
    second["materials"][1]["holdout"] = True
    kept = Kept()
    before, after = kept.picture(first), kept.picture(second)
    assert np.array_equal(after, Kept().picture(second))
    assert (after[..., 3] < before[..., 3]).any()


def test_what_comes_to_be_lit_is_diced_anew():
    """Grids of a picture that nothing lights do not know how far their smooth faces rise."""
    snapshot = s.perspective((48, 32), 60.0, executor="SIMD", samples=4)
    turns = np.arange(8) * np.pi / 4
    corners = [(0.7 * np.sin(t), y, 6 - 0.7 * np.cos(t)) for y in (-1, 1) for t in turns]
    faces = [(i, (i + 1) % 8, 8 + (i + 1) % 8, 8 + i) for i in range(8)]
    s.mesh(snapshot, corners, faces, s.emission(snapshot), smooth=np.ones(8, np.uint8))
    sun(snapshot)
    kept = Kept()
    kept.follow(snapshot)
    lit = copy.deepcopy(snapshot)
    lit["materials"] = [lit["materials"][matte(lit, (0.8, 0.8, 0.8))]]
    kept.follow(lit)
    assert kept.statistics["grids_diced"] > 0
    lit["lights"][0]["energy"] = 2.0
    kept.follow(lit)
    assert kept.statistics["grids_diced"] == 0


def unseen_by_shadows(snapshot):
    snapshot["instances"]["flags"] = [59, 57, 59]


def lets_shadow_rays_through(snapshot):
    nodes = snapshot["materials"][1]["nodes"]
    nodes.append({"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1, 1, 1, 1)}})
    nodes.append({"type": "ShaderNodeLightPath", "inputs": {}})
    links = {"Fac": (2, "Is Shadow Ray"), "Shader": (0, "BSDF"), "Shader_001": (1, "BSDF")}
    mixed = {name: ("LINK", *link) for name, link in links.items()}
    nodes.append({"type": "ShaderNodeMixShader", "inputs": mixed})
    snapshot["materials"][1]["surface"] = (3, "Shader")


@pytest.mark.parametrize(
    "edit",
    [
        unseen_by_shadows,
        lets_shadow_rays_through,
        lambda snapshot: snapshot["options"].update(light_samples=5),
    ],
    ids=["who casts shadows", "what shadow rays pass", "light samples"],
)
def test_opacity_that_asks_rays_follows_what_they_meet(edit):
    """The floor is as thin as things are near it."""
    first = scene()
    first["instances"]["flags"] = [59, 59, 59]
    nodes = first["materials"][0]["nodes"]
    nodes.append({"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1, 1, 1, 1)}})
    nodes.append({"type": "ShaderNodeAmbientOcclusion", "inputs": {"Distance": 5.0}})
    links = {"Fac": (2, "AO"), "Shader": (1, "BSDF"), "Shader_001": (0, "BSDF")}
    mixed = {name: ("LINK", *link) for name, link in links.items()}
    nodes.append({"type": "ShaderNodeMixShader", "inputs": mixed})
    first["materials"][0]["surface"] = (3, "Shader")
    kept = Kept()
    before = kept.picture(first)
    second = copy.deepcopy(first)
    edit(second)
    alone = kept.follow(second)
    assert (alone["combined"][..., 3] != before[..., 3]).any()


def test_what_there_is_to_say_of_displacement_is_said_of_each_picture():
    snapshot, kept = scene(), Kept()
    displaced_cube(snapshot)
    infinite = {
        "type": "ShaderNodeMath",
        "inputs": {"Value": 1e30, "Value_001": 1e30},
        "properties": {"operation": "MULTIPLY"},
    }
    nodes = snapshot["materials"][2]["nodes"]
    nodes[1] = infinite
    nodes[2]["inputs"]["Height"] = ("LINK", 1, "Value")
    alone = s.render(snapshot)["warnings"]
    assert any("displacement is no number" in str(warning) for warning in alone)
    for _ in range(3):
        assert job_warnings(kept, snapshot) == alone


def job_warnings(kept, snapshot):
    job = kept.core.Render(kept.core.Scene(s.packed(snapshot), kept.session))
    job.finish()
    return job.warnings()


def test_pictures_of_two_sizes_are_kept_side_by_side():
    coarse, whole = scene(), scene()
    coarse["options"]["samples"] = 1
    kept = Kept()
    for snapshot in (coarse, whole):
        kept.picture(snapshot)
    for snapshot in (coarse, whole):
        other_light(snapshot)
        kept.follow(snapshot)
        assert kept.statistics["grids_diced"] == 0


def test_edits_in_any_order_leave_no_trace():
    """Each picture is that of a frame alone, whatever was kept before it."""
    edits = [other_light, other_color, slightly_other_lens, moved_camera, other_world, other_lens]
    edits += [see_through_card, moved_card, bent_card]
    random = np.random.default_rng(3)
    kept = Kept()
    snapshot = scene()
    for k in random.permutation(2 * len(edits)) % len(edits):
        edits[k](snapshot)
        kept.follow(snapshot)


def write_pixel(path, color, time):
    """A PNG of one pixel of 8 bits, written at `time`, seconds."""

    def chunk(kind, data):
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0))
    pixels = chunk(b"IDAT", zlib.compress(b"\0" + bytes(color)))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + header + pixels + chunk(b"IEND", b""))
    os.utime(path, (time, time))


@pytest.mark.parametrize("edit", [None, slightly_other_lens])
def test_an_image_file_that_is_written_anew_is_read_anew(tmp_path, edit):
    snapshot = scene()
    file = tmp_path / "image.png"
    snapshot["images"] = [{"name": "Image", "path": str(file), "colorspace": "sRGB"}]
    image = {"type": "ShaderNodeTexImage", "properties": {"image": "Image"}, "inputs": {}}
    nodes = [image, *snapshot["materials"][0]["nodes"]]
    nodes[1]["inputs"]["Color"] = ("LINK", 0, "Color")
    snapshot["materials"][0].update(nodes=nodes, surface=(1, "BSDF"))
    kept = Kept()
    write_pixel(file, (255, 0, 0), 1000)
    red = kept.picture(snapshot)
    write_pixel(file, (0, 0, 255), 2000)
    if edit:
        edit(snapshot)
    blue = kept.picture(snapshot)
    assert np.abs(blue - red).max() > 0.1
    np.testing.assert_array_equal(blue, s.render(snapshot)["combined"])


def test_another_image_of_the_world_lights_what_has_no_material(tmp_path):
    snapshot = s.perspective((16, 16), 60.0, executor="SIMD", samples=4)
    s.quad(snapshot, s.rectangle(-1, -1, 1, 1, 6.0), -1)
    image = {"type": "ShaderNodeTexEnvironment", "properties": {"image": "Sky"}, "inputs": {}}
    background = {"type": "ShaderNodeBackground", "inputs": {"Color": ("LINK", 0, "Color")}}
    sky = {"name": "World", "nodes": [image, background], "surface": (1, "Background")}
    snapshot["world"] = sky
    kept, seen = Kept(), []
    for color in ((255, 0, 0), (0, 0, 255)):
        file = tmp_path / f"{color[0]}.png"
        write_pixel(file, color, 1000)
        snapshot["images"] = [{"name": "Sky", "path": str(file), "colorspace": "sRGB"}]
        seen.append(kept.picture(snapshot))
    assert np.abs(seen[1] - seen[0])[8, 8].max() > 0.1
    np.testing.assert_array_equal(seen[1], s.render(snapshot)["combined"])


def test_what_is_not_there_any_more_is_forgotten():
    kept = Kept()
    first, second = scene(), scene()
    kept.picture(first)
    without_cube(second)
    kept.picture(second)
    kept.picture(first)
    np.testing.assert_array_equal(kept.made(), (4, 4))


def test_an_orbit_around_a_cage_keeps_no_shape_of_each_place():
    """Rays meet a cage as closely as it is seen: otherwise from each place."""
    kept = Kept()
    snapshot = scene()
    snapshot["options"]["dicing_rate"] = 0.5
    taken = []
    for k in range(12):
        snapshot["camera"]["world_from_camera"] = s.translation(0.05 * k)[None]
        kept.picture(snapshot)
        taken.append(kept.statistics["peak_ray_bytes"])
    assert kept.session.ray_shapes_made >= 14
    # Two of those before, and the one that is made.
    assert taken[-1] < 1.2 * max(taken[:3])


def test_another_geometry_offset_ends_light_elsewhere():
    """Of a coarse smooth ball: where rays start is known to its grids."""
    kept, snapshot = Kept(), s.perspective((24, 24), 60.0, executor="SIMD", samples=4)
    corners = [(x, y, 5 + z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    s.mesh(snapshot, corners, faces, matte(snapshot, (1, 1, 1)), smooth=np.ones(6, np.uint8))
    sine, cosine = np.sin(4.5), np.cos(4.5)  # it grazes
    turn = np.array([[cosine, 0, sine, 0], [0, 1, 0, 0], [-sine, 0, cosine, 0], [0, 0, 0, 1]])
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": (turn @ DOWN)[None], "energy": 3.0}
    ]
    seen = []
    for offset in (0, 60000):
        snapshot["instances"]["flags"] = [59 | offset << 16]
        seen.append(kept.picture(snapshot))
    assert np.abs(seen[1] - seen[0]).max() > 0.01
    np.testing.assert_array_equal(seen[1], s.render(snapshot)["combined"])


def test_equal_geometries_of_one_name_are_each_adopted():
    snapshot = scene()
    snapshot["geometries"][1] = dict(snapshot["geometries"][0])
    kept = Kept()
    kept.picture(snapshot)
    kept.follow(snapshot)
    assert kept.session.geometries_adopted == 3
    np.testing.assert_array_equal(kept.made(), (3, 3))


def test_a_job_that_is_cancelled_leaves_a_session_whole():
    kept = Kept()
    snapshot = scene()
    snapshot["options"]["samples"] = 256
    kept.picture(snapshot)
    for k in range(5):
        snapshot["lights"][0]["energy"] = 4.0 + k
        job = kept.core.Render(kept.core.Scene(s.packed(snapshot), kept.session))
        job.take_tiles(0.002 * k)
        job.cancel()
    kept.follow(snapshot)


def test_warnings_are_those_of_a_frame_alone():
    snapshot = scene()
    broken = snapshot["geometries"][0]["points"].copy()
    broken[0, 0, 0] = np.nan
    snapshot["geometries"][0]["points"] = broken
    alone = s.render(snapshot)["warnings"]
    assert alone
    kept = Kept()
    for _ in range(2):
        job = kept.core.Render(kept.core.Scene(s.packed(snapshot), kept.session))
        job.finish()
        assert job.warnings() == alone
