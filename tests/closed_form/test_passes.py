# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes against closed forms: what samples remember of what they saw."""

import numpy as np
import pytest
import snapshots

ALL = [
    "Depth", "Mist", "Vector", "Position", "Normal", "UV", "Object Index", "Material Index",
    "Diffuse Direct", "Diffuse Color", "Glossy Direct", "Glossy Color", "Transmission Direct",
    "Transmission Color", "Emission", "Environment", "Shadow",
]  # fmt: skip
FLOATS = {"Vector": 4, "Mist": 1, "Object Index": 1, "Material Index": 1}
# float32 sums over a pixel's samples, relative.
ROUNDING = 1e-5


def sun(snapshot, energy=1.0, direction=(0.0, 0.0, 1.0)):
    """Shines along `direction` (world)."""
    z = -np.asarray(direction, float)
    z /= np.linalg.norm(z)
    x = np.cross((0.0, 1.0, 0.0), z)
    x /= np.linalg.norm(x)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([x, np.cross(z, x), z], 1)
    snapshot.setdefault("lights", []).append(
        {"name": "Sun", "kind": "SUN", "world_from_light": matrix[None], "energy": energy}
    )


def surface(snapshot, node_type, index=0, extra=(), **inputs):
    """Adds a material of one closure; `extra` nodes come before it."""
    closure = {"type": node_type, "inputs": inputs}
    nodes = [closure, *extra]
    number = len(snapshot["materials"])
    snapshot["materials"].append(
        {"name": f"Material {number}", "nodes": nodes, "surface": (0, "BSDF"), "index": index}
    )
    return number


def diffuse(snapshot, color=(0.8, 0.4, 0.2), **kwargs):
    return surface(snapshot, "ShaderNodeBsdfDiffuse", Color=(*color, 1.0), **kwargs)


def passes(snapshot, names=ALL, **options):
    snapshot["options"] |= {"passes": list(names), **options}
    return snapshots.render(snapshot)


def everything(snapshot):
    """Lit, glossy, glowing, transparent, overlapping."""
    sun(snapshot, 2.0, (0.3, 0.2, 1.0))
    glow = snapshots.emission(snapshot, (0.2, 0.5, 1.0), alpha=0.5)
    snapshots.quad(snapshot, snapshots.rectangle(2, 2, 30, 20, 4), diffuse(snapshot, index=3))
    gloss = surface(snapshot, "ShaderNodeBsdfGlossy", 5, Color=(0.9, 0.7, 0.5, 1), Roughness=0.4)
    snapshots.quad(snapshot, snapshots.rectangle(10, 8, 40, 30, 3), gloss)
    snapshots.quad(snapshot, snapshots.rectangle(5, 5, 25, 28, 2), glow)
    snapshot["world"] = {
        "name": "World",
        "nodes": [{"type": "ShaderNodeBackground", "inputs": {"Color": (0.1, 0.2, 0.3, 1)}}],
        "surface": (0, "Background"),
        "lights_scene": True,
    }


def test_shapes_and_names(executor):
    snapshot = snapshots.orthographic((20, 12), executor=executor)
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 20, 12), diffuse(snapshot))
    aovs = [{"name": "Mask", "kind": "VALUE"}, {"name": "Tint", "kind": "COLOR"}]
    made = passes(snapshot, aovs=aovs)
    assert list(made["passes"]) == [*ALL[1:], "Mask", "Tint"]
    for name, values in made["passes"].items():
        width = 4 if name == "Tint" else 1 if name == "Mask" else FLOATS.get(name, 3)
        assert values.shape == (12, 20, width), name
    assert made["depth"].shape == (12, 20)


def test_nothing_asked_is_nothing_made(executor):
    snapshot = snapshots.orthographic((8, 8), executor=executor)
    made = snapshots.render(snapshot)
    assert made["passes"] == {} and made["depth"] is None


def test_an_unknown_pass_is_an_error_that_lists_the_known():
    import granita_core

    with pytest.raises(granita_core.SceneError, match="'Normals' is unknown.*Normal, UV"):
        passes(snapshots.orthographic((8, 8)), ["Normals"])


