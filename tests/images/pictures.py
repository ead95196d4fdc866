# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as arrays, f32 [h,w,3], linear, top row first, and how unlike two of them are."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "blender"))
import exr  # noqa: E402


def load(path):
    """The RGB of an OpenEXR file as exr.py reads it."""
    channels = exr.read(path)
    pick = lambda letter: next(v for k, v in channels.items() if k.split(".")[-1] == letter)  # noqa: E731
    return np.stack([pick(c) for c in "RGB"], -1)[::-1].astype(np.float32)


def srgb(linear):
    """As a screen shows it, 0 to 1."""
    x = np.clip(linear, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055).astype(np.float32)


def flip(picture, truth):
    """(map [h,w,c], mean) of FLIP (Andersson et al. 2020), 0 to 1."""
    import flip_evaluator

    return flip_evaluator.evaluate(srgb(truth), srgb(picture), "LDR", applyMagma=False)[:2]
