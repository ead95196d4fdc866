# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a frame without Blender: how it is cut, what their files hold, what does not fit together."""

import os

import numpy as np
import pytest

from addon.parts import part_file
from addon.parts.coarse_look import coarse, tile_costs
from addon.parts.collected_part import CollectedPart
from addon.parts.frame_cut import FrameCut
from addon.parts.joined_parts import read_parts
from addon.parts.part_file import PartError
from addon.parts.picture_digest import picture_digest
from addon.parts.rectangles import split

CROP = (0, 0, 100, 40)
PASSES = [("Combined", 4), ("Depth", 1)]
ORIGIN = {"frame": 7, "granita": "1", "build": "b", "blender": "3.4", "picture": "p"}


@pytest.mark.parametrize("crop", [(0, 0, 1920, 1080), (33, 7, 200, 401), (5, 5, 6, 6)])
@pytest.mark.parametrize("count", [1, 2, 3, 7, 8, 13, 64, 100])
@pytest.mark.parametrize("by_cost", [False, True])
def test_parts_cover_each_pixel_once(crop, count, by_cost):
    rows, columns = -(-crop[3] // 16) - crop[1] // 16, -(-crop[2] // 16) - crop[0] // 16
    costs = np.random.default_rng(count).random((rows, columns)) ** 8 if by_cost else None
    parts = split(crop, count, 16, costs)
    covered = np.zeros((crop[3], crop[2]), int)
    for rect in filter(None, parts):
        x0, y0, x1, y1 = rect
        assert x0 < x1 and y0 < y1
        assert all(at % 16 == 0 or at in crop for at in rect)
        covered[y0:y1, x0:x1] += 1
    assert len(parts) == count
    wanted = np.zeros_like(covered)
    wanted[crop[1] :, crop[0] :] = 1
    assert np.array_equal(covered, wanted)


def test_parts_are_of_nearly_equal_size():
    sizes = [(x1 - x0) * (y1 - y0) for x0, y0, x1, y1 in split((0, 0, 1920, 1080), 8, 16)]
    assert max(sizes) / min(sizes) < 1.1
    # 6 x 3 tiles: as many parts as there are, and nothing for those beyond.
    assert split((0, 0, 96, 48), 20, 16).count(None) == 2


def test_parts_by_cost_are_of_nearly_equal_cost():
    """A hundredfold in a quarter of the frame: 64 by 64 tiles, whose strips are a fifth of a part at most."""
    costs = np.ones((64, 64))
    costs[:32, 32:] = 100.0
    parts = split((0, 0, 1024, 1024), 8, 16, costs)
    sums = [costs[y0 // 16 : y1 // 16, x0 // 16 : x1 // 16].sum() for x0, y0, x1, y1 in parts]
    assert max(sums) < 1.2 * costs.sum() / 8


def test_a_look_is_a_quarter_of_the_frame():
    whole = {
        "options": {
            "width": 100,
            "height": 70,
            "crop": np.array([33, 0, 100, 70]),
            "samples": 64,
            "dicing_rate": 1.0,
            "passes": ["Combined"],
        },
        "camera": {"scale": (40.0, 44.0), "center": (50.0, 35.0), "clip": (0.1, 9.0)},
    }
    look = coarse(whole, 16)
    options = look["options"]
    assert (options["width"], options["height"], options["samples"]) == (25, 18, 16)
    assert list(options["crop"]) == [8, 0, 25, 18] and "passes" not in options
    assert look["camera"] == {"scale": (10.0, 11.0), "center": (12.5, 8.75), "clip": (0.1, 9.0)}
    assert whole["options"]["width"] == 100


def test_buckets_of_a_look_say_what_tiles_cost():
    """Four tiles along each: one that is half beyond the crop, a whole one, and one of a filter's rim."""
    buckets = [(8, 0, 16, 16, 2.0), (16, 0, 32, 16, 8.0), (16, -2, 32, 0, 1.0)]
    costs = tile_costs(buckets, (33, 0, 100, 40), 16)
    assert costs.shape == (3, 5)  # tiles 2 to 6
    assert np.array_equal(costs[0] / costs[0, 0], [1, 1, 2, 2, 2])


def values(rect, seed):
    x0, y0, x1, y1 = rect
    random = np.random.default_rng(seed)
    return {name: random.random((y1 - y0, x1 - x0, n), np.float32) for name, n in PASSES}


@pytest.fixture
def folder(tmp_path):
    """Three parts of frame 7 as they are rendered; {k: passes} beside them."""
    for k, rect in enumerate(split(CROP, 3, 16), 1):
        save(tmp_path, k, rect)
    return tmp_path


def save(folder, k, rect=None, **changes):
    rect = rect or split(CROP, 3, 16)[k - 1]
    path = folder / part_file.file_name(7, "View/Layer", (k, 3))
    header = {**ORIGIN, "part": [k, 3], "rect": list(rect), "crop": list(CROP)}
    header |= {"written": "2026-01-01T00:00:00.000+00:00"} | changes
    part_file.write(path, header, values(rect, k))
    return path


def joined(folder, **changes):
    asked = {
        "frame": 7,
        "layer": "View/Layer",
        "count": 3,
        "crop": CROP,
        "passes": PASSES,
    } | changes
    return list(read_parts(folder, tile=16, **asked))


def test_values_come_back_as_they_were(folder):
    parts = joined(folder)
    assert [tuple(part.header["rect"]) for part in parts] == split(CROP, 3, 16)
    for k, part in enumerate(parts, 1):
        for name, pixels in values(part.header["rect"], k).items():
            assert np.array_equal(part.passes[name], pixels)


def refused(folder, text, **changes):
    with pytest.raises(PartError) as failure:
        joined(folder, **changes)
    assert text in str(failure.value)


def test_a_missing_part_is_named(folder):
    path = folder / part_file.file_name(7, "View/Layer", (2, 3))
    path.unlink()
    refused(folder, f"a part is missing: there is no file '{path}'")


@pytest.mark.parametrize("spoil", ["cut", "bit", "grown"])
def test_a_damaged_part_is_named(folder, spoil):
    path = folder / part_file.file_name(7, "View/Layer", (2, 3))
    data = bytearray(path.read_bytes())
    if spoil == "cut":
        data = data[: len(data) // 2]
    elif spoil == "bit":
        data[-5] ^= 1
    else:
        data += b"\0"
    path.write_bytes(data)
    refused(folder, f"part file '{path}' is damaged")


@pytest.mark.parametrize("key", ["granita", "build", "blender", "picture"])
def test_an_older_or_foreign_part_is_named(folder, key):
    path = save(folder, 3, **{key: "other", "written": "2025-12-31T00:00:00.000+00:00"})
    refused(folder, f"part file '{path}'")
    refused(folder, "render this part again")
    # It is the latest that was meant: then the others are left over.
    save(folder, 3, **{key: "other", "written": "2026-02-01T00:00:00.000+00:00"})
    refused(folder, "1-of-3.part'")


def test_parts_of_another_size_or_with_other_passes_are_named(folder):
    refused(folder, "another size or border", crop=(0, 0, 96, 40))
    refused(folder, "other passes", passes=[("Combined", 4)])


def test_parts_are_cut_as_the_look_said(folder):
    """By place they were cut otherwise; of another size the cut is refused."""
    about = {**ORIGIN, "layer": "View/Layer"}
    cut = FrameCut(folder, about, CROP, 16)
    costs = np.ones((3, 7))
    costs[:, 0] = 100.0
    cut.write(3, costs)
    refused(folder, "cut in another way")
    rects = split(CROP, 3, 16, costs)
    assert rects != split(CROP, 3, 16)
    for k, rect in enumerate(rects, 1):
        assert cut.part((k, 3), PASSES).rect == rect
        save(folder, k, rect)
    assert [tuple(part.header["rect"]) for part in joined(folder)] == rects
    refused(folder, "look again", crop=(0, 0, 96, 40))


def test_what_is_no_part_file_is_told(folder):
    path = folder / part_file.file_name(7, "View/Layer", (1, 3))
    path.write_text("hello")
    refused(folder, "is not a part file")


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes everywhere")
def test_a_folder_that_cannot_be_written(folder):
    folder.chmod(0o500)
    with pytest.raises(PartError, match="cannot be written"):
        save(folder, 1)


def test_a_path_that_is_a_file_is_named(folder):
    (folder / "file").write_text("")
    with pytest.raises(PartError, match="cannot be written"):
        part_file.write(folder / "file" / "x.part", {}, {})


def test_a_full_disk_leaves_no_file(folder, monkeypatch):
    path = folder / part_file.file_name(7, "View/Layer", (1, 3))
    before = path.read_bytes()

    def full(_descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(PartError, match="No space left"):
        save(folder, 1)
    assert path.read_bytes() == before
    assert not list(folder.glob("*.unfinished"))


def test_a_part_without_all_its_pixels_is_not_written(tmp_path):
    part = CollectedPart(tmp_path / "x.part", (1, 1), CROP, CROP, PASSES, ORIGIN)
    with pytest.raises(PartError, match="pixels are missing"):
        part.write()
    assert not list(tmp_path.iterdir())


def snapshot(**options):
    square = np.arange(12, dtype=np.float32).reshape(1, 4, 3)
    return {
        "options": {"samples": 4, "crop": np.array([0, 0, 8, 8]), "threads": 0, **options},
        "geometries": [{"name": "mesh 'A'", "points": square}],
        "images": [{"name": "I", "path": ""}],
    }


def test_a_picture_is_known_by_what_it_depends_on(tmp_path):
    plain = picture_digest(snapshot())
    free = {"crop": np.array([0, 0, 4, 8]), "threads": 3, "device": "GPU", "bucket_size": 32}
    assert picture_digest(snapshot(**free)) == plain
    assert picture_digest(snapshot(samples=5)) != plain
    moved = snapshot()
    moved["geometries"][0]["points"] = moved["geometries"][0]["points"] + np.float32(1e-6)
    assert picture_digest(moved) != plain
    # A mesh with the same bytes in another shape is another mesh.
    reshaped = snapshot()
    reshaped["geometries"][0]["points"] = reshaped["geometries"][0]["points"].reshape(2, 2, 3)
    assert picture_digest(reshaped) != plain


def test_an_image_counts_by_name_and_size_wherever_it_lies(tmp_path):
    digests = []
    for folder, content in (("a", b"123"), ("b", b"456"), ("c", b"4567")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "wood.png").write_bytes(content)
        scene = snapshot()
        scene["images"][0]["path"] = str(tmp_path / folder / "wood.png")
        digests.append(picture_digest(scene))
    assert digests[0] == digests[1] != digests[2]
