# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole pictures against Cycles' converged ones, bounces at 0: FLIP (Andersson et al. 2020) and mean luminance.

The limits are the project's promise, not sampling error: FLIP < .02, luminance within 1 %.  On failure the picture,
the reference and the FLIP map lie side by side in the folder that pytest names.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from pictures import flip, load, srgb  # noqa: E402

pytest.importorskip("flip_evaluator", reason="FLIP is installed by ./dev test")

# Reyes shades at vertices and interpolates: highlights and fine textures want finer micropolygons than
# 1 px.  Scene -> (samples, light samples for up to 64 of them, dicing rate).
SCENES = {
    "metal": (64, 32, 0.5),
    "object_alpha": (64, 32, 0.5),
    "creased": (64, 32, 0.5),
    # Lanterns of two pixels, ten times white, are discs of the lens: their edges want many samples.
    "demo": (256, 16, 0.5),
}
MOST_FLIP = 0.02


def luminance(x):
    return float((x @ [0.2126, 0.7152, 0.0722]).mean())


@pytest.mark.parametrize("name", SCENES)
def test_like_cycles(name, tmp_path):
    out = tmp_path / "picture.exr"
    script = ["--python", str(HERE / "scenes.py"), "--", name, "GRANITA", str(out)]
    command = [
        "blender",
        "-b",
        "--factory-startup",
        "--addons",
        "granita",
        "--python-exit-code",
        "1",
        *script,
    ]
    command += [str(setting) for setting in SCENES[name]]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-1000:]
    picture, reference = load(out), load(HERE / "references" / f"{name}.exr")
    difference, mean = flip(picture, reference)
    ratio = luminance(picture) / luminance(reference)
    np.save(
        tmp_path / "side_by_side.npy",
        np.concatenate([srgb(picture), srgb(reference), np.repeat(difference[..., :1], 3, 2)], 1),
    )
    print(f"{name}: FLIP {mean:.4f}, luminance ratio {ratio:.4f}")
    print("\n".join(line for line in done.stdout.splitlines() if not line.startswith("Fra:")))
    assert mean < MOST_FLIP
    assert abs(ratio - 1) < 0.01
