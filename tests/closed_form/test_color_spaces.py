# SPDX-License-Identifier: GPL-3.0-or-later
"""Images in described colour spaces, and colours of a working space, as the snapshot says."""

import numpy as np
import pytest
import snapshots as s

import granita_core

BYTES = (200, 100, 50, 255)
CURVE = np.linspace(0.0, 2.0, 257) ** 2
SWAPS = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])


def shown(colorspace, spaces, output="Color", **record):
    """What a picture of an even image is, and what is said of it."""
    snapshot = s.orthographic((16, 16), samples=1)
    snapshot["color_spaces"] = spaces
    texels = np.tile(np.array(BYTES, dtype=np.uint8), (4, 4, 1))
    snapshot["images"] = [{"name": "I", "bytes": texels, "colorspace": colorspace}]
    snapshot.update(record)
    nodes = [
        {"type": "ShaderNodeTexImage", "properties": {"image": "I"}, "inputs": {}},
        {"type": "ShaderNodeRGBToBW", "inputs": {"Color": ("LINK", 0, "Color")}},
    ]
    source = ("LINK", 0, "Color") if output == "Color" else ("LINK", 1, "Val")
    nodes.append({"type": "ShaderNodeEmission", "inputs": {"Color": source, "Strength": 1.0}})
    for node in nodes:
        node["name"] = node["type"]
        node.setdefault("properties", {})
    snapshot["materials"].append(
        {"name": "M", "index": 0, "nodes": nodes, "surface": (2, "Emission")}
    )
    s.quad(snapshot, s.rectangle(-16, -16, 32, 32), len(snapshot["materials"]) - 1)
    return s.render(snapshot)["combined"][8, 8, :3]


def linear(x):
    """IEC 61966-2-1"""
    return ((x + 0.055) / 1.055) ** 2.4


COLOR = np.array(BYTES[:3]) / 255
TABLE = {"name": "Q", "curve": "TABLE", "table": CURVE.astype(np.float32), "low": 0.0, "high": 2.0}
CUBE = np.stack(np.meshgrid(*[[0.0, 1.0]] * 3, indexing="ij"), axis=-1)  # [b][g][r]: reversed


@pytest.mark.parametrize(
    "space, expected",
    [
        ({"name": "Q", "curve": "SRGB"}, linear(COLOR)),
        ({"name": "Q", "curve": "SRGB", "matrix": SWAPS.astype(np.float32)}, linear(COLOR[::-1])),
        (TABLE, COLOR**2),
        ({**TABLE, "matrix": SWAPS.astype(np.float32)}, COLOR[::-1] ** 2),
        ({"name": "Q", "is_data": True}, COLOR),
        ({"name": "Q", "cube": CUBE.astype(np.float32)}, COLOR[::-1]),
    ],
    ids=["sRGB", "primaries", "table", "table and primaries", "data", "cube"],
)
def test_an_image_is_what_its_space_says(space, expected):
    # Half floats, and a table's places.
    assert shown("Q", [space]) == pytest.approx(expected, rel=1e-3)


def test_a_number_of_a_color_is_its_luminance_in_the_working_space():
    weights = np.array([0.1, 0.2, 0.7])
    seen = shown("scene_linear", [], "Val", working_space={"luminance": weights.astype(np.float32)})
    assert seen == pytest.approx(np.full(3, weights @ COLOR), rel=1e-5)


@pytest.mark.parametrize(
    "space, message",
    [
        ({"name": "Other"}, "image 'I'.*'Q' is not described"),
        ({"name": "Q", "curve": "BENT"}, "colour space 'Q'.*'BENT'"),
        ({**TABLE, "table": np.ones(1, np.float32)}, "colour space 'Q'.*two places"),
        ({**TABLE, "high": 0.0}, "colour space 'Q'.*two places"),
        ({**TABLE, "table": np.full(9, np.nan, np.float32)}, "colour space 'Q'.*not finite"),
        ({"name": "Q", "cube": np.zeros((2, 3, 2, 3), np.float32)}, "colour space 'Q'.*edge"),
        ({"name": "Q", "cube": np.zeros((1, 1, 1, 3), np.float32)}, "colour space 'Q'.*edge"),
    ],
)
def test_a_space_that_is_none_is_refused_by_name(space, message):
    with pytest.raises(granita_core.SceneError, match=message):
        shown("Q", [space])
