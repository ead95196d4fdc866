# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour spaces of images, as records of the snapshot.

Blender and Cycles convert by OpenColorIO, with the configuration that Blender has loaded: its own, of the file's working
space, or a studio's.  From 4.5 on Blender brings Python's module of it, which shares that configuration.  What it does to
colours is told apart here: a curve and a matrix, which most spaces are, or a cube.
"""

import importlib.machinery
import importlib.util
import sys
from functools import lru_cache
from pathlib import Path

import bpy
import numpy as np

from .blenders_color_spaces import blenders_color_space
from .working_space import scene_from_rec709

# The native side knows these by their names.
_PLAIN = {"LINEAR": "scene_linear", "SRGB": "sRGB", "DATA": "Non-Color"}
_DATA = {"is_data": True, "curve": "LINEAR"}
# What images are handed over as, whatever a configuration makes of these names.  Those that Blender cannot open (PNM) have no
# space; Cycles takes their numbers as they are.
_AS_THEY_ARE = {"scene_linear": {"curve": "LINEAR"}, "Non-Color": _DATA, "": _DATA}
# A curve is known at so many places, 0 and 1 among them.  Over a camera's 17 stops they are straight within 1e-6 between;
# files of floats reach beyond 0 and 1.
_PLACES, _LOW, _HIGH = 10241, -0.5, 2.0
_CUBE = 65
# Of what a curve and a matrix make of a colour, relative to its largest channel, in the mean.  Of a space that is these
# it is 1e-6 (7e-4 of ACEScc's, which OpenColorIO tabulates), of another .08 and more; a cube's is 1e-3.
_TOLERANCE = 1e-3
_DARK = 0.01
_LARGEST = 1e30


def in_color_spaces(images, report):
    """What the native side has to know of the colour spaces of images.

    Args:
        images: records, their `colorspace` by Blender's name.
        report: called with (datablock, message).

    Returns:
        (the images, `colorspace` by the native side's name; records of spaces that it does not know by name).
    """
    described = {name: _described(name) for name in {image["colorspace"] for image in images}}
    told, found = set(), []
    for image in images:
        complaint = described[image["colorspace"]][1]
        # Of a tile, or a picture of a sequence, the datablock's name is before the last slash.
        label = f"image '{image['name'].rpartition('/')[0] or image['name']}'"
        if complaint and label not in told:
            told.add(label)
            report(label, f"its colour space '{image['colorspace']}' {complaint}")
        found.append({**image, "colorspace": _native_name(image["colorspace"], described)})
    return found, [
        {"name": _native_name(name, described), **record}
        for name, (record, _) in sorted(described.items())
        if _plain_name(record) is None
    ]


def is_data(name):
    """Whether numbers of a colour space are no colours, so that alpha counts for nothing."""
    return "is_data" in _described(name)[0]


def _native_name(name, described):
    """No configuration's name is taken for a plain one."""
    return _plain_name(described[name][0]) or f"space {name}"


def _plain_name(record):
    if record.get("is_data"):
        return _PLAIN["DATA"]
    if record.keys() == {"curve"}:
        return _PLAIN.get(record["curve"])
    return None


def _described(name):
    """(record, what the artist is to be told of it or None)."""
    if name in _AS_THEY_ARE:
        return _AS_THEY_ARE[name], None
    config = _configuration()
    if config is not None and config.getColorSpace(name) is not None:
        return _of_configuration(name, _identity(config))
    found = blenders_color_space(name)
    unknown = None
    if found is None:
        unknown, found = "is read as sRGB", blenders_color_space("sRGB")
    curve, to_rec709 = found
    if curve == "DATA":
        return _DATA, unknown
    record = _table(curve(_places())) if callable(curve) else {"curve": curve}
    return {**record, **_matrix(scene_from_rec709() @ to_rec709)}, unknown


def _configuration():
    """Blender's, or None where there is no module to ask it by."""
    module = _open_color_io()
    try:
        return module and module.GetCurrentConfig()
    except Exception:  # there is none that it can read
        return None


def _identity(config):
    try:
        return config.getCacheID()
    except Exception as failure:  # a file of one of its spaces is missing
        return str(failure)


@lru_cache(maxsize=1)
def _open_color_io():
    name = "PyOpenColorIO"
    if name not in sys.modules:
        # Blender as a module of Python has it beside its own files, where Python does not look.
        version = f"python{sys.version_info.major}.{sys.version_info.minor}"
        beside = Path(bpy.utils.resource_path("LOCAL"), "python", "lib", version, "site-packages")
        spec = importlib.util.find_spec(name) or importlib.machinery.PathFinder.find_spec(
            name, [str(beside)]
        )
        if spec is None:
            return None
        try:
            sys.modules[name] = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(sys.modules[name])
        except Exception:  # of another build, say: Blender's own table has most of it
            del sys.modules[name]
            return None
    return sys.modules[name]


@lru_cache(maxsize=256)
def _of_configuration(name, _configuration_id):
    config = _configuration()
    if config.getColorSpace(name).isData():
        return _DATA, None
    try:
        processor = config.getProcessor(name, "scene_linear").getDefaultCPUProcessor()
    except Exception as failure:  # its own have no kind in common; a file is missing, say
        reason = " ".join(str(failure).split())
        return {"curve": "LINEAR"}, f"cannot be converted, and is read as scene-linear: {reason}"

    def convert(colors):
        found = np.array(colors, dtype=np.float32)
        processor.applyRGB(found)
        return np.clip(np.nan_to_num(found), -_LARGEST, _LARGEST)

    return _curve_and_matrix(convert) or _cube(convert), None


def _curve_and_matrix(convert):
    """The record of a space that is one curve for all channels, and then a matrix; None of another."""
    white = convert([[1, 1, 1]])[0].astype(np.float64)
    if np.max(np.abs(white)) < _DARK:
        return None
    brightest = int(np.argmax(np.abs(white)))

    def curve(places):
        grey = convert(np.repeat(places[:, None], 3, axis=1))
        return grey[:, brightest].astype(np.float64) / white[brightest]

    black = float(curve(np.zeros(1))[0])
    primaries = convert(np.eye(3)).astype(np.float64)
    matrix = ((primaries - black * white) / (1.0 - black)).T
    places = _places()
    numbers = curve(places)
    colors = np.random.default_rng(1).random((1000, 3))
    made = np.interp(colors, places, numbers) @ matrix.T
    asked = convert(colors)
    bright = np.maximum(np.abs(asked).max(axis=1, keepdims=True), _DARK)
    errors = np.abs(made - asked) / bright
    if np.mean(errors) > _TOLERANCE or np.quantile(errors, 0.99) > 10 * _TOLERANCE:
        return None
    far = np.array([-1.0, 0.18, 16.0, 1000.0])
    if np.allclose(curve(far), far, rtol=1e-4, atol=1e-6):
        return {"curve": "LINEAR", **_matrix(matrix)}
    # Of the scene's own primaries Cycles has its own, nothing below 0.
    near = (places >= 0) & (places <= 1) if not _matrix(matrix) else slice(None)
    if np.allclose(numbers[near], _linear_from_srgb(places[near]), rtol=0, atol=1e-4):
        return {"curve": "SRGB", **_matrix(matrix)}
    return {**_table(numbers), **_matrix(matrix)}


def _places():
    return np.linspace(_LOW, _HIGH, _PLACES)


def _table(numbers):
    return {"curve": "TABLE", "table": numbers.astype(np.float32), "low": _LOW, "high": _HIGH}


def _matrix(matrix):
    if np.allclose(matrix, np.eye(3), rtol=0, atol=1e-4):
        return {}
    return {"matrix": matrix.astype(np.float32)}


def _cube(convert):
    places = np.linspace(0, 1, _CUBE)
    blue, green, red = np.meshgrid(places, places, places, indexing="ij")
    cube = convert(np.stack([red, green, blue], axis=-1).reshape(-1, 3))
    return {"curve": "LINEAR", "cube": cube.reshape(_CUBE, _CUBE, _CUBE, 3)}


def _linear_from_srgb(x):
    return np.where(x < 0.04045, x / 12.92, ((np.abs(x) + 0.055) / 1.055) ** 2.4)
