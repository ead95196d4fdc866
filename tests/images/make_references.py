# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the references of tests/images with Cycles (about a quarter of an hour on two cores).

    python3 tests/images/make_references.py [SCENE ...]

Debian's Blender 3.4, no bounces, 4096 samples a pixel, Blackman-Harris 1.5, linear OpenEXR rewritten as 16-bit
half without compression: half's relative error of 5e-4 is far below the tolerances.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
SAMPLES = 4096
SCENES = ("metal", "object_alpha", "creased", "demo")


def main():
    (HERE / "references").mkdir(exist_ok=True)
    for name in sys.argv[1:] or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            raw = Path(folder) / "raw.exr"
            script = [
                "--python",
                str(HERE / "scenes.py"),
                "--",
                name,
                "CYCLES",
                str(raw),
                str(SAMPLES),
            ]
            done = subprocess.run(
                ["blender", "-b", "--factory-startup", "--python-exit-code", "1", *script],
                check=True,
                capture_output=True,
                text=True,
            )
            print(name, [line for line in done.stdout.splitlines() if line.startswith("seconds")])
            target = HERE / "references" / f"{name}.exr"
            subprocess.run(
                ["oiiotool", raw, "-d", "half", "--compression", "none", "-o", target], check=True
            )


if __name__ == "__main__":
    main()
