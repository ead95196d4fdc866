# SPDX-License-Identifier: GPL-3.0-or-later
"""Light scattered below surfaces against closed forms: slabs that keep their albedo, edges of shadows that follow the
profile, sheets that let light through."""

import numpy as np
import pytest
import snapshots as s
from test_many_lamps import lamp

SIZE = 32


def scattering(
    snapshot,
    method="RANDOM_WALK",
    albedo=(0.8, 0.5, 0.2),
    reach=(1.0, 1.0, 1.0),
    version=306,
    **inputs,
):
    """A material of Subsurface Scattering alone; returns its index."""
    inputs = {"Color": (*albedo, 1.0), "Scale": 1.0, "Radius": reach, "IOR": 1.4, **inputs}
    properties = {"falloff": method, "version": float(version)}
    node = {"type": "ShaderNodeSubsurfaceScattering", "inputs": inputs, "properties": properties}
    index = len(snapshot["materials"])
    snapshot["materials"].append({"name": "Wax", "nodes": [node], "surface": (0, "BSSRDF")})
    return index


def slab(snapshot, material, depth=4e2, half=4e2, middle=SIZE / 2, transforms=None):
    """Seen from in front, its face at z = 10, across the whole frame unless it is less wide."""
    corners = [
        (x, y, z)
        for z in (10.0, 10.0 + depth)
        for y in (middle - half, middle + half)
        for x in (middle - half, middle + half)
    ]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    s.mesh(snapshot, corners, faces, material, transforms)


def lit_half(snapshot, axis=None):
    """By a white world; `axis`: by that half of it alone that is on this axis' positive side."""
    s.half_world(snapshot)
    world = snapshot["world"]
    world["lights_scene"] = True
    if axis:
        world["nodes"][2]["inputs"]["Value"] = ("LINK", 1, axis)
    else:
        world["nodes"][3]["inputs"]["Color"] = (1.0,) * 4


def view(**options):
    return s.orthographic((SIZE, SIZE), **{"samples": 4, "light_samples": 16, **options})


def seen(snapshot):
    return s.render(snapshot)["combined"][..., :3].astype(float)


ALBEDO = (0.9, 0.5, 0.2)
METHODS = ["BURLEY", "RANDOM_WALK", "RANDOM_WALK_FIXED_RADIUS"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", [1.0, 1e-3, 1e-6])
def test_a_big_slab_keeps_its_albedo(method, size):
    """Under white light from all around, however short the ways, of rounded positions too.  Of the walk the tolerance is
    that of van de Hulst's fit, .002, and twice the noise of neighbours' ways, .003 (what 256 samples leave of pixels'
    own, .035, over 4096 of them)."""
    snapshot = view()
    slab(snapshot, scattering(snapshot, method, ALBEDO, (8.0 * size, 4.0 * size, 2.0 * size)))
    lit_half(snapshot)
    assert seen(snapshot).mean(axis=(0, 1)) == pytest.approx(ALBEDO, abs=0.008)


# Heaslet and Warming 1965, "Radiative transport and wall temperature slip in an absorbing planar medium": share of
# diffuse light that a sheet lets through which scatters all that it meets, by its thickness in mean free paths.
LET_THROUGH = {0.1: 0.9157, 1.0: 0.5532, 5.0: 0.2077}


@pytest.mark.parametrize("thickness", LET_THROUGH)
def test_a_white_sheet_lets_through_what_it_does_not_reflect(thickness):
    """Lit from behind, then from before."""
    means = []
    for turned in (1.0, -1.0):
        snapshot = view()
        radius = (4 * np.pi / thickness,) * 3  # a mean free path is a 4 pi-th of it
        material = scattering(snapshot, "RANDOM_WALK_FIXED_RADIUS", (1.0,) * 3, radius)
        slab(snapshot, material, depth=1.0, half=1e3)
        lit_half(snapshot, "Z")
        snapshot["camera"]["world_from_camera"] = np.diag([turned, 1.0, turned, 1.0])[None]
        snapshot["camera"]["world_from_camera"][0, :3, 3] = (
            (0, 0, 0) if turned > 0 else (SIZE, 0, 21)
        )
        means.append(seen(snapshot).mean())
    assert means[0] == pytest.approx(LET_THROUGH[thickness], abs=0.01)
    assert sum(means) == pytest.approx(1.0, abs=0.01)


def bar(snapshot, material, side, faces, turn=0.5):
    """Upright and square, of small faces; returns the pixels that it covers."""
    corners = side / np.sqrt(2) * np.exp(1j * (turn + np.pi / 4 + np.arange(4) * np.pi / 2))
    heights = np.linspace(-4.0, SIZE + 4.0, faces)
    points = [(15.3 + c.real, y, 20.0 + c.imag) for y in heights for c in corners]
    rows = [
        (4 * k + i, 4 * k + (i + 1) % 4, 4 * k + 4 + (i + 1) % 4, 4 * k + 4 + i)
        for k in range(faces - 1)
        for i in range(4)
    ]
    last = 4 * (faces - 1)
    ends = [(3, 2, 1, 0), (last, last + 1, last + 2, last + 3)]
    s.mesh(snapshot, points, rows + ends, material)
    return SIZE * side * (np.cos(turn) + np.sin(turn))


@pytest.mark.parametrize(("side", "faces"), [(1.2, 32), (5.0, 32), (8.0, 64)])
def test_a_white_bar_of_small_faces_loses_nothing(side, faces):
    """Lit from all around.  Light that entered at the corners of small faces, which are edges of the body, began beside it: .16
    was lost."""
    snapshot = view(samples=64)
    material = scattering(snapshot, "RANDOM_WALK_FIXED_RADIUS", (1.0,) * 3, (4.0,) * 3)
    covered = bar(snapshot, material, side, faces)
    lit_half(snapshot)
    missing = (1.0 - seen(snapshot)[..., 0]).sum() / covered
    assert missing == pytest.approx(0.0, abs=0.006)


def line_integral(x, d):
    """Share of what a point at `x` shows that Burley's profile takes from where x > 0, which is lit."""
    r = d * np.linspace(0.0, 16.0, 20001)[1:]
    radial = (np.exp(-r / d) + np.exp(-r / (3 * d))) / (4 * d)
    beyond = (
        np.arccos(np.clip(-x / r, -1.0, 1.0)) / np.pi
    )  # of the circle, where x + r cos(phi) > 0
    return np.sum(radial * beyond) / np.sum(radial)


def test_the_edge_of_a_shadow_follows_the_profile():
    """A sun straight above, of whose light a sheet takes what falls on x < 16."""
    snapshot = view(light_samples=64)
    d = 3.0
    slab(snapshot, scattering(snapshot, "BURLEY", (0.8,) * 3, (4 * np.pi * d,) * 3))
    s.quad(snapshot, s.rectangle(-4e3, -4e3, SIZE / 2, 4e3, -1.0))
    snapshot["instances"]["flags"] = [59, 59 - 1]
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": down[None], "energy": np.pi}
    ]
    row = seen(snapshot)[..., 0].mean(axis=0)
    truth = 0.8 * np.array([line_integral(x + 0.5 - SIZE / 2, d) for x in range(SIZE)])
    # A column's mean of 2048 probes: .5 / sqrt(2048) = .011 at most.
    assert np.abs(row - truth).max() < 3 * 0.011
    assert row.mean() == pytest.approx(truth.mean(), abs=0.005)