def test_geometry_of_a_plane(executor):
    """A plane z = 3 + x / 10 seen along z: every pass of one sample is known at the sample, and
    the pixel's centre is within half the largest gap between samples."""
    snapshot = snapshots.orthographic((16, 16), executor=executor, samples=64)
    corners = [(0, 0, 3.0), (16, 0, 4.6), (16, 16, 4.6), (0, 16, 3.0)]
    uv = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
    attributes = [{"name": "UVMap", "domain": "CORNER", "kind": "UV", "values": uv}]
    snapshots.quad(snapshot, corners, diffuse(snapshot, index=7), attributes=attributes)
    made = passes(snapshot)["passes"]
    y, x = np.mgrid[0:16, 0:16] + 0.5
    position = made["Position"]
    # The sample nearest to the centre of 64 is at most .15 pixels from it.
    assert np.abs(position[..., 0] - x).max() < 0.15
    assert np.abs(position[..., 1] - y).max() < 0.15
    # It is one point of the plane, not a mixture.
    assert np.abs(position[..., 2] - (3 + position[..., 0] / 10)).max() < 1e-5
    normal = np.array([0.1, 0.0, -1.0]) / np.hypot(0.1, 1.0)
    assert np.abs(made["Normal"] - normal).max() < 1e-5
    # Filtered: the mean of 64 stratified samples, each within 1/8 pixel of its cell's centre.
    assert np.abs(made["UV"][..., 0] - x / 16).max() < 0.2 / 16
    assert np.abs(made["UV"][..., 1] - y / 16).max() < 0.2 / 16
    assert np.all(made["Material Index"] == 7)


def test_depth_position_and_mist_of_one_sample_agree(executor):
    snapshot = snapshots.perspective((16, 16), 20.0, executor=executor, samples=1)
    corners = [(-9, -9, 6.0), (9, -9, 14.0), (9, 9, 14.0), (-9, 9, 6.0)]
    snapshots.quad(snapshot, corners, diffuse(snapshot))
    # Micropolygons of a quarter of a pixel, h < .25 m, interpolate the distance linearly: its error
    # is at most 2 h^2 / (8 distance), of the mist .002 / 30.
    mist = np.array([2.0, 30.0, 1.0], np.float32)
    made = passes(snapshot, mist=mist, dicing_rate=0.25)
    position = made["passes"]["Position"]
    assert np.abs(position[..., 2] - made["depth"]).max() < 1e-4
    distance = np.linalg.norm(position, axis=-1)
    assert np.abs(made["passes"]["Mist"][..., 0] - (distance - 2.0) / 30.0).max() < 1e-3


def test_nothing_seen(executor):
    snapshot = snapshots.orthographic((4, 4), executor=executor)
    made = passes(snapshot)
    for name, values in made["passes"].items():
        assert np.all(values == (1.0 if name == "Mist" else 0.0)), name
    assert np.all(made["depth"] == np.float32(1e10))


def test_indices_are_never_mixed(executor):
    snapshot = snapshots.orthographic((16, 16), executor=executor, filter_width=1.5,
                                      pixel_filter="BLACKMAN_HARRIS")  # fmt: skip
    for k in range(4):
        corners = snapshots.rectangle(3.3 * k, 1.7, 3.3 * k + 3.3, 15.2, 2)
        snapshots.quad(snapshot, corners, diffuse(snapshot, index=[3, 17, 100, 32767][k]))
    made = passes(snapshot)["passes"]["Material Index"]
    assert set(np.unique(made)) == {0, 3, 17, 100, 32767}


def test_direct_light_of_a_lambertian_plane(executor):
    """A sun of irradiance E, perpendicular: radiance color E / pi."""
    snapshot = snapshots.orthographic((8, 8), executor=executor)
    color = np.array((0.8, 0.4, 0.0))
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 8, 8), diffuse(snapshot, color))
    sun(snapshot, 3.0)
    made = passes(snapshot)["passes"]
    assert np.abs(made["Diffuse Color"] - color).max() < ROUNDING
    # Blue takes the mean of red and green, having no colour of its own.
    assert np.abs(made["Diffuse Direct"] - 3.0 / np.pi).max() < 1e-4
    assert np.abs(made["Shadow"][..., :2] - 1.0).max() < ROUNDING
    assert np.all(made["Glossy Direct"] == 0.0) and np.all(made["Glossy Color"] == 0.0)


def test_shadow_is_the_share_of_light_that_arrives(executor):
    """A caster outside the frame shades the left half."""
    snapshot = snapshots.orthographic((16, 8), executor=executor)
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 16, 8, 8), diffuse(snapshot))
    snapshots.quad(snapshot, snapshots.rectangle(-24, -4, -8, 12, 0), diffuse(snapshot))
    # From the caster at z = 0 to the plane at z = 8 light moves 16 to the right.
    sun(snapshot, 3.0, (2.0, 0.0, 1.0))
    made = passes(snapshot)["passes"]["Shadow"]
    assert np.all(made[:, :7] == 0.0)
    assert np.abs(made[:, 9:] - 1.0).max() < ROUNDING


