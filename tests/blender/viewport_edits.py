# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside a Blender with a window: random edits under Rendered shading, each as a script, an operator or a key would
make it, with steps of undo; then a last picture beside one of a view that has seen nothing of it.

    blender --factory-startup --addons granita --python viewport_edits.py -- JOB.json

job: {"seed", "edits", "log"}.  Used by a test, and at length by bench/viewport_robustness.py.
"""

import json
import random
import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from heap import heap_bytes  # noqa: E402

JOB = json.loads(Path(sys.argv[sys.argv.index("--") + 1]).read_text())
LOG = open(JOB["log"], "a", buffering=1)
CHANCE = random.Random(JOB["seed"])


def note(**entry):
    LOG.write(json.dumps(entry) + "\n")


def loop():
    return sys.modules["granita.viewport.loop"]


def window():
    return bpy.context.window_manager.windows[0]


def area():
    return next(a for a in window().screen.areas if a.type == "VIEW_3D")


def region():
    return next(r for r in area().regions if r.type == "WINDOW")


def context():
    return bpy.context.temp_override(
        window=window(), screen=window().screen, area=area(), region=region()
    )


# ---- edits ----------------------------------------------------------------------------------


def meshes():
    return [t for t in bpy.context.scene.objects if t.type == "MESH"]


def any_mesh():
    found = meshes()
    return CHANCE.choice(found) if found else None


def activate(thing):
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)


def object_mode():
    with context():
        if bpy.context.object is not None and bpy.context.object.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")


def add():
    object_mode()
    make = CHANCE.choice(("cube_add", "uv_sphere_add", "monkey_add", "torus_add"))
    place = [CHANCE.uniform(-2, 2) for _ in range(3)]
    with context():
        getattr(bpy.ops.mesh, f"primitive_{make}")(location=place)


def delete():
    object_mode()
    thing = any_mesh()
    if thing is not None and len(meshes()) > 1:
        bpy.data.objects.remove(thing)


def hide():
    thing = any_mesh()
    if thing is not None and thing.name in bpy.context.view_layer.objects:
        CHANCE.choice(
            (
                lambda: thing.hide_set(not thing.hide_get()),
                lambda: setattr(thing, "hide_viewport", not thing.hide_viewport),
                lambda: setattr(thing, "hide_render", not thing.hide_render),
            )
        )()


def move():
    thing = any_mesh()
    if thing is not None:
        thing.location[CHANCE.randrange(3)] += CHANCE.uniform(-1, 1)


def key():
    thing = any_mesh()
    if thing is not None:
        thing.keyframe_insert("location", frame=CHANCE.randint(1, 10))


def edit_mode():
    thing = any_mesh()
    if thing is None or thing.hide_get() or thing.hide_viewport:
        return
    object_mode()
    with context():
        activate(thing)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.resize(value=(CHANCE.uniform(0.7, 1.4),) * 3)
        if CHANCE.random() < 0.6:
            bpy.ops.object.mode_set(mode="OBJECT")


def modifier():
    thing = any_mesh()
    if thing is None or thing.mode == "EDIT":
        return
    if len(thing.modifiers) > 1:
        thing.modifiers.remove(thing.modifiers[0])
    made = thing.modifiers.new("Modifier", CHANCE.choice(("SUBSURF", "ARRAY", "BEVEL", "WAVE")))
    if made is not None and made.type == "SUBSURF":
        made.levels = CHANCE.randint(0, 2)


def undo():
    with context():
        if bpy.ops.ed.undo.poll():
            bpy.ops.ed.undo()


def redo():
    with context():
        if bpy.ops.ed.redo.poll():
            bpy.ops.ed.redo()


def shading():
    area().spaces.active.shading.type = CHANCE.choice(("SOLID", "WIREFRAME", "RENDERED"))


def engine():
    bpy.context.scene.render.engine = "BLENDER_WORKBENCH"


def quad():
    with context():
        bpy.ops.screen.region_quadview()


def view():
    from mathutils import Quaternion

    data = area().spaces.active.region_3d
    data.view_perspective = CHANCE.choice(("CAMERA", "PERSP", "ORTHO"))
    if data.view_perspective != "CAMERA":
        data.view_rotation = Quaternion((CHANCE.gauss(0, 1) for _ in range(4))).normalized()


def zoom():
    data = area().spaces.active.region_3d
    data.view_camera_zoom = CHANCE.uniform(-20, 80)
    data.view_camera_offset = CHANCE.uniform(-0.3, 0.3), CHANCE.uniform(-0.3, 0.3)


def frame():
    bpy.context.scene.frame_set(CHANCE.randint(1, 10))


def shutter():
    render = bpy.context.scene.render
    render.use_motion_blur = CHANCE.random() < 0.8
    render.motion_blur_shutter = CHANCE.uniform(0, 2)


def lens():
    camera = bpy.context.scene.camera
    if camera is not None:
        camera.data.dof.use_dof = CHANCE.random() < 0.7
        camera.data.dof.aperture_fstop = CHANCE.uniform(0.05, 3)
        camera.data.lens = CHANCE.uniform(20, 80)


def film():
    render = bpy.context.scene.render
    render.film_transparent = CHANCE.random() < 0.5
    render.use_border = CHANCE.random() < 0.4
    render.border_min_x, render.border_max_x = CHANCE.uniform(0, 0.5), CHANCE.uniform(0.5, 1)


def lamp():
    for thing in bpy.context.scene.objects:
        if thing.type == "LIGHT":
            thing.data.energy *= CHANCE.uniform(0.6, 1.6)
            thing.data.type = CHANCE.choice(("POINT", "SUN", "AREA"))


def material():
    thing = any_mesh()
    if thing is None or thing.mode == "EDIT":
        return
    made = bpy.data.materials.new("Material")
    made.use_nodes = CHANCE.random() < 0.9
    if made.node_tree is not None:
        for node in made.node_tree.nodes:
            if node.type == "BSDF_PRINCIPLED":
                node.inputs["Base Color"].default_value = [CHANCE.random() for _ in range(4)]
                node.inputs["Alpha"].default_value = CHANCE.choice((1.0, 1.0, 0.5))
    thing.data.materials.clear()
    thing.data.materials.append(made)


def collection():
    child = bpy.data.collections.new("Group")
    bpy.context.scene.collection.children.link(child)
    thing = any_mesh()
    if thing is not None:
        child.objects.link(thing)
    layer = bpy.context.view_layer.layer_collection.children[-1]
    layer.exclude = CHANCE.random() < 0.3


def scene():
    made = bpy.data.scenes.new("Other") if len(bpy.data.scenes) == 1 else None
    if made is not None:
        made.render.engine = "GRANITA"
    window().scene = CHANCE.choice(list(bpy.data.scenes))


def no_camera():
    things = bpy.context.scene
    if things.camera is not None and CHANCE.random() < 0.5:
        bpy.data.objects.remove(things.camera)
    else:
        data = bpy.data.cameras.new("Camera")
        things.camera = bpy.data.objects.new("Camera", data)
        things.camera.location, things.camera.rotation_euler = (7, -7, 5), (1.1, 0, 0.8)
        things.collection.objects.link(things.camera)


def look():
    """Another pass, one time of the shutter, paths over the picture."""
    shown = area().spaces.active.shading.granita
    shown.render_pass = CHANCE.choice(("COMBINED", "NORMAL", "DIFFUSE_DIRECT", "MIST"))
    shown.use_time, shown.time = CHANCE.random() < 0.5, CHANCE.random()
    shown.use_paths = CHANCE.random() < 0.5
    area().tag_redraw()


def local_view():
    object_mode()
    thing = any_mesh()
    if thing is not None and thing.visible_get():
        activate(thing)
    with context():
        bpy.ops.view3d.localview(frame_selected=False)


def bounces():
    settings = bpy.context.scene.granita
    settings.bounces = CHANCE.choice(("NONE", "FAST", "FULL"))


def smoke():
    """Something is filled, or the world."""
    thing = any_mesh()
    tree = None
    if CHANCE.random() < 0.3 and bpy.context.scene.world is not None:
        bpy.context.scene.world.use_nodes = True
        tree = bpy.context.scene.world.node_tree
    elif thing is not None and thing.active_material is not None:
        tree = thing.active_material.node_tree
    output = tree and next((n for n in tree.nodes if n.type.startswith("OUTPUT")), None)
    if output:
        node = tree.nodes.new("ShaderNodeVolumePrincipled")
        node.inputs["Density"].default_value = CHANCE.choice((0.05, 0.5))
        tree.links.new(node.outputs[0], output.inputs["Volume"])


def preview():
    if len(bpy.data.materials):
        CHANCE.choice(list(bpy.data.materials)).asset_generate_preview()


def compare():
    with context():
        for name in ("keep_picture", "compare_pictures"):
            operator = getattr(bpy.ops.view3d, f"granita_{name}")
            if operator.poll():
                operator()


def f12():
    with context():
        bpy.ops.render.render("INVOKE_DEFAULT")


def play():
    with context():
        bpy.ops.screen.animation_play()


def revert():
    file = Path(JOB["log"]).with_suffix(".blend")
    object_mode()
    bpy.ops.wm.save_as_mainfile(filepath=str(file), copy=False)
    bpy.ops.wm.open_mainfile(filepath=str(file))


def again():
    """The add-on goes and comes back."""
    import addon_utils

    for each in bpy.data.scenes:
        each.render.engine = "BLENDER_WORKBENCH"
    addon_utils.disable("granita")
    addon_utils.enable("granita")


EDITS = {
    **dict.fromkeys((add, move, key, hide, modifier, material, frame, undo, redo, shutter), 4),
    **dict.fromkeys((delete, edit_mode, view, zoom, lens, film, lamp, collection), 3),
    **dict.fromkeys((shading, engine, quad, scene, no_camera, f12, play, local_view), 1),
    **dict.fromkeys((bounces, smoke, preview, compare), 1),
    look: 3,
    **dict.fromkeys((revert, again), JOB.get("heavy", 1)),
}
_SCENE_STAYS = {undo, redo, quad, view, zoom, shading, f12, play, revert, again}
_SCENE_STAYS |= {look, local_view, preview, compare}


def note_failures():
    """What views say that they cannot show."""
    live_view = sys.modules["granita.viewport.live_view"].LiveView
    if hasattr(live_view.fail, "noted"):
        return
    fail = live_view.fail

    def fail_noted(self, text):
        note(failed=text)
        fail(self, text)

    fail_noted.noted = True
    live_view.fail = fail_noted


def ready():
    """Rendered shading under Granita, whatever an edit has made of it."""
    note_failures()
    current = bpy.context.scene
    if current.render.engine != "GRANITA":
        current.render.engine = "GRANITA"
    current.granita.preview_samples = current.granita.samples = 4
    current.granita.light_samples = 4
    current.granita.shading_threshold = 1000.0
    current.render.resolution_x, current.render.resolution_y = 160, 90
    area().spaces.active.shading.type = "RENDERED"


def still_busy():
    views = loop().views()
    return bpy.app.is_job_running("RENDER") or not all(v.is_settled for v in views)


def steps():
    bpy.context.preferences.view.render_display_type = "NONE"
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.filepaths.use_scripts_auto_execute = True
    ready()
    yield 0.3
    names = list(EDITS)
    for number in range(JOB["edits"]):
        edit = CHANCE.choices(names, weights=EDITS.values())[0]
        note(number=number, edit=edit.__name__)
        if bpy.app.is_job_running("RENDER") and edit in {undo, redo, revert, again, scene}:
            continue  # Blender locks what these would pull from under the render
        try:
            edit()
        except (RuntimeError, TypeError, AttributeError, ReferenceError, ValueError) as error:
            note(refused=str(error).splitlines()[-1][:100])  # by Blender: not every edit fits
        # As every operator of an artist's does: Blender itself crashes at an undo where scripts have added something
        # since the last step (what stays in the collection is freed with the rest).
        if edit not in _SCENE_STAYS:
            with context():
                bpy.ops.ed.undo_push(message=edit.__name__)
        yield CHANCE.choice((0.0, 0.0, 0.02, 0.1, JOB.get("pause", 0.3)))
        if edit in {engine, again, shading, revert, scene}:
            ready()
        if number % 25 == 24:
            note(heap=heap_bytes(), views=len(loop().views()), number=number)
    yield from last()


def last():
    if window().screen.is_animation_playing:
        play()
    object_mode()
    if area().spaces.active.local_view:
        local_view()
    if len(area().spaces.active.region_quadviews):
        quad()
    ready()
    yield 0.2
    deadline = time.monotonic() + 60
    while still_busy() and time.monotonic() < deadline:
        yield 0.05
    yield 0.3
    views = loop().views()
    note(heap=heap_bytes(), views=len(views), settled=not still_busy())
    before = views[0].picture.pixels if views else None
    before = None if before is None else before.copy()
    # Another engine and back: a view that knows nothing.
    bpy.context.scene.render.engine = "BLENDER_WORKBENCH"
    yield 0.3
    ready()
    yield 0.3
    deadline = time.monotonic() + 60
    while still_busy() and time.monotonic() < deadline:
        yield 0.05
    after = loop().views()[0].picture.pixels
    if before is None or after is None:
        same = before is after
    else:
        same = before.shape == after.shape and bool(np.array_equal(before, after))
    note(same=same, scenes=[s.name for s in bpy.data.scenes], end=True)
    bpy.ops.wm.quit_blender()


todo = steps()


def step():
    try:
        return next(todo, None)
    except BaseException as error:
        import traceback

        note(error=repr(error), trace=traceback.format_exc()[-800:])
        bpy.ops.wm.quit_blender()


bpy.app.timers.register(step, first_interval=1.0, persistent=True)