@pytest.mark.parametrize("method", METHODS)
def test_what_scatters_nowhere_is_diffuse(method):
    pictures = []
    for kind in ("scatters", "diffuse"):
        snapshot = view()
        material = scattering(snapshot, method, ALBEDO, (0.0,) * 3)
        if kind == "diffuse":
            snapshot["materials"][0]["nodes"][0]["type"] = "ShaderNodeBsdfDiffuse"
        slab(snapshot, material)
        lit_half(snapshot, "X")
        pictures.append(seen(snapshot))
    assert np.array_equal(*pictures)


def lump(method="RANDOM_WALK", **options):
    snapshot = view(**options)
    slab(snapshot, scattering(snapshot, method, ALBEDO, (8.0, 4.0, 2.0), 2), depth=8.0, half=12.0)
    lit_half(snapshot, "X")
    return seen(snapshot)


def is_same_to_the_bit(picture):
    """However the frame of a function of options is cut and shared."""
    whole = picture()
    assert np.array_equal(whole, picture(bucket_size=16))
    assert np.array_equal(whole, picture(threads=1))
    crop = np.int32([4, 8, 20, 24])
    assert np.array_equal(whole[8:24, 4:20], picture(crop=crop))


@pytest.mark.parametrize("method", ["BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN"])
@pytest.mark.parametrize("bounces", [0, 2])
def test_bits_do_not_depend_on_buckets_and_threads(method, bounces):
    is_same_to_the_bit(lambda **options: lump(method, bounces=bounces, **options))


def beside(scale, radius, depth, light):
    """A block of 16 x 16 x `depth`, of this radius, metres as wide as pixels are at `scale` 1; its
    pixels then, [16, 16, 3]."""
    snapshot = s.orthographic((SIZE * scale,) * 2, samples=16, light_samples=64)
    reach = (4 * np.pi * radius * scale,) * 3
    material = scattering(snapshot, "RANDOM_WALK_FIXED_RADIUS", reach=reach)
    slab(snapshot, material, depth * scale, 8.0 * scale, SIZE * scale / 2)
    light(snapshot, scale)
    return seen(snapshot).reshape(SIZE, scale, SIZE, scale, 3).mean(axis=(1, 3))[8:24, 8:24]


