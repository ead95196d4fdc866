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
# A curve is known at so many places, 0 and 1 among them.  Over a camera's 17 stops they are straight within 1e-6 between;
# files of floats reach beyond 0 and 1.
_PLACES, _LOW, _HIGH = 10241, -0.5, 2.0
_CUBE = 65
# Of what a curve and a matrix make of a colour, relative to its largest channel, in the mean.  Of a space that is these
# it is 1e-6 (7e-4 of ACEScc's, which OpenColorIO tabulates), of another .08 and more; a cube's is 1e-3.
_TOLERANCE = 1e-3
_DARK = 0.01


def in_color_spaces(images, report):
    """What the native side has to know of the colour spaces of images.

    Args:
        images: records, their `colorspace` by Blender's name.
        report: called with (datablock, message).

    Returns:
        (the images, `colorspace` by the native side's name; records of spaces that it does not know by name).
    """
    known, records = {}, []
    for image in images:
        name = image["colorspace"]
        if name in known:
            continue
        record = _described(name)
        if record is None:
            label = f"image '{image['name']}'"
            report(label, f"its colour space '{name}' is read as sRGB")
            record = {"curve": "SRGB", **_matrix(scene_from_rec709())}
        known[name] = _plain_name(record)
        if known[name] is None:
            known[name] = name
            records.append({"name": name, **record})
    return [{**image, "colorspace": known[image["colorspace"]]} for image in images], records


def _plain_name(record):
    if record.get("is_data"):
        return _PLAIN["DATA"]
    if record.keys() == {"curve"}:
        return _PLAIN.get(record["curve"])
    return None


def _described(name):
    config = _configuration()
    if config is not None and config.getColorSpace(name) is not None:
        return _of_configuration(name, config.getCacheID())
    found = blenders_color_space(name)
    if found is None:
        return {"curve": "LINEAR"} if name == "scene_linear" else None
    curve, to_rec709 = found
    if curve == "DATA":
        return {"is_data": True, "curve": "LINEAR"}
    matrix = scene_from_rec709() @ to_rec709
    if callable(curve):
        return {**_table(curve(_places())), **_matrix(matrix)}
    return {"curve": curve, **_matrix(matrix)}


def _configuration():
    """Blender's, or None where there is no module to ask it by."""
    module = _open_color_io()
    return module and module.GetCurrentConfig()


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
        except ImportError:
            del sys.modules[name]
            return None
    return sys.modules[name]


@lru_cache(maxsize=256)
def _of_configuration(name, _configuration_id):
    module, config = _open_color_io(), _configuration()
    if config.getColorSpace(name).isData():
        return {"is_data": True, "curve": "LINEAR"}
    try:
        processor = config.getProcessor(name, "scene_linear").getDefaultCPUProcessor()
    except module.Exception:  # Cycles too takes them as they are then
        return {"curve": "LINEAR"}

    def convert(colors):
        found = np.array(colors, dtype=np.float32)
        processor.applyRGB(found)
        return found

    return _curve_and_matrix(convert) or _cube(convert)


def _curve_and_matrix(convert):
    """The record of a space that is one curve for all channels, and then a matrix; None of another."""
    white = convert([[1, 1, 1]])[0].astype(np.float64)
    if not np.all(np.isfinite(white)) or np.max(np.abs(white)) < _DARK:
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
    if not np.mean(np.abs(made - asked) / bright) <= _TOLERANCE:
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
    return {"curve": "LINEAR", "cube": np.nan_to_num(cube).reshape(_CUBE, _CUBE, _CUBE, 3)}


def _linear_from_srgb(x):
    return np.where(x < 0.04045, x / 12.92, ((np.abs(x) + 0.055) / 1.055) ** 2.4)
