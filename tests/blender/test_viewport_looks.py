# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D view alone shows or leaves out, beside F12's frames of the same."""

import struct
import zlib

import bpy
import numpy as np
import pytest
import scene_parts as parts
import view_parts
import view_scenes


@pytest.fixture
def view(scene):
    view_scenes.bounced(scene)
    scene.render.resolution_x, scene.render.resolution_y = 48, 32
    scene.granita.bounces = "FAST"
    made = view_parts.View((48, 32))
    yield made.look_through_camera()
    made.close()


def final(planes, name="Combined", channels="RGBA"):
    return np.stack([planes[f"ViewLayer.{name}.{c}"] for c in channels], axis=-1)


# The setting, the property that asks F12 for it, its name and channels before Blender 5 and since.
PASSES = {
    "NORMAL": ("normal", ("Normal", "Normal"), "XYZ"),
    "DIFFUSE_DIRECT": ("diffuse_direct", ("DiffDir", "Diffuse Direct"), "RGB"),
    "GLOSSY_INDIRECT": ("glossy_indirect", ("GlossInd", "Glossy Indirect"), "RGB"),
    "ENVIRONMENT": ("environment", ("Env", "Environment"), "RGB"),
    "MIST": ("mist", ("Mist", "Mist"), "Z"),
    "OBJECT_INDEX": ("object_index", ("IndexOB", "Object Index"), "X"),
}


@pytest.mark.parametrize("name", PASSES)
def test_a_view_shows_a_pass_as_the_final_frame_has_it(scene, view, render, name):
    wanted, names, channels = PASSES[name]
    bpy.data.objects["Thing"].pass_index = 3
    bpy.data.objects.remove(bpy.data.objects["Wall"])
    if hasattr(scene, "cycles"):
        scene.cycles.film_exposure = 0.5
    combined = view.edited().settle().copy()
    view.space.shading.granita.render_pass = name
    seen = view.drawn().settle().copy()
    setattr(bpy.context.view_layer, f"use_pass_{wanted}", True)
    planes = final(render(scene), names[bpy.app.version >= (5, 0, 0)], channels)
    assert np.ptp(planes) > 0.01
    np.testing.assert_array_equal(seen[..., :3], np.broadcast_to(planes, (32, 48, 3)))
    assert (seen[..., 3] == 1.0).all()
    view.space.shading.granita.render_pass = "COMBINED"
    np.testing.assert_array_equal(view.drawn().settle(), combined)


@pytest.mark.parametrize("kind", ["VALUE", "COLOR"])
def test_a_view_shows_an_output_of_materials_as_the_final_frame_has_it(scene, view, render, kind):
    """Its name is that of a pass of light, which the film's exposure would multiply."""
    layer = bpy.context.view_layer
    made = layer.aovs.add()
    made.name, made.type = "Emission", kind
    material = bpy.data.objects["Thing"].data.materials[0]
    parts.add_aov_output(material, "Emission", (0.25, 0.5, 0.75), 0.625)
    if hasattr(scene, "cycles"):
        scene.cycles.film_exposure = 0.5
    shading = view.space.shading.granita
    shading.render_pass, shading.aov_name = "AOV", "Emission"
    seen = view.edited().settle().copy()
    channels = "X" if kind == "VALUE" else "RGB"
    planes = final(render(scene), "Emission", channels)
    assert planes.max() == pytest.approx(0.625 if kind == "VALUE" else 0.75)
    np.testing.assert_array_equal(seen[..., :3], np.broadcast_to(planes, (32, 48, 3)))
    shading.aov_name = "Gone"
    shown = view.drawn().settle().copy()
    shading.render_pass = "COMBINED"
    np.testing.assert_array_equal(view.drawn().settle(), shown)


def test_a_view_names_what_is_dear_in_it(scene, view):
    view.edited().settle()
    costs = view.live.costs
    names = [name for name, _, _ in costs.objects]
    assert set(names) <= {thing.name for thing in scene.objects if thing.type == "MESH"}
    assert "Thing" in names
    seconds = [taken for _, taken, _ in costs.objects]
    assert seconds == sorted(seconds, reverse=True)
    done = costs.statistics
    assert 0 < sum(count for _, _, count in costs.objects)
    assert len(costs.object_lines()) == len(names) and done["grids_diced"] > 0


def test_one_time_of_the_shutter_is_sharp_and_where_things_are_then(scene, view, render):
    """The keys are linear: through the shutter from frame 2 to 4, time .25 is frame 2.5."""
    for thing in (bpy.data.objects["Thing"], scene.camera):
        parts.make_linear(thing)
    scene.camera.data.dof.use_dof = False
    scene.render.motion_blur_shutter = 2.0
    blurred = view.edited().settle().copy()
    view.space.shading.granita.use_time = True
    view.space.shading.granita.time = 0.25
    read = view.live.counts["shutters read"]
    seen = view.drawn().settle().copy()
    assert view.live.counts["shutters read"] == read
    assert np.abs(seen - blurred).max() > 0.1
    scene.render.use_motion_blur = False
    scene.frame_set(2, subframe=0.5)
    there = final(render(scene))
    # Places are interpolated in another order: a few edges and reflections fall on other samples.
    assert np.median(np.abs(seen - there)) < 1e-3
    assert np.abs(seen - there).mean() < 0.2 * np.abs(seen - blurred).mean()


def test_what_a_view_hides_is_neither_seen_nor_shines_nor_shadows(scene, view, render, monkeypatch):
    """Local view, say: which things are hidden only a window's space can tell."""
    import sys

    sight = sys.modules["granita.viewport.sight"]
    everything = view.edited().settle().copy()

    def seen_without(*names):
        hidden = frozenset(bpy.data.objects[name].as_pointer() for name in names)
        monkeypatch.setattr(sight, "_hidden", lambda _space, _depsgraph: hidden)
        return view.drawn().settle().copy()

    seen = seen_without("Lamp", "Thing")
    assert np.abs(seen - everything).max() > 0.1
    for name in ("Lamp", "Thing"):
        bpy.data.objects[name].hide_render = True
    np.testing.assert_array_equal(seen, final(render(scene)))
    np.testing.assert_array_equal(seen_without(), everything)


def _write_png(path, color):
    """One pixel of 8 bits."""

    def chunk(kind, data):
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    header = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)
    pixels = zlib.compress(b"\0" + bytes(color))
    chunks = chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunks)


def test_an_image_that_is_written_anew_is_shown_anew(scene, view, render, tmp_path):
    file = tmp_path / "image.png"
    _write_png(file, (200, 30, 30))
    material, nodes, links, output = parts.node_material("Painted")
    shader, image = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeTexImage")
    image.image = bpy.data.images.load(str(file))
    links.new(image.outputs["Color"], shader.inputs["Color"])
    links.new(shader.outputs[0], output.inputs["Surface"])
    bpy.data.objects["Thing"].material_slots[0].material = material
    red = view.edited().settle().copy()
    _write_png(file, (30, 30, 220))
    image.image.reload()
    blue = view.edited().settle().copy()
    assert np.abs(blue - red).max() > 0.05
    np.testing.assert_array_equal(blue, final(render(scene)))
