# SPDX-License-Identifier: GPL-3.0-or-later
"""What a farm sees when something is wrong: exit code 1, the cause by name and no file; or, where the
frame survives, exit code 0, a file and a warning by name.  Output is float, which Blender crashes
on when an engine leaves without pixels.
"""

import os
import re
import shutil
from dataclasses import dataclass, field

import bpy
import exr
import numpy as np
import pytest
import render_host
import scene_parts as parts

# Runs in the rendering Blender; replaces the export by one that spoils its result.
SPOIL = """
import granita.final_render as final_render
export = final_render.export_frame
def spoiled(*arguments):
    snapshot = export(*arguments)
    {}
    return snapshot
final_render.export_frame = spoiled
"""

IMAGE = """
import bpy
image = bpy.data.images.load({path!r}) if {exists} else bpy.data.images.new("{name}", 4, 4)
image.name = "{name}"
image.source = "FILE"
image.filepath = {path!r}
tree = bpy.data.materials["Glow"].node_tree
node = tree.nodes.new("ShaderNodeTexImage")
node.image = image
emission = next(n for n in tree.nodes if n.type == "EMISSION")
tree.links.new(node.outputs["Color"], emission.inputs["Color"])
"""

UNKNOWN_NODE = """
import bpy
tree = bpy.data.materials["Glow"].node_tree
node = tree.nodes.new("ShaderNodeEeveeSpecular")
node.name = "Whisker"
output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
tree.links.new(node.outputs[0], output.inputs["Surface"])
"""

# As a file has it whose add-on is gone: its link counts as none, as in Cycles.
UNDEFINED_NODE = """
import bpy
class Lost(getattr(bpy.types, "ShaderNode", bpy.types.Node)):
    bl_idname, bl_label = "LostNode", "Lost"
    def init(self, context):
        self.outputs.new("NodeSocketColor", "Color")
bpy.utils.register_class(Lost)
lamp = bpy.data.lights.new("Sun", "SUN")
bpy.context.collection.objects.link(bpy.data.objects.new("Sun", lamp))
lamp.use_nodes = True
for tree in (bpy.data.materials["Glow"].node_tree, lamp.node_tree):
    node = tree.nodes.new("LostNode")
    node.name = "Whisker"
    emission = next(n for n in tree.nodes if n.type == "EMISSION")
    tree.links.new(node.outputs[0], emission.inputs["Color"])
bpy.utils.unregister_class(Lost)
"""

# EEVEE's alone.
EEVEE_NODE = """
import bpy
tree = bpy.data.materials["Glow"].node_tree
node = tree.nodes.new("ShaderNodeShaderToRGB")
node.name = "Whisker"
shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
emission = next(n for n in tree.nodes if n.type == "EMISSION")
tree.links.new(shader.outputs[0], node.inputs[0])
tree.links.new(node.outputs[0], emission.inputs["Color"])
"""

# Muted nodes let through what they are fed with, whether Cycles has them or not.
MUTED_NODE = """
import bpy
tree = bpy.data.materials["Glow"].node_tree
emission = next(n for n in tree.nodes if n.type == "EMISSION")
node, number = tree.nodes.new("ShaderNodeSqueeze"), tree.nodes.new("ShaderNodeValue")
number.outputs[0].default_value = emission.inputs["Strength"].default_value
node.mute = True
tree.links.new(number.outputs[0], node.inputs[0])
tree.links.new(node.outputs[0], emission.inputs["Strength"])
emission.inputs["Strength"].default_value = 7.0
"""

# A lamp that EEVEE's node feeds shines no more than one that nothing does.
EEVEE_LAMP = """
import bpy
lamp = bpy.data.lights.new("Sun", "SUN")
bpy.context.collection.objects.link(bpy.data.objects.new("Sun", lamp))
lamp.use_nodes = True
tree = lamp.node_tree
node = tree.nodes.new("ShaderNodeShaderToRGB")
node.name = "Whisker"
output = next(n for n in tree.nodes if n.type == "OUTPUT_LIGHT")
tree.links.new(node.outputs[0], output.inputs["Surface"])
"""

