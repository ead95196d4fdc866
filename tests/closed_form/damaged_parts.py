# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshots that are damaged by chance: what an export that errs, or a script, may hand to the native module.

`python damaged_parts.py FIRST COUNT` renders those of the numbers, for bench/damaged_snapshots.py and
test_bad_snapshots.py; each prints its number before it begins, and the last line is how many ended how.
"""

import copy
import sys
import time
from collections import Counter

import numpy as np
import session_parts
import snapshots as s
from test_displacement import sheet_of_waves
from test_elements import cloud, curves
from test_volumes import absorption, box, emitted, filled, scatter

SIZE = (8, 6)
# Frames that would go on for longer than that are cancelled: a number may be large without being wrong.
PATIENCE = 0.5
NUMBERS = (0, 1, -1, 2, 0.5, -0.0, 1e-45, 1e-9, 1e9, 1e30, -1e30, 1e300, 255, 65536)
NUMBERS += (2**31 - 1, 2**31, -(2**31), 2**63, np.nan, np.inf, -np.inf)
STRANGE = (
    None,
    "",
    "x",
    "\0",
    "\ud800",
    b"x",
    True,
    [],
    (),
    {},
    [[1.0]],
    ("LINK", 0),
    ("LINK", 9, "BSDF"),
)


def _small(snapshot):
    """Of few pixels and samples, on the calling thread and one other."""
    width, height = (snapshot["options"][side] for side in ("width", "height"))
    snapshot["options"].update(width=SIZE[0], height=SIZE[1], samples=2, light_samples=1, threads=1)
    scale = np.array(snapshot["camera"]["scale"], float)
    snapshot["camera"]["scale"] = tuple(scale * [SIZE[0] / width, SIZE[1] / height])
    snapshot["camera"]["center"] = (SIZE[0] / 2, SIZE[1] / 2)
    return s.packed(snapshot)


def _moving():
    """A mesh, a mesh under subdivision, with attributes, creases and neighbouring frames, and all passes."""
    snapshot = session_parts.scene()
    session_parts.other_world(snapshot)
    cage = snapshot["geometries"][2]
    uv = np.random.default_rng(1).random((24, 2), np.float32)
    cage["attributes"] = [
        {"name": "UVMap", "domain": "CORNER", "kind": "UV", "values": uv},
        {"name": "Col", "domain": "POINT", "kind": "COLOR", "values": np.ones((8, 4), np.float32)},
        {"name": "n", "domain": "FACE", "kind": "GENERIC", "values": np.ones((6, 1), np.float32)},
    ]
    cage["subdivision"].update(
        boundary="ALL", crease_verts=np.int32([[0, 1]]), crease_values=np.float32([5.0])
    )
    cage["material_index"] = np.zeros(6, np.int32)
    cage["edges"] = np.int32([[0, 1], [1, 3]])
    cage["adjacent"] = np.concatenate([cage["points"]] * 2)
    snapshot["options"]["passes"] = ["Depth", "Vector", "Normal", "UV", "Diffuse Direct", "Mist"]
    snapshot["options"]["aovs"] = [{"name": "Mask", "kind": "VALUE"}]
    snapshot["options"]["mist"] = (1.0, 9.0, 1.0)
    snapshot["options"]["shutter_curve"] = np.float32([0.0, 1.0, 0.5])
    snapshot["camera"]["adjacent"] = np.stack([np.eye(4)] * 2)
    return snapshot


def _elements():
    """Curves, points and what fills a box, under a lamp of each kind, with light that bounces."""
    snapshot = s.perspective((48, 32), 60.0, bounces=2, film_transparent=False)
    matte = session_parts.matte(snapshot, (0.8, 0.6, 0.4), 0.5)
    random = np.random.default_rng(2)
    curves(snapshot, random.uniform(-1, 1, (2, 12, 3)) + [0, 0, 5], [5, 4, 2, 1], 0.1, matte)
    cloud(snapshot, random.uniform(-1, 1, (9, 3)) + [0, 0, 5], 0.2, matte)
    box(
        snapshot, (-2, -2, 3), (2, 2, 6), filled(snapshot, scatter(0.2), absorption(), emitted(0.1))
    )
    place = np.stack([s.translation(x, 3.0) @ np.diag([1.0, 1.0, -1.0, 1.0]) for x in (0, 1)])
    lamp = {"world_from_light": place, "energy": 9.0, "color": (1, 1, 1), "radius": 0.1}
    more = {"sun_angle": 0.1, "spot_size": 1.0, "spot_blend": 0.2, "shape": "DISK", "size": (1, 2)}
    kinds = ("POINT", "SUN", "SPOT", "AREA")
    snapshot["lights"] = [{**lamp, **more, "name": kind, "kind": kind} for kind in kinds]
    node = {"type": "ShaderNodeEmission", "name": "E", "inputs": {"Strength": 2.0}}
    snapshot["lights"][0].update(nodes=[node], surface=(0, "Emission"))
    table = snapshot["instances"]
    table["flags"] = [123, 123 | 128, 123 | 4]
    table["receives"] = [1, 2, 3]
    session_parts.other_world(snapshot)
    return snapshot


def _textured():
    """Images in a colour space, procedural textures, a bump, glass, wax and Principled."""
    snapshot = s.perspective((48, 32), 60.0, bounces=3, film_transparent=False)
    texels = np.random.default_rng(3).integers(0, 255, (4, 8, 4)).astype(np.uint8)
    space = {
        "name": "Q",
        "curve": "TABLE",
        "table": np.float32([0, 0.2, 1]),
        "low": 0.0,
        "high": 1.0,
    }
    snapshot["color_spaces"] = [space]
    floats = texels.astype(np.float32) / 255
    snapshot["images"] = [
        {"name": "I", "bytes": texels, "colorspace": "Q"},
        {"name": "I/1002", "pixels": floats, "colorspace": "sRGB", "alpha_mode": "UNASSOCIATED"},
        {"name": "Lost", "path": "/nowhere/lost.png", "colorspace": "sRGB"},
    ]
    tiles = {"image": "I", "tiles": np.float32([1001, 1002]), "tiles_of": "I"}
    ramp = np.linspace(0, 1, 1024).reshape(256, 4).astype(np.float32)
    shaders = {
        "ShaderNodeBsdfPrincipled": {
            "Base Color": s.link(1, "Color"),
            "Normal": s.link(3, "Normal"),
            "Sheen Weight": 0.5,
        },
        "ShaderNodeBsdfGlass": {"Color": s.link(4, "Color"), "Roughness": 0.1, "IOR": 1.4},
        "ShaderNodeSubsurfaceScattering": {"Radius": (1.0, 0.5, 0.2), "Scale": 0.5},
        "ShaderNodeBsdfGlossy": {"Roughness": s.link(2, "Fac")},
    }
    for i, (kind, inputs) in enumerate(shaders.items()):
        nodes = [
            {"type": "ShaderNodeTexCoord", "inputs": {}},
            {
                "type": "ShaderNodeTexImage",
                "inputs": {"Vector": s.link(0, "Generated")},
                "properties": {"image": "I", "interpolation": "Cubic", "projection": "BOX"}
                if i
                else tiles,
            },
            {
                "type": "ShaderNodeTexNoise",
                "inputs": {"Scale": 4.0},
                "properties": {"version": 405},
            },
            {"type": "ShaderNodeBump", "inputs": {"Height": s.link(2, "Fac"), "Strength": 0.5}},
            {
                "type": "ShaderNodeValToRGB",
                "inputs": {"Fac": s.link(2, "Fac")},
                "properties": {"ramp": ramp, "interpolation": "LINEAR"},
            },
            {"type": kind, "inputs": inputs},
        ]
        output = "BSSRDF" if "Subsurface" in kind else "BSDF"
        for node in nodes:
            node["name"] = node["type"]
        snapshot["materials"].append({"name": kind, "nodes": nodes, "surface": (5, output)})
        x = 1.2 * i - 2.4
        box(snapshot, (x, -1, 4), (x + 1, 1, 5), i)
    session_parts.sun(snapshot, sun_angle=0.1)
    session_parts.other_world(snapshot)
    return snapshot


def _displaced():
    return sheet_of_waves(False, size=16, samples=4, bounces=1)


def whole():
    """Snapshots with nothing wrong, as the native module takes them."""
    of_lens = s.busy("SIMD", lens="moving")
    return [_small(made) for made in (_moving(), _elements(), _textured(), _displaced(), of_lens)]


def _damaged_array(value, random):
    flat = value.reshape(-1)
    way = random.integers(8)
    if way < 3 and flat.size:
        flat = flat.copy()
        with np.errstate(all="ignore"):
            numbers = np.array([random.choice(NUMBERS)]).astype(value.dtype)
        flat[random.integers(flat.size, size=random.integers(1, 4))] = numbers[0]
        return flat.reshape(value.shape)
    if way == 3:
        return value[: random.integers(len(value) + 1)] if value.ndim else value
    if way == 4:
        return np.concatenate([value, value]) if value.ndim else value
    if way == 5:
        return random.permutation(flat).reshape(value.shape)
    if way == 6:
        with np.errstate(all="ignore"):
            return value.astype(random.choice(["f4", "f8", "i4", "i8", "u1", "c8", "bool", "S3"]))
    return [value.T, flat, value[:0], value[None]][random.integers(4)]


def _other(value, random):
    """In place of a leaf."""
    if random.integers(12) == 0:
        return STRANGE[random.integers(len(STRANGE))]
    if isinstance(value, np.ndarray):
        return _damaged_array(value, random)
    if isinstance(value, str):
        return random.choice([value[:-1], value + "x", value.lower(), "é\x1b[31m", value * 99])
    if isinstance(value, int | float) and random.integers(2):
        return value * random.choice([-1.0, 0.01, 0.5, 1.5, 40.0])
    return NUMBERS[random.integers(len(NUMBERS))]


def _places(container):
    """[(container, key)] of all that lies in it, however deep.  Tuples become lists."""
    keys = container.keys() if isinstance(container, dict) else range(len(container))
    places = []
    for key in list(keys):
        if isinstance(container[key], tuple):
            container[key] = list(container[key])
        inner = container[key]
        places.append((container, key))
        if isinstance(inner, dict | list):
            places += _places(inner)
        elif isinstance(inner, np.ndarray):
            places += [(container, key)] * 3
    return places


def _damage_once(snapshot, random):
    """Spoils an entry by chance, or its place."""
    places = _places(snapshot)
    container, key = places[random.integers(len(places))]
    inner, way = container[key], random.integers(16)
    if way == 0:
        del container[key]
    elif way == 1 and isinstance(container, list):
        container.insert(key, copy.deepcopy(inner))
    elif way == 2 and isinstance(container, dict):
        container[f"{key}x"] = container.pop(key)
    elif way == 3:
        keys = list(container) if isinstance(container, dict) else range(len(container))
        other = keys[random.integers(len(keys))]
        container[key], container[other] = container[other], inner
    elif isinstance(inner, dict | list) and inner and way != 4:
        _damage_once(inner, random)
    else:
        container[key] = _other(inner, random)


def damaged(number, bases):
    """The snapshot of a number, which alone decides what is spoiled in which of the whole ones."""
    random = np.random.default_rng(number)
    snapshot = copy.deepcopy(bases[number % len(bases)])
    for _ in range(random.choice([1, 1, 1, 2, 3, 6])):
        _damage_once(snapshot, random)
    return snapshot


def outcome(snapshot):
    """How its frame ends; raises what the native module must not raise."""
    import granita_core

    try:
        job = granita_core.Render(granita_core.Scene(snapshot))
    except granita_core.SceneError as error:
        if not error.datablock:
            raise
        return "refused"
    except granita_core.InternalError:
        raise
    except granita_core.Error:
        return "failed"
    began, cancelled = time.monotonic(), False
    while not job.done():
        job.take_tiles(0.05)
        if not cancelled and time.monotonic() - began > PATIENCE:
            job.cancel()
            cancelled = True
    try:
        job.finish()
    except granita_core.Cancelled:
        return "cancelled"
    except granita_core.InternalError:
        raise
    except granita_core.Error:
        return "failed"
    return "rendered"


def main(first, count):
    bases = whole()
    ends = Counter()
    for number in range(first, first + count):
        print(number, flush=True)
        end = outcome(damaged(number, bases))
        ends[end] += 1
    print(dict(ends))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