def test_parts_sum_to_the_picture(executor):
    """Combined is light by colour plus emission plus environment, behind transparency too."""
    snapshot = snapshots.orthographic((48, 32), executor=executor, film_transparent=False)
    everything(snapshot)
    made = passes(snapshot)
    p = made["passes"]
    parts = (
        p["Diffuse Direct"] * p["Diffuse Color"]
        + p["Glossy Direct"] * p["Glossy Color"]
        + p["Transmission Direct"] * p["Transmission Color"]
        + p["Emission"]
        + p["Environment"]
    )
    combined = made["combined"][..., :3]
    assert np.ptp(combined) > 0.5
    assert np.abs(parts - combined).max() < ROUNDING * combined.max()


def test_the_albedo_for_denoisers_is_that_of_all_lobes(executor):
    snapshot = snapshots.orthographic((48, 32), executor=executor)
    everything(snapshot)
    p = passes(snapshot, [*ALL, "Denoising Albedo", "Denoising Normal"])["passes"]
    colors = p["Diffuse Color"] + p["Glossy Color"] + p["Transmission Color"]
    assert np.ptp(colors) > 0.5
    assert np.abs(p["Denoising Albedo"] - colors).max() < ROUNDING
    assert np.array_equal(p["Denoising Normal"], p["Normal"])


def test_transparency_weighs_colours_and_passes_through_what_the_threshold_excludes(executor):
    """A pane of opacity 1/4 at z = 2 over an opaque wall at z = 4."""
    snapshot = snapshots.orthographic((8, 8), executor=executor)
    pane = snapshots.emission(snapshot, (1, 1, 1), alpha=0.25)
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 8, 8, 2), pane)
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 8, 8, 4), diffuse(snapshot, (0.8, 0.4, 0.2)))
    mist = np.array([0.0, 8.0, 1.0], np.float32)
    for threshold, z in ((0.0, 2.0), (0.25, 2.0), (0.26, 4.0)):
        made = passes(snapshot, pass_alpha_threshold=threshold, mist=mist)
        assert np.abs(made["depth"] - z).max() < 1e-5
        assert np.abs(made["passes"]["Position"][..., 2] - z).max() < 1e-5
        assert (
            np.abs(made["passes"]["Diffuse Color"] - 0.75 * np.array((0.8, 0.4, 0.2))).max() < 1e-5
        )
        assert np.abs(made["passes"]["Emission"] - 0.25).max() < ROUNDING
        # 1/4 of the light comes from a quarter of the mist's depth, 3/4 from its half.
        assert np.abs(made["passes"]["Mist"] - (0.25 * 0.25 + 0.75 * 0.5)).max() < 1e-5


def test_mist_behind_coloured_glass_is_weighed_by_its_mean(executor):
    """A clear pane of opacity (0, 1/4, 1), 5/12 in the mean, at z = 2 before a wall at z = 4."""
    snapshot = snapshots.orthographic((8, 8), executor=executor)
    glass = {"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1, 0.75, 0, 1)}}
    snapshot["materials"].append({"name": "Glass", "nodes": [glass], "surface": (0, "BSDF")})
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 8, 8, 2), 0)
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 8, 8, 4), diffuse(snapshot, (1, 1, 1)))
    made = passes(snapshot, mist=np.array([0.0, 8.0, 1.0], np.float32))["passes"]
    assert np.abs(made["Mist"] - (5 / 12 * 0.25 + 7 / 12 * 0.5)).max() < 1e-5


def test_what_stands_for_a_sample_is_found_behind_the_end_of_its_list(executor):
    """Eight panes of .4 end the list at 98 %; none of them is seen by the passes of surfaces."""
    options = {"opacity_threshold": 0.9, "pass_alpha_threshold": 0.5, "depth_pass": True}
    for alpha in (0.6, None):
        snapshot = snapshots.orthographic((8, 8), executor=executor, samples=4, **options)
        pane = snapshots.emission(snapshot, (1, 1, 1), alpha=0.4)
        for z in range(2, 10):
            snapshots.quad(snapshot, snapshots.rectangle(0, 0, 8, 8, z), pane)
        wall = snapshots.emission(snapshot, (1, 1, 1), alpha=alpha)
        for z in (20, 30):
            snapshots.quad(snapshot, snapshots.rectangle(0, 0, 8, 8, z), wall)
        assert np.abs(snapshots.render(snapshot)["depth"] - 20).max() < 1e-4


