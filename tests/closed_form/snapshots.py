# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes as snapshots (docs/scene_snapshot.md), for tests against closed forms.

The orthographic camera maps world x, y to raster pixels one to one and looks along +z, so geometry is given in
pixels.  The perspective camera sits at the origin, looks along +z and has focal length `focal` in pixels.
"""

import numpy as np

# Natural widths of the filters.
FILTERS = {
    "BOX": 1.0,
    "TENT": 2.0,
    "GAUSSIAN": 1.5,
    "BLACKMAN_HARRIS": 1.5,
    "MITCHELL": 4.0,
    "CATMULL_ROM": 4.0,
    "LANCZOS": 6.0,
    "BSPLINE": 4.0,
}


def orthographic(size, **options):
    """Snapshot without geometry, `size` = (width, height) pixels."""
    return _snapshot(
        size,
        {"kind": "ORTHOGRAPHIC", "scale": (1, 1), "center": (0, 0), "clip": (0.01, 1e4)},
        options,
    )


def perspective(size, focal, center=None, clip=(0.1, 1e5), **options):
    center = center or (size[0] / 2, size[1] / 2)
    return _snapshot(
        size,
        {"kind": "PERSPECTIVE", "scale": (focal, focal), "center": center, "clip": clip},
        options,
    )


def _snapshot(size, camera, options):
    camera = {"name": "Camera", "world_from_camera": np.eye(4)[None], **camera}
    defaults = {
        "pixel_filter": "BOX",
        "filter_width": 1.0,
        "film_transparent": True,
        "opacity_threshold": 1.0,
    }
    return {
        "options": {"width": size[0], "height": size[1], **defaults, **options},
        "camera": camera,
        "geometries": [],
        "instances": {
            "name": [],
            "geometry": [],
            "knots": [],
            "world_from_object": [],
            "slots": [],
            "materials": [],
            "lifespan": [],
        },
        "materials": [],
    }


def emission(snapshot, color=(1, 1, 1), alpha=None):
    """Adds a material that emits `color`, mixed with Transparent by `alpha`; returns its index."""
    nodes = [{"type": "ShaderNodeEmission", "inputs": {"Color": (*color, 1), "Strength": 1.0}}]
    surface = (0, "Emission")
    if alpha is not None:
        nodes.append({"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1, 1, 1, 1)}})
        inputs = {
            "Fac": float(alpha),
            "Shader": ("LINK", 1, "BSDF"),
            "Shader_001": ("LINK", 0, "Emission"),
        }
        nodes.append({"type": "ShaderNodeMixShader", "inputs": inputs})
        surface = (2, "Shader")
    index = len(snapshot["materials"])
    snapshot["materials"].append({"name": f"Emission {index}", "nodes": nodes, "surface": surface})
    return index


def mesh(snapshot, points, faces, material=None, transforms=None, lifespan=(0.0, 1.0), **extra):
    """Adds a mesh and one instance of it.

    points: [V,3] or [K,V,3]; faces: list of vertex index lists; transforms: [K,4,4] world_from_object, default identity.
    """
    points = np.asarray(points, np.float32)
    if points.ndim == 2:
        points = points[None]
    index = len(snapshot["geometries"])
    snapshot["geometries"].append(
        {
            "name": f"mesh 'Mesh {index}'",
            "points": points,
            "face_sizes": np.array([len(f) for f in faces], np.int32),
            "corner_verts": np.array([v for f in faces for v in f], np.int32),
            **extra,
        }
    )
    instance(snapshot, index, material, transforms, lifespan)
    return index


def instance(snapshot, geometry, material=None, transforms=None, lifespan=(0.0, 1.0)):
    """Adds one; `lifespan`: when it exists, of the shutter."""
    transforms = np.eye(4)[None] if transforms is None else np.asarray(transforms, float)
    table = snapshot["instances"]
    table["name"].append(f"Object {len(table['name'])}")
    table["geometry"].append(geometry)
    table["knots"].append(len(transforms))
    table["world_from_object"].extend(transforms)
    table["slots"].append(1)
    table["materials"].append(-1 if material is None else material)
    table["lifespan"].append(lifespan)


def rectangle(x0, y0, x1, y1, z=1.0):
    return [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]


def quad(snapshot, points, material=None, **kwargs):
    return mesh(snapshot, points, [(0, 1, 2, 3)], material, **kwargs)


def disc(radius, center=(0, 0), z=1.0, sides=512):
    """A regular polygon of the disc's area: its outline is within radius * 2e-5 of the circle's for 512 sides."""
    angle = np.arange(sides) * 2 * np.pi / sides
    r = radius * np.sqrt(2 * np.pi / sides / np.sin(2 * np.pi / sides))
    x, y = center[0] + r * np.cos(angle), center[1] + r * np.sin(angle)
    return np.stack([x, y, np.full_like(x, z)], 1), [tuple(range(sides))]


def constant_world(snapshot, strength):
    """A white world that the film shows and that lights nothing."""
    snapshot["options"]["film_transparent"] = False
    inputs = {"Color": (1.0, 1.0, 1.0, 1.0), "Strength": float(strength)}
    snapshot["world"] = {
        "name": "World",
        "nodes": [{"type": "ShaderNodeBackground", "inputs": inputs}],
        "surface": (0, "Background"),
        "lights_scene": False,
    }


def half_world(snapshot):
    """A world that is 1 where x > 0 and 0 elsewhere, which the film shows."""
    snapshot["options"]["film_transparent"] = False
    greater = {"operation": "GREATER_THAN"}
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 0, "Generated")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 1, "X"), "Value_001": 0.0},
            "properties": greater,
        },
        {
            "type": "ShaderNodeBackground",
            "inputs": {"Color": ("LINK", 2, "Value"), "Strength": 1.0},
        },
    ]
    snapshot["world"] = {
        "name": "World",
        "nodes": nodes,
        "surface": (3, "Background"),
        "lights_scene": False,
    }


def link(node, output):
    """What a socket is linked to: an output of the node of that index."""
    return ("LINK", node, output)


def translation(x, y=0.0, z=0.0):
    m = np.eye(4)
    m[:3, 3] = (x, y, z)
    return m


def render(snapshot):
    import granita_core

    return granita_core.render(packed(snapshot))


def packed(snapshot):
    """As the native module takes it."""
    table = snapshot["instances"]
    arrays = {
        "name": table["name"],
        "geometry": np.array(table["geometry"], np.int32),
        "knots": np.array(table["knots"], np.int32),
        "world_from_object": np.array(table["world_from_object"], float).reshape(-1, 4, 4),
        "slots": np.array(table["slots"], np.int32),
        "materials": np.array(table["materials"], np.int32),
        "lifespan": np.array(table["lifespan"], np.float32).reshape(-1, 2),
    }
    if "key" in table:
        arrays["key"] = np.array(table["key"], np.uint32)
    if "flags" in table:
        arrays["flags"] = np.array(table["flags"], np.uint32)
    for name in ("receives", "blocks"):
        if name in table:
            arrays[name] = np.array([mask % 2**64 for mask in table[name]], np.uint64)
    for name in ("receiver_set", "blocker_set"):
        if name in table:
            arrays[name] = np.array(table[name], np.int32)
    if "receives_in_volumes" in table:
        arrays["receives_in_volumes"] = table["receives_in_volumes"]
    if "adjacent" in table:
        arrays["adjacent"] = table["adjacent"]
    return {**snapshot, "instances": arrays}


def alpha(snapshot):
    """The alpha channel, [h,w]."""
    return render(snapshot)["combined"][..., 3]


def busy(executor, lens=True, **options):
    """Moving, transparent, overlapping and lens-blurred things in perspective, 96 x 72 pixels.

    lens: False, True, or "moving".
    """
    random = np.random.default_rng(7)
    options = {"samples": 16, "pixel_filter": "MITCHELL", "filter_width": 4.0, **options}
    snapshot = perspective((96, 72), 90.0, executor=executor, **options)
    if lens:
        snapshot["camera"].update(lens_radius=0.02, focus_distance=4.0)
    if lens == "moving":
        snapshot["camera"]["lens_knots"] = np.array([(0.005, 6.0), (0.02, 4.0), (0.03, 2.5)])
    colors = [((1, 0.2, 0), None), ((0, 1, 0.3), 0.4), ((0.1, 0.2, 1), None)]
    materials = [emission(snapshot, c, a) for c, a in colors]
    for i in range(24):
        z = random.uniform(2, 8)
        center = random.uniform(-0.5, 0.5, 2) * z
        corners = center + random.uniform(-0.8, 0.8, (4, 2))
        points = np.concatenate([corners, z + random.uniform(-0.4, 0.4, (4, 1))], 1)
        motion = random.uniform(-0.3, 0.3, 3) if i % 2 else np.zeros(3)
        ends = [translation(*-motion), translation(*motion)]
        quad(snapshot, points, materials[i % 3], transforms=ends)
    return snapshot