BROKEN_LAMP = """
import bpy
lamp = bpy.data.lights.new("Lamp", "POINT")
lamp.energy = float("{}")
bpy.context.collection.objects.link(bpy.data.objects.new("Faulty", lamp))
"""

# Objects with names that would colour a terminal, end a line and turn it round.
RED_NAMES = """
import bpy
lamp = bpy.data.lights.new("Lamp", "POINT")
lamp.energy = float("nan")
bpy.context.collection.objects.link(bpy.data.objects.new("\\x1b[31mRed\\n\\u202eturned", lamp))
"""

HANDLER = """
import bpy
def broken(*_):
    raise KeyError("handler")
bpy.app.handlers.frame_change_post.append(broken)
"""

SETTING = "import bpy; s = bpy.context.scene; r = s.render; {}"


@dataclass
class Case:
    code: int
    says: str
    prepare: str = ""
    options: tuple = ()
    env: dict = field(default_factory=dict)
    modules: str = ""  # a folder of `folder`, in place of the native module


CASES = {
    # The frame fails.
    "no camera": Case(1, "camera", SETTING.format("s.camera = None")),
    "panoramic camera": Case(1, "camera 'Camera'", SETTING.format("s.camera.data.type = 'PANO'")),
    "stereoscopy": Case(1, "stereoscopy", SETTING.format("r.use_multiview = True")),
    "native module missing": Case(1, "native module granita_core is not installed", modules="none"),
    "native module of another Python": Case(1, "is not for Python 3.", modules="foreign"),
    "native module broken": Case(1, "granita_core cannot be loaded", modules="broken"),
    "wrong shape in the snapshot": Case(
        1,
        "Square",
        SPOIL.format(
            "snapshot['geometries'][0]['points'] = snapshot['geometries'][0]['points'][0]"
        ),
    ),
    "wrong index in the snapshot": Case(
        1, "Square", SPOIL.format("snapshot['geometries'][0]['corner_verts'][0] = 99")
    ),
    "missing key in the snapshot": Case(
        1, "world_from_camera", SPOIL.format("del snapshot['camera']['world_from_camera']")
    ),
    "fault in the export": Case(1, "KeyError: 'boom'", SPOIL.format("raise KeyError('boom')")),
    "statistics in no folder": Case(
        1, "'/nowhere/s.json' cannot be written", options=("--granita-stats", "/nowhere/s.json")
    ),
    "statistics on a full disk": Case(
        1, "'/dev/full' cannot be written", options=("--granita-stats", "/dev/full")
    ),
    "less memory than Blender itself takes": Case(
        1, "wants more memory than 1 MiB, its limit", options=("--granita-memory", "1")
    ),
    "unknown option": Case(
        1, "unknown option --granita-devcie", options=("--granita-devcie", "cpu")
    ),
    "unknown device": Case(1, "'tpu' is not one of", options=("--granita-device", "tpu")),
    "threads not a number": Case(1, "'-3' is not a number", options=("--granita-threads=-3",)),
    "option without a value": Case(1, "needs a value", options=("--granita-stats",)),
    # The frame survives.
    "no graphics card": Case(
        0,
        "the GPU was asked for, the CPU renders",
        SETTING.format("s.granita.sampling = 'REGULAR'"),
        options=("--granita-device", "gpu"),
        env={"__EGL_VENDOR_LIBRARY_DIRS": "/nowhere", "DISPLAY": ""},
    ),
    "fault in a handler": Case(0, "KeyError: 'handler'", HANDLER),
    "image missing": Case(
        0, "Lost", IMAGE.format(path="{folder}/lost.png", exists=False, name="Lost")
    ),
    "image truncated": Case(
        0, "Torn", IMAGE.format(path="{folder}/torn.png", exists=True, name="Torn")
    ),
    "unknown node": Case(0, "Glow", UNKNOWN_NODE),
    "undefined node": Case(0, "material 'Glow', light 'Sun': node 'Whisker' is of", UNDEFINED_NODE),
    "node of EEVEE": Case(0, "material 'Glow': node 'Whisker' is unknown to Cycles", EEVEE_NODE),
    "lamp of a node of EEVEE": Case(
        0, "light 'Sun': node 'Whisker' is unknown to Cycles", EEVEE_LAMP
    ),
    "energy not a number": Case(0, "light 'Faulty': is left out", BROKEN_LAMP.format("nan")),
    "energy infinite": Case(0, "light 'Faulty': is left out", BROKEN_LAMP.format("inf")),
    "control characters in a name": Case(
        0, r"light '\x1b[31mRed\n\u202eturned': is left out", RED_NAMES
    ),
    "control characters in a failure": Case(
        1,
        r"camera '\x1b[31m'",
        SETTING.format("s.camera.name = '\\x1b[31m'; s.camera.data.type = 'PANO'"),
    ),
    "one pixel": Case(
        0,
        "Saved",
        SETTING.format("r.resolution_x = r.resolution_y = 4; r.resolution_percentage = 25"),
    ),
}


