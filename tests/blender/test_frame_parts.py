# SPDX-License-Identifier: GPL-3.0-or-later
"""A frame in parts, joined, is the whole frame: every bit of every pass, AOV and view layer."""

import sys

import bounced_parts
import bpy
import exr
import hair_parts
import numpy as np
import pytest
import render_host
import scene_parts as parts
from test_volumes import filled

PASSES = (
    "z",
    "mist",
    "vector",
    "position",
    "normal",
    "uv",
    "object_index",
    "diffuse_direct",
    "emit",
)


@pytest.fixture
def rich(scene):
    """80 x 56 pixels: lit and glowing squares, one of them moving, passes, an AOV, a second view layer."""
    scene.render.resolution_x, scene.render.resolution_y = 80, 56
    scene.render.use_motion_blur = True
    parts.add_camera(scene, ortho_scale=5.0)
    glow = parts.emission("Glow", (0.25, 0.5, 0.75))
    parts.add_aov_output(glow, "Mask", value=0.5)
    moving = parts.add_square(scene, "Moving", 1.5, (0.0, 0.3, 0.5), glow)
    for frame in (0, 2):
        moving.location.x = frame - 1.0
        moving.keyframe_insert("location", frame=frame)
    parts.add_square(scene, "Matte", 3.0).rotation_euler = (0.3, 0.4, 0.5)
    lamp = bpy.data.lights.new("Lamp", "POINT")
    lamp.energy = 100.0
    parts.add_object(scene, "Lamp", lamp, (1.0, 1.0, 3.0))
    scene.view_layers.new("Second layer/2").samples = 9
    for layer in scene.view_layers:
        for name in PASSES:
            setattr(layer, f"use_pass_{name}", True)
    aov = scene.view_layers[0].aovs.add()
    aov.name, aov.type = "Mask", "VALUE"
    scene.frame_set(1)
    return scene


@pytest.fixture
def unruly(scene):
    """72 x 56 pixels of what reaches over many or stops early: bounces, wax, glass, smoke, hair, a shadow catcher, samples by noise."""
    bounced_parts.room(scene)
    bpy.data.objects["Wall 3"].is_shadow_catcher = True
    bounced_parts.surface(bpy.data.objects["Ball"], "ShaderNodeBsdfGlass", (0.9, 1.0, 0.9))
    wax = parts.add_square(scene, "Wax", 0.6, (-0.5, -0.5, -0.4))
    bounced_parts.surface(wax, "ShaderNodeSubsurfaceScattering", (0.8, 0.5, 0.3), Scale=0.2)
    bpy.ops.mesh.primitive_cube_add(size=0.6, location=(-0.4, 0.2, 0.1))
    filled(bpy.context.object, "ShaderNodeVolumeScatter", Density=2.0)
    hair_parts.furry(scene, hair_length=0.3, root_radius=0.01, tip_radius=0.005).location.z = -0.9
    scene.render.resolution_x, scene.render.resolution_y = 72, 56
    scene.granita.bounces, scene.granita.samples = "FULL", 16
    scene.granita.noise_threshold = 0.05
    return scene


@pytest.fixture
def options(monkeypatch, tmp_path):
    """options("part=1/3", ...): the command line from here on."""

    def set_options(*words):
        words = [f"--granita-{word}" for word in words]
        parts_folder = f"--granita-parts={tmp_path / 'parts'}"
        monkeypatch.setattr(sys, "argv", ["blender", "--", parts_folder, *words])

    return set_options


def assert_equal(joined, whole):
    assert joined.keys() == whole.keys()
    for name, plane in whole.items():
        np.testing.assert_array_equal(joined[name], plane, name)


@pytest.mark.parametrize("count, border", [(1, False), (7, False), (4, True)])
def test_joined_parts_are_the_whole_frame(rich, render, options, tmp_path, count, border):
    render_settings = rich.render
    render_settings.use_border = render_settings.use_crop_to_border = border
    render_settings.border_min_x, render_settings.border_max_y = 0.3, 0.8
    whole = render(rich, "whole")
    assert len(whole) > 40
    for number in range(1, count + 1):
        options(f"part={number}/{count}")
        name = rich.render.filepath = str(tmp_path / "frame.exr")
        bpy.ops.render.render(write_still=True)
        assert rich.render.filepath == name  # put back, and not written to
        assert not (tmp_path / "frame.exr").exists()
    options(f"merge={count}")
    assert_equal(render(rich, "joined"), whole)


@pytest.mark.parametrize("count", [2, 5])
def test_what_reaches_over_many_pixels_is_the_same_in_parts(
    unruly, render, options, tmp_path, count
):
    whole = render(unruly, "whole")
    for number in range(1, count + 1):
        options(f"part={number}/{count}")
        unruly.render.filepath = str(tmp_path / "frame.exr")
        bpy.ops.render.render(write_still=True)
    options(f"merge={count}")
    assert_equal(render(unruly, "joined"), whole)
    assert whole["ViewLayer.Combined.R"].std() > 0.02


def test_parts_of_equal_cost_are_the_whole_frame_too(rich, render, options, tmp_path):
    """What glows costs little, what is lit much; the look itself leaves no picture under the frame's name."""
    whole = render(rich, "whole")
    options("cut=5")
    rich.render.filepath = str(tmp_path / "frame.exr")
    bpy.ops.render.render(write_still=True)
    assert not (tmp_path / "frame.exr").exists()
    cuts = sorted(path.name for path in (tmp_path / "parts").glob("*.part"))
    assert cuts == ["0001.Second%20layer%2f2.0-of-5.part", "0001.ViewLayer.0-of-5.part"]
    for number in range(1, 6):
        options(f"part={number}/5")
        bpy.ops.render.render(write_still=True)
    options("merge=5")
    assert_equal(render(rich, "joined"), whole)


def test_machines_do_their_parts_by_themselves(blend, tmp_path):
    """Each part and the joining in a Blender of its own, found by the output path alone."""
    out = tmp_path / "out"
    whole = render_host.run(blend, tmp_path / "whole")
    for number in (1, 2):
        outcome = render_host.run(blend, out, options=("--granita-part", f"{number}/2"))
        assert outcome.code == 0, outcome.output
        assert [path.name for path in outcome.files] == ["frame.parts"]
    outcome = render_host.run(blend, out, options=("--granita-merge", "2"))
    assert outcome.code == 0, outcome.output
    frame = out / whole.files[0].name
    assert_equal(exr.read(frame), exr.read(whole.files[0]))


def test_a_missing_part_ends_the_frame(rich, options, tmp_path):
    options("merge=2")
    rich.render.filepath = str(tmp_path / "frame.exr")
    with pytest.raises(RuntimeError, match=r"missing: .*0001\.ViewLayer\.1-of-2\.part"):
        bpy.ops.render.render(write_still=True)
    assert list(tmp_path.iterdir()) == []


def test_more_parts_than_tiles(blend, tmp_path):
    """The last ones have nothing to do, and say so in files of their own; float output."""
    outcome = render_host.run(blend, tmp_path / "out", options=("--granita-part", "40/40"))
    assert outcome.code == 0, outcome.output
    assert (tmp_path / "out/frame.parts/0001.ViewLayer.40-of-40.part").stat().st_size < 1000
