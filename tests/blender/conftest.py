# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the tests that run inside Blender (run_in_blender.py)."""

import signal

import bpy
import exr
import film_parts
import pytest
import scene_parts


@pytest.fixture
def scene():
    """An empty scene of factory settings, 64 by 48 pixels, rendered by Granita without bounces."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "GRANITA"
    scene.render.resolution_x = 64
    scene.render.resolution_y = 48
    scene.granita.samples = 4
    scene.granita.device = "CPU"
    scene.granita.bounces = "NONE"
    yield scene
    # A scene left to the engine would keep its class from being unregistered.
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)


@pytest.fixture
def film(scene):
    return film_parts.film_of_pixels(scene)


@pytest.fixture
def render(tmp_path):
    """render(scene) -> {"Layer.Pass.Channel": float32 [height, width], lower-left first}.

    The way of F12 and a saved file: Blender's own result, through a multilayer OpenEXR file.
    """

    def render_to_arrays(scene, name="frame"):
        scene_parts.multilayer_exr(scene)
        scene.render.filepath = str(tmp_path / f"{name}.exr")
        bpy.ops.render.render(write_still=True, scene=scene.name)
        return exr.read(scene.render.filepath)

    return render_to_arrays


@pytest.fixture
def blend(scene, tmp_path):
    """A saved file: a camera above an emissive square, float output."""
    scene_parts.add_camera(scene, ortho_scale=4.0)
    scene_parts.add_square(scene, material=scene_parts.emission("Glow", (0.25, 0.5, 0.75)))
    scene_parts.multilayer_exr(scene)
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


@pytest.fixture
def impatient():
    """A test that waits for what never comes fails."""
    waited = []

    def gives_up(*_):
        waited.append(True)
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, gives_up)
    signal.alarm(20)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)
    assert not waited
