# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's Denoise node takes from, or adds to, rooms lit by what bounces.

    ./dev bpy 4.5 bench/denoised.py [scene ...]

Scenes of bounced_scenes.py, 256 x 256, four bounces; RMSE against 256 samples and 256 light samples of Granita's own, as the
node comes behind the engine and its bias alone is asked for.  One line a scene and setting: without the node and with it.
"""

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "bench"), str(ROOT / "tests/images")]
import bounced_scenes  # noqa: E402
import engines  # noqa: E402

SETTINGS = ((16, 4), (16, 16), (64, 16))


def picture(scene, samples, light_samples, denoises):
    engines.set_granita(scene, samples, light_samples=light_samples)
    engines.set_bounces(scene, 4)
    scene.render.use_compositing = denoises
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.exr"
        engines.render(scene, path)
        image = bpy.data.images.load(str(path))
        image.colorspace_settings.name = "Non-Color"
        pixels = np.empty(len(image.pixels), dtype=np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
    return pixels.reshape(-1, 4)[:, :3]


def main():
    names = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    for name in names or ("still", "metal", "shining"):
        scene = bounced_scenes.SCENES[name]()
        scene.render.resolution_x = scene.render.resolution_y = 256
        scene.render.engine = "GRANITA"
        bpy.ops.scene.granita_denoise()
        truth = picture(scene, 256, 256, False)
        for samples, light_samples in SETTINGS:
            plain, denoised = (
                np.sqrt(np.mean((picture(scene, samples, light_samples, on) - truth) ** 2))
                for on in (False, True)
            )
            print(f"| {name} | {samples} | {light_samples} | {plain:.4f} | {denoised:.4f} |")


if __name__ == "__main__":
    main()
