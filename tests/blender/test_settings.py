# SPDX-License-Identifier: GPL-3.0-or-later
"""scene.granita's names and numbers are API; panels are those of Granita and of common data."""

import inspect
import sys
from functools import partial
from types import SimpleNamespace

import bpy
import pytest

DEFAULTS = {
    "device": "AUTO",
    "samples": 64,
    "preview_samples": 64,
    "preview_moving": "AUTO",
    "preview_pause": False,
    "noise_threshold": 0.0,
    "min_samples": 16,
    "sampling": "INDEPENDENT",
    "time_samples": 0,
    "pixel_filter": "BLACKMAN_HARRIS",
    "filter_width": 1.5,
    "dicing_rate": 1.0,
    "shading_rate": 0.0,
    "motion_factor": 1.0,
    "focus_factor": 1.0,
    "grid_size": 256,
    "bucket_size": 64,
    "z_batch_size": 26,
    "opacity_threshold": 0.996,
    "motion_steps": 17,
    "seed": 0,
    "animate_seed": False,
    "light_samples": 16,
    "shading_threshold": 0.06,
    "film_exposure": 1.0,
    "bounces": "FULL",
}

NUMBERS = {
    "device": ["AUTO", "CPU", "GPU"],
    "sampling": ["INDEPENDENT", "INTERLEAVED", "REGULAR"],
    "bounces": ["NONE", "FAST", "FULL"],
    "pixel_filter": [
        "BOX",
        "TENT",
        "GAUSSIAN",
        "BLACKMAN_HARRIS",
        "MITCHELL",
        "CATMULL_ROM",
        "LANCZOS",
        "BSPLINE",
    ],
}


def own_properties():
    return bpy.context.scene.granita.bl_rna.properties


def test_defaults():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    settings = bpy.context.scene.granita
    found = {p.identifier for p in own_properties()} - {"rna_type", "name"}
    assert found == DEFAULTS.keys()
    for name, value in DEFAULTS.items():
        assert getattr(settings, name) == pytest.approx(value), name


def test_enumerations_keep_their_numbers():
    for name, identifiers in NUMBERS.items():
        items = own_properties()[name].enum_items
        assert [(i.identifier, i.value) for i in items] == list(
            zip(identifiers, range(len(identifiers)), strict=True)
        )


def test_every_setting_explains_itself():
    for p in own_properties():
        if p.identifier in DEFAULTS:
            assert len(p.description) > 10, p.identifier


SERVED = [
    "RENDER_PT_format",
    "RENDER_PT_color_management",
    "DATA_PT_lens",
    "DATA_PT_camera",
    "DATA_PT_camera_dof",
    "DATA_PT_camera_dof_aperture",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_mist",
    "EEVEE_WORLD_PT_surface",
    "MATERIAL_PT_preview",
    "OBJECT_PT_custom_props",
    "OBJECT_PT_visibility",
    "RENDER_PT_freestyle",
    "VIEWLAYER_PT_layer",
]


def below(cls):
    for sub in cls.__subclasses__():
        yield sub
        yield from below(sub)


def served():
    return {
        panel.__name__
        for panel in below(bpy.types.Panel)
        if "GRANITA" in getattr(panel, "COMPAT_ENGINES", ())
    }


class Layout:
    """Stands for Blender's layout, which exists in a window alone: notes what is drawn."""

    def __init__(self, drawn):
        self.drawn = drawn

    def prop(self, owner, name, **_):
        assert name in owner.bl_rna.properties
        self.drawn.add(name)

    def __getattr__(self, name):  # column(), row(), label(), ...
        return lambda *_, **__: self


class Drawn:
    """Stands for a panel on the screen."""

    def __init__(self, panel, layout):
        self.panel, self.layout = panel, layout

    def __getattr__(self, name):
        found = getattr(self.panel, name)
        own = inspect.getattr_static(self.panel, name)
        return partial(found, self) if inspect.isfunction(own) else found