def test_light_that_goes_less_than_a_pixel_is_no_brighter_at_edges():
    """It enters at the side and leaves beside the edge: points of a lattice that stood for a pixel lay on it, and what
    a block lit so shows was 2.8 to 4 times too bright."""

    def light(snapshot, scale):
        lit_half(snapshot, "Z")

    coarse, fine = (beside(scale, 0.05, 16.0, light) for scale in (1, 8))
    assert fine.mean() > 0.0005
    assert coarse.mean(axis=(0, 1)) == pytest.approx(fine.mean(axis=(0, 1)), rel=0.04)


def test_a_thin_sheet_shows_how_near_a_lamp_behind_it_is():
    """Light goes through it on the spot, be its medium as thin as it likes: neighbours shared what comes through as far as
    the medium scatters light, and its middle was a fifth too dark."""

    def light(snapshot, scale):
        place = (SIZE * scale / 2, SIZE * scale / 2, 10.0 + 5.0 * scale)
        snapshot["lights"] = [lamp(place, 100.0 * scale**2, casts_shadow=True)]

    coarse, fine = (beside(scale, 4.0, 0.8, light) for scale in (1, 6))
    assert coarse.mean(axis=(0, 1)) == pytest.approx(fine.mean(axis=(0, 1)), rel=0.03)
    assert coarse[6:10, 6:10].mean() == pytest.approx(fine[6:10, 6:10].mean(), rel=0.03)


def test_bits_do_not_depend_on_buckets_and_threads_where_ways_land():
    """A waxen lump that moves, of two methods, seen in a mirror that is not sharp."""

    def room(**options):
        snapshot = view(bounces=3, **options)
        wax = scattering(snapshot, "RANDOM_WALK", ALBEDO, (8.0, 4.0, 2.0), version=500)
        nodes = snapshot["materials"][wax]["nodes"]
        nodes.append({**nodes[0], "properties": {**nodes[0]["properties"], "falloff": "BURLEY"}})
        nodes.append(
            {
                "type": "ShaderNodeAddShader",
                "inputs": {"Shader": ("LINK", 0, "BSSRDF"), "Shader_001": ("LINK", 1, "BSSRDF")},
            }
        )
        snapshot["materials"][wax]["surface"] = (2, "Shader")
        knots = [s.translation(x, 0.0, 0.0) for x in (-4.0, 4.0)]
        slab(snapshot, wax, depth=8.0, half=8.0, transforms=knots)
        gloss = {"type": "ShaderNodeBsdfGlossy", "inputs": {"Roughness": 0.4}}
        snapshot["materials"].append({"name": "Gloss", "nodes": [gloss], "surface": (0, "BSDF")})
        s.quad(snapshot, s.rectangle(-40, -40, 80, 80, 40.0), len(snapshot["materials"]) - 1)
        lit_half(snapshot)
        return seen(snapshot)

    is_same_to_the_bit(room)


@pytest.mark.parametrize("bounces", [0, 2])
def test_noise_of_what_scatters_leaves_no_samples_to_shade(bounces):
    """Samples take it from the grid: with one light sample a slab's neighbours differ by much more than the threshold, and
    all of its 4,096 samples were shaded by themselves, for nothing."""
    snapshot = view(light_samples=1, bounces=bounces)
    slab(snapshot, scattering(snapshot, reach=(0.2, 0.2, 0.2)), depth=40.0, half=40.0)
    lit_half(snapshot, axis="X")
    result = s.render(snapshot)
    assert np.abs(np.diff(result["combined"][..., 0])).max() > 0.05
    assert result["statistics"]["points_refined"] == 0


@pytest.mark.parametrize("lit", [1.0, 0.05])
def test_edges_of_texture_over_what_scatters_are_still_shaded_by_samples(lit):
    """Be it that light falls on a small part of a grid alone."""
    snapshot = view(samples=16)
    index = scattering(snapshot)
    nodes = snapshot["materials"][index]["nodes"]
    checker = {"type": "ShaderNodeTexChecker", "inputs": {"Scale": 0.011}}
    checker["inputs"] |= {"Color1": (0.9, 0.9, 0.9, 1.0), "Color2": (0.1, 0.1, 0.1, 1.0)}
    position = {"type": "ShaderNodeNewGeometry", "inputs": {}}
    checker["inputs"]["Vector"] = ("LINK", 0, "Position")
    nodes[0]["inputs"]["Color"] = ("LINK", 1, "Color")
    nodes[:0] = [position, checker]
    snapshot["materials"][index]["surface"] = (2, "BSSRDF")
    slab(snapshot, index, half=40.0)
    lit_half(snapshot)
    if lit < 1.0:  # all but a strip in the dark, behind the eye
        s.quad(snapshot, s.rectangle(-2000, -2000, 2000, (1.0 - lit) * SIZE, 9.9), index)
        snapshot["instances"]["flags"] = [123, 123 & ~1]
    assert s.render(snapshot)["statistics"]["points_refined"] > 0