@pytest.fixture
def folder(tmp_path):
    """Native modules that cannot be loaded, and half a picture."""
    (tmp_path / "none").mkdir()
    for name, file in (
        ("foreign", "granita_core.cpython-399-x86_64-linux-gnu.so"),
        ("broken", "granita_core.so"),
    ):
        (tmp_path / name).mkdir()
        (tmp_path / name / file).write_bytes(b"not a library")
    image = bpy.data.images.new("whole", 64, 64)
    image.pixels.foreach_set(np.random.default_rng(1).random(64 * 64 * 4, np.float32))
    image.filepath_raw = str(tmp_path / "torn.png")
    image.file_format = "PNG"
    image.save()
    whole = (tmp_path / "torn.png").read_bytes()
    (tmp_path / "torn.png").write_bytes(whole[: len(whole) // 3])
    return tmp_path


def with_modules(folder, modules):
    """The environment of a Blender that finds those native modules alone: on Python's path, or in a copy
    of an installed add-on, which looks at its own first."""
    if "GRANITA_ADDON" not in os.environ:
        return {"PYTHONPATH": str(modules)}
    addon = folder / "scripts/addons/granita"
    own = shutil.ignore_patterns("granita_core*", "__pycache__")
    shutil.copytree(os.environ["GRANITA_ADDON"], addon, ignore=own)
    shutil.copytree(modules, addon, dirs_exist_ok=True)
    return {"BLENDER_USER_SCRIPTS": str(folder / "scripts"), "PYTHONPATH": ""}


@pytest.mark.parametrize("name", CASES)
def test_exit_code_and_message(name, blend, folder):
    case = CASES[name]

    def filled(text):
        return text.replace("{folder}", str(folder))

    outcome = render_host.run(
        blend,
        folder / "out",
        filled(case.prepare),
        options=case.options,
        env=case.env | (with_modules(folder, folder / case.modules) if case.modules else {}),
    )
    assert outcome.code == case.code, outcome.output
    assert case.says in outcome.output
    assert len(outcome.files) == (case.code == 0), outcome.output
    assert ("Error: " in outcome.output) == (case.code == 1 or "handler" in name), outcome.output
    assert "\x1b" not in outcome.output and "\u202e" not in outcome.output
    for path in outcome.files:
        exr.read(path)


@pytest.mark.parametrize(
    "prepare", [UNDEFINED_NODE, EEVEE_NODE, MUTED_NODE, BROKEN_LAMP.format("nan")]
)
def test_what_is_left_out_leaves_the_rest(prepare, blend, tmp_path):
    """The square's own colour, and no light from the lamp: as if neither were there."""
    outcome = render_host.run(blend, tmp_path / "out", prepare)
    expected = render_host.run(blend, tmp_path / "expected")
    for name, plane in exr.read(expected.files[0]).items():
        np.testing.assert_array_equal(exr.read(outcome.files[0])[name], plane)


@pytest.mark.parametrize("border", [(0.5, 0.5), (7, 9), (0.8, 0.2)], ids=str)
def test_border_without_pixels(blend, tmp_path, border):
    """Blender refuses it before any engine is asked; its exit code is its own."""
    prepare = SETTING.format(f"r.use_border = True; r.border_min_x, r.border_max_x = {border}")
    outcome = render_host.run(blend, tmp_path / "out", prepare)
    assert "Error: Image too small" in outcome.output
    assert outcome.files == []


def test_a_good_frame_says_nothing_alarming(blend, tmp_path):
    """Farms take these words anywhere in the output for a failure."""
    outcome = render_host.run(blend, tmp_path / "out")
    assert outcome.code == 0
    for word in ("Error", "Warning", "Exception", "Traceback"):
        assert word not in outcome.output


def test_status_lines_end_in_sample_counts(blend, tmp_path):
    slow = SETTING.format("s.granita.samples = 1024; r.resolution_x = r.resolution_y = 192")
    outcome = render_host.run(blend, tmp_path / "out", slow)
    assert outcome.code == 0, outcome.output
    lines = [line for line in outcome.output.splitlines() if "Sample" in line]
    counts = [tuple(map(int, line.rsplit(" ", 1)[1].split("/"))) for line in lines]
    if not lines and bpy.app.version >= (5, 0):
        pytest.skip("Blender 5 as a module prints no status lines")
    assert lines and all(0 <= done <= total for done, total in counts)
    assert counts == sorted(counts)
    percentages = [int(p) for line in lines for p in re.findall(r" \| Rendered (\d+)% \| ", line)]
    assert percentages == sorted(percentages)  # none of a frame of less than a second


def bad_geometry(scene, material):
    """Things that are nothing, named; none may touch another pixel."""
    nan, inf = float("nan"), float("inf")
    square = [(-0.5, -0.5, 0.5), (0.5, -0.5, 0.5), (0.5, 0.5, 0.5), (-0.5, 0.5, 0.5)]
    face = [(0, 1, 2, 3)]
    parts.add_mesh(scene, "NotANumber", [(nan, 0, 0), *square[1:]], face, material=material)
    parts.add_mesh(scene, "Infinite", [(inf, 0, 0), *square[1:]], face, material=material)
    parts.add_mesh(scene, "Line", [(0, 0, 1), (1, 0, 1), (2, 0, 1)], [(0, 1, 2)], material=material)
    parts.add_mesh(scene, "Point", [(0, 0, 1)] * 4, face, material=material)
    parts.add_mesh(scene, "Empty", [], [], material=material)
    flat = parts.add_mesh(scene, "Flat", square, face, material=material)
    flat.scale = (0, 0, 0)


def test_bad_geometry_changes_no_other_pixel(scene, tmp_path, render):
    parts.add_camera(scene)
    glow = parts.emission("Glow", (0.25, 0.5, 0.75))
    parts.add_square(scene, material=glow).rotation_euler = (0.3, 0.2, 0.7)
    good = render(scene, "good")
    bad_geometry(scene, glow)
    bad = render(scene, "bad")
    for name, plane in good.items():
        np.testing.assert_array_equal(bad[name], plane, name)
    blend = tmp_path / "bad.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True)
    outcome = render_host.run(blend, tmp_path / "out")
    assert outcome.code == 0, outcome.output
    warnings = [line for line in outcome.output.splitlines() if "Warning: " in line]
    for culprit in ("NotANumber", "Infinite"):
        assert sum(culprit in line for line in warnings) == 1, outcome.output


def test_statistics_of_each_frame(blend, tmp_path):
    import json

    file = tmp_path / "stats.json"
    options = ("--granita-stats", str(file), "--granita-threads", "2", "--granita-device=cpu")
    outcome = render_host.run(blend, tmp_path / "out", first=3, last=4, options=options)
    assert outcome.code == 0, outcome.output
    records = [json.loads(line) for line in file.read_text().splitlines()]
    assert [record["frame"] for record in records] == [3, 4]
    for record in records:
        assert record["scene"] == "Scene" and record["view_layers"] == ["ViewLayer"]
        assert (record["width"], record["height"], record["samples"]) == (64, 48, 4)
        assert record["device"].startswith("CPU")
        seconds = record["seconds"]
        assert set(seconds) == {"export", "scene", "render", "total"}
        parts_sum = seconds["export"] + seconds["scene"] + seconds["render"]
        assert 0 < parts_sum <= seconds["total"]
        assert record["statistics"]["points_shaded"] > 0
        assert record["statistics"]["samples_total"] >= 64 * 48 * 4
        assert record["peak_resident_bytes"] > 10 * 2**20
        assert record["warnings"] == []
    assert os.path.getsize(file) > 0