def test_aovs_of_materials(executor):
    """AOV Output nodes; where a material has none, 0; half a pixel of coverage halves them."""
    snapshot = snapshots.orthographic((8, 4), executor=executor, samples=64)
    output = {
        "type": "ShaderNodeOutputAOV",
        "inputs": {"Color": (0.25, 0.5, 2.0, 1.0), "Value": 3.0},
    }
    nodes = [{**output, "properties": {"aov_name": name}} for name in ("Tint", "Mask")]
    with_aovs = diffuse(snapshot, extra=nodes)
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 2.5, 4), with_aovs)
    snapshots.quad(snapshot, snapshots.rectangle(4, 0, 8, 4), diffuse(snapshot))
    aovs = [{"name": "Tint", "kind": "COLOR"}, {"name": "Mask", "kind": "VALUE"}]
    made = passes(snapshot, [], aovs=aovs)["passes"]
    assert np.abs(made["Tint"][:, :2] - (0.25, 0.5, 2.0, 1.0)).max() < ROUNDING
    # 64 samples, stratified in x: an edge through the pixel's middle splits them exactly.
    assert np.abs(made["Tint"][:, 2] - 0.5 * np.array((0.25, 0.5, 2.0, 1.0))).max() < ROUNDING
    assert np.all(made["Tint"][:, 3:] == 0.0)
    assert np.abs(made["Mask"][:, :2] - 3.0).max() < 3 * ROUNDING
    assert np.all(made["Mask"][:, 4:] == 0.0)


@pytest.mark.parametrize("alpha", [None, 0.75])
def test_holdouts_are_in_no_pass_but_hide_what_is_behind(executor, alpha):
    """As in Cycles, and clear ones likewise (docs/decisions/passes.md): neither depth nor index of what is cut out, nor of what
    it hides; its nodes' own output stays."""
    snapshot = snapshots.orthographic((8, 8), executor=executor, depth_pass=True)
    snapshot["options"] |= {"opacity_threshold": 1.0, "pass_alpha_threshold": 0.5}
    cut = snapshots.emission(snapshot, alpha=alpha)
    material = snapshot["materials"][cut]
    material["index"] = 4
    output = {"aov_name": "Tint"}
    inputs = {"Color": (0.25, 0.5, 2.0, 1.0), "Value": 0.0}
    material["nodes"].append(
        {"type": "ShaderNodeOutputAOV", "inputs": inputs, "properties": output}
    )
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 8, 8, 2), cut)
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 8, 8, 4), diffuse(snapshot, index=5))
    snapshot["instances"]["flags"] = [7, 3]
    result = passes(snapshot, aovs=[{"name": "Tint", "kind": "COLOR"}])
    made = result["passes"]
    assert np.all(made["Material Index"] == 0)
    assert np.all(made["Normal"] == 0.0)
    assert np.all(result["depth"] == 1e10)
    left = 0.0 if alpha is None else 1.0 - alpha
    assert np.abs(made["Diffuse Color"] - left * np.array((0.8, 0.4, 0.2))).max() < ROUNDING
    assert np.abs(made["Tint"] - (0.25, 0.5, 2.0, 1.0)).max() < ROUNDING


def test_samples_of_a_holdout_with_holes_are_in_no_pass():
    """Where its opacity varies samples are shaded by themselves; behind it there is nothing."""
    snapshot = snapshots.orthographic((8, 8), samples=16, pass_alpha_threshold=0.5)
    nodes = [
        {"type": "ShaderNodeTexChecker", "inputs": {"Scale": 11.0}},
        {"type": "ShaderNodeBsdfTransparent", "inputs": {}},
        {"type": "ShaderNodeBsdfDiffuse", "inputs": {}},
        {
            "type": "ShaderNodeMixShader",
            "inputs": {
                "Fac": ("LINK", 0, "Fac"),
                "Shader": ("LINK", 1, "BSDF"),
                "Shader_001": ("LINK", 2, "BSDF"),
            },
        },
    ]
    card = {"name": "Card", "nodes": nodes, "surface": (3, "Shader"), "index": 4}
    snapshot["materials"].append(card)
    cut = len(snapshot["materials"]) - 1
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 8, 8, 2), cut)
    snapshot["instances"]["flags"] = [7]
    made = passes(snapshot)["passes"]
    assert np.all(made["Material Index"] == 0)
    assert np.all(made["Normal"] == 0.0)


def test_passes_change_neither_picture_nor_visibility(executor):
    """Samples and grids are the same for 1 pass and for 12 (the paper renders once an output)."""

    def render(names):
        snapshot = snapshots.orthographic((48, 32), executor=executor, film_transparent=False)
        everything(snapshot)
        return passes(snapshot, names)

    plain, all_passes = render([]), render(ALL)
    assert np.array_equal(plain["combined"], all_passes["combined"])
    for name, count in plain["statistics"].items():
        # Which thread takes a piece of a loop is chance.
        if not name.startswith(("seconds_", "peak_", "memory_", "loop_pieces_")):
            assert all_passes["statistics"][name] == count, name


def test_no_bit_depends_on_buckets_or_threads(executor):
    def render(**options):
        snapshot = snapshots.orthographic((80, 48), executor=executor, film_transparent=False)
        everything(snapshot)
        return passes(snapshot, **options)["passes"]

    one, many = render(threads=1, bucket_size=128), render(threads=3, bucket_size=16)
    for name, values in one.items():
        assert np.array_equal(values, many[name]), name
