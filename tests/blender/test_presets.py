# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the Sampling panel: what Granita brings, and what the artist adds and removes."""

from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest
from test_settings import DEFAULTS

from granita.ui import sampling_presets
from granita.ui.render_panels import GRANITA_RENDER_PT_sampling
from granita.ui.sampling_presets import GRANITA_OT_sampling_preset_add as Add
from granita.ui.sampling_presets import GRANITA_RENDER_PT_sampling_presets as Menu

COARSE = {"shading_threshold": 0.1}
PREVIEW = {"samples": 8, "preview_samples": 16, "light_samples": 4, "dicing_rate": 2.0, **COARSE}
DRAFT = {"samples": 4, "preview_samples": 8, "light_samples": 2, "dicing_rate": 4.0, **COARSE}
NAMES = [value.removeprefix("settings.") for value in Add.preset_values]


@pytest.fixture
def settings():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.context.scene.render.engine = "GRANITA"
    return bpy.context.scene.granita


@pytest.fixture
def own_folder(tmp_path, monkeypatch):
    """Where this Blender keeps the artist's presets, for one test."""
    monkeypatch.setattr(bpy.utils, "user_resource", lambda *_, path, **__: str(tmp_path))
    monkeypatch.setattr(bpy.utils, "preset_paths", lambda _: [str(tmp_path)])
    return tmp_path


class Layout:
    """Stands for Blender's layout, which exists in a window alone: keeps the operators that are drawn."""

    def __init__(self):
        self.drawn, self.popovers = [], []

    def operator(self, name, text="", **_):
        self.drawn.append(SimpleNamespace(operator=name, text=text, remove_name=False))
        return self.drawn[-1]

    def popover(self, panel, **_):
        self.popovers.append(panel)

    def __getattr__(self, name):  # column(), row(), prop(), ...
        return lambda *_, **__: self


def drawn():
    """{name: what executes it} of the menu, and the names that have a button that removes them."""
    layout = Layout()
    screen = SimpleNamespace(layout=layout, bl_idname=Menu.__name__)
    screen.path_menu = lambda *args, **named: Menu.path_menu(screen, *args, **named)
    Menu.draw(screen, bpy.context)
    chosen = {item.text: item for item in layout.drawn if item.operator == "script.execute_preset"}
    removable = {item.name for item in layout.drawn if item.remove_name}
    return chosen, removable


def choose(name):
    item = drawn()[0][name]
    bpy.ops.script.execute_preset(filepath=item.filepath, menu_idname=item.menu_idname)


def presets(folder):
    """{file name: text}; Python may keep compiled ones beside them."""
    return {file.name: file.read_text() for file in Path(folder).glob("*.py")}


def values(settings):
    return {name: getattr(settings, name) for name in NAMES}


def approximately(expected):
    """Floats of settings are of single precision."""
    return {
        name: pytest.approx(value) if isinstance(value, float) else value
        for name, value in expected.items()
    }


def test_the_sampling_panel_opens_the_menu():
    layout = Layout()
    GRANITA_RENDER_PT_sampling.draw_header_preset(SimpleNamespace(layout=layout), bpy.context)
    assert layout.popovers == [Menu.__name__]
    assert Menu.is_registered and Menu.bl_region_type == "HEADER"
    assert Menu.poll(SimpleNamespace(engine="GRANITA"))
    assert not Menu.poll(SimpleNamespace(engine="CYCLES"))


@pytest.mark.smoke
def test_preview_and_final_set_what_they_say(settings, own_folder):
    final = {name: DEFAULTS[name] for name in NAMES}
    assert {"Draft", "Final", "Preview"} == drawn()[0].keys()
    settings.sampling, settings.time_samples, settings.shading_rate = "REGULAR", 3, 2.0
    settings.motion_factor = settings.focus_factor = 2.0
    settings.seed = 5
    choose("Preview")
    assert values(settings) == approximately({**final, **PREVIEW})
    choose("Draft")
    assert values(settings) == approximately({**final, **DRAFT})
    choose("Final")
    assert values(settings) == approximately(final)
    assert settings.seed == 5


def test_what_the_artist_adds_is_in_the_menu_until_it_is_removed(settings, own_folder):
    settings.samples, settings.sampling, settings.dicing_rate = 21, "INTERLEAVED", 0.5
    mine = values(settings)
    add = bpy.ops.render.granita_sampling_preset_add
    assert add(name="my own") == {"FINISHED"}
    assert presets(own_folder).keys() == {"my_own.py"}
    chosen, removable = drawn()
    assert chosen.keys() == {"Draft", "Final", "Preview", "my own"} and "my own" in removable
    choose("Final")
    choose("my own")
    assert values(settings) == mine
    assert add(name="my own", remove_name=True) == {"FINISHED"}
    assert presets(own_folder) == {}


@pytest.mark.parametrize("remove", [False, True])
def test_what_comes_with_granita_stays(settings, own_folder, remove):
    shipped = presets(sampling_presets.SHIPPED)
    add = bpy.ops.render.granita_sampling_preset_add
    assert add(name="Preview", remove_name=remove) == {"CANCELLED"}
    assert presets(own_folder) == {}
    assert presets(sampling_presets.SHIPPED) == shipped
