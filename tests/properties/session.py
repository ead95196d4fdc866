# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a probe's scene with Cycles and with Granita: 32 by 32 pixels, no bounces, a seed of its own."""

import os
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import bpy
import compare
import exr
import scene_parts

SIZE = 32
SAMPLES = 16
ENGINES = ("CYCLES", "GRANITA")


@dataclass
class Outcome:
    """What one engine made of a scene."""

    picture: dict = None  # compare.signature; None where it failed
    warnings: frozenset = frozenset()  # of (datablock, message)
    error: str = ""


@dataclass
class Session:
    """Keeps a folder for pictures and listens to what Granita has to say."""

    folder: Path = field(default_factory=lambda: Path(tempfile.mkdtemp(prefix="granita-flips-")))
    _said: list = field(default_factory=list)

    def __post_init__(self):
        from granita import final_render

        self._final_render = final_render
        self._tell = tell = final_render.FinalRender._tell
        said = self._said

        def listen(render, warnings):
            said.extend((datablock, message) for datablock, message, _count in warnings)
            tell(render, warnings)

        final_render.FinalRender._tell = listen

    def close(self):
        self._final_render.FinalRender._tell = self._tell

    def build(self, probe):
        """An empty file with the probe in it.  Returns (scene, roots)."""
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        scene = bpy.context.scene
        set_up(scene)
        roots = probe.build(scene)
        return scene, roots

    def render(self, scene, engine, seed=0):
        """The Outcome of one engine."""
        scene.render.engine = engine
        scene.cycles.seed = scene.granita.seed = seed
        path = self.folder / f"{engine}.exr"
        if path.exists():
            path.unlink()
        scene.render.filepath = str(path)
        self._said.clear()
        try:
            bpy.ops.render.render(write_still=True, scene=scene.name)
        except RuntimeError as error:
            return Outcome(None, frozenset(self._said), str(error).strip())
        if not path.exists():
            return Outcome(None, frozenset(self._said), "no picture was written")
        picture = compare.signature(exr.read(str(path)))
        os.unlink(path)
        return Outcome(picture, frozenset(self._said))

    def seeds(self, build):
        """{engine: ([picture a seed], noise)} of what `build()` returns, made anew for each."""
        found = {}
        for engine in ENGINES:
            pictures = [self.render(build(), engine, seed).picture for seed in compare.SEEDS]
            whole = all(picture is not None for picture in pictures)
            found[engine] = pictures, compare.noise(pictures) if whole else 0.0
        return found


def set_up(scene):
    """Both engines alike: box filter, direct light, every light sampled."""
    render, cycles, granita = scene.render, scene.cycles, scene.granita
    scene_parts.multilayer_exr(scene)
    render.resolution_x = render.resolution_y = SIZE
    render.threads_mode, render.threads = "FIXED", 2
    cycles.samples = granita.samples = SAMPLES
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 0
    cycles.transmission_bounces = cycles.volume_bounces = 0
    cycles.pixel_filter_type = granita.pixel_filter = "BOX"
    granita.filter_width, granita.bounces = 1.0, "NONE"
    cycles.blur_glossy = cycles.light_sampling_threshold = 0.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    granita.light_samples = 16
    granita.dicing_rate = 0.5
    granita.device = "CPU"