def drawn(**context):
    """Names of all properties that Granita's own panels show."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    nothing = dict.fromkeys(("light", "material", "object", "world"))
    context = {**nothing, **context}
    own = SimpleNamespace(
        bl_rna=sys.modules["granita.viewport.shading_settings"].GranitaViewSettings.bl_rna,
        use_time=True,
        render_pass="AOV",
        aov_name="",
    )
    space = SimpleNamespace(shading=SimpleNamespace(type="RENDERED", granita=own))
    context |= {"space_data": space, "area": SimpleNamespace(regions=())}
    context = SimpleNamespace(engine="GRANITA", scene=scene, view_layer=layer, **context)
    names = set()
    for panel in below(bpy.types.Panel):
        if panel.__module__.startswith("granita.") and hasattr(panel, "draw"):
            if not hasattr(panel, "poll") or panel.poll(context):
                panel.draw(Drawn(panel, Layout(names)), context)
    return names


def test_all_that_is_read_is_shown():
    """What no panel shows could be set in Cycles alone."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    scene = bpy.context.scene
    scene.granita.sampling = "REGULAR"
    of_views = {"render_pass", "use_time", "time", "use_paths"}
    assert drawn() >= DEFAULTS.keys() | {"pass_alpha_threshold"} | of_views
    scene.granita.sampling = "INDEPENDENT"
    assert "z_batch_size" in drawn()

    cube, light = bpy.data.objects["Cube"], bpy.data.objects["Light"]
    assert drawn(object=cube) >= {"visible_camera", "visible_shadow"}
    assert drawn(object=light) >= {"visible_camera", "visible_diffuse", "visible_glossy"}
    assert drawn(world=scene.world) >= {"camera", "diffuse", "glossy"}
    assert "pass_index" in drawn(material=cube.active_material)


@pytest.mark.skipif(
    "light_linking" not in bpy.types.Object.bl_rna.properties,
    reason="lights of this Blender cannot be linked",
)
def test_linking_of_lights_is_shown_once():
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    stock = hasattr(bpy.types, "OBJECT_PT_light_linking")
    assert not stock or "OBJECT_PT_shading" in served()  # their parent; they serve all engines
    light = SimpleNamespace(engine="GRANITA", object=bpy.data.objects["Light"])
    for name in ("GRANITA_OBJECT_PT_light_linking", "GRANITA_OBJECT_PT_shadow_linking"):
        assert getattr(bpy.types, name).poll(light) is not stock


def test_a_view_layer_shows_its_filters_and_overrides():
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    shown = {
        "use_sky",
        "use_solid",
        "use_strand",
        "use_motion_blur",
        "material_override",
        "samples",
    }
    shown |= {"world_override"} & set(bpy.types.ViewLayer.bl_rna.properties.keys())
    assert drawn() >= shown


def test_all_passes_are_shown_and_those_not_made_are_greyed():
    from granita import passes
    from granita.ui import pass_panels

    bpy.ops.wm.read_homefile(use_factory_startup=True)
    names = drawn()
    assert names >= passes.SERVED - {None}
    assert names >= {"use_pass_ambient_occlusion", "use_pass_glossy_indirect"}
    assert "use_pass_cryptomatte_object" in names
    row = SimpleNamespace(prop=lambda *_, **__: None)
    column = SimpleNamespace(row=lambda: row)
    layer = bpy.context.view_layer
    for name, made in (("use_pass_emit", True), ("use_pass_ambient_occlusion", False)):
        pass_panels._PassPanel().show(column, layer, name, "")
        assert row.active is made


@pytest.mark.parametrize("kind", ["POINT", "SUN", "SPOT", "AREA"])
def test_a_light_shows_what_is_read_of_it(kind):
    lamp = bpy.data.lights.new("lamp", kind)
    own = {
        "POINT": {"shadow_soft_size"},
        "SUN": {"angle"},
        "SPOT": {"shadow_soft_size", "spot_size", "spot_blend"},
        "AREA": {"shape", "size", "spread"},
    }
    since = {"exposure", "normalize", "use_temperature"} & set(lamp.bl_rna.properties.keys())
    shown = drawn(light=lamp)
    assert shown >= own[kind] | since | {"type", "color", "energy", "use_nodes"}
    assert shown & {"cast_shadow", "use_shadow"}
    # EEVEE's alone: refused at the render.
    assert not shown & {"diffuse_factor", "specular_factor", "volume_factor"}


@pytest.mark.parametrize("kind", ["MESH", "LIGHT"])
def test_an_object_shows_what_sees_it_and_whether_it_is_of_the_plate(kind):
    data = bpy.data.meshes.new("Thing") if kind == "MESH" else bpy.data.lights.new("Thing", "SUN")
    shown = drawn(object=bpy.data.objects.new("Thing", data))
    assert shown >= {"is_shadow_catcher", "visible_diffuse", "visible_glossy", "visible_camera"}


def test_stock_panels_come_and_go():
    granita = sys.modules["granita"]
    names = served()
    assert names >= set(SERVED)
    # EEVEE's own knobs mean nothing here.
    assert not {name for name in names if name.startswith("RENDER_PT_eevee")}
    assert not names & {"DATA_PT_EEVEE_light", "RENDER_PT_output_views"}
    granita.unregister()
    try:
        stock = {name for name in served() if not name.startswith("GRANITA")}
        assert stock == set()
        assert not hasattr(bpy.types.Scene, "granita")
    finally:
        granita.register()
    assert served() == names
