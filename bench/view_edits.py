# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of a bench's scene under Rendered shading, each of which makes another picture."""

import bpy


def open_lens(camera):
    """A lens whose circles of confusion are some pixels wide: in metres an orthographic camera's aperture is larger."""
    camera.dof.use_dof = True
    if camera.dof.aperture_fstop > 1:
        camera.dof.aperture_fstop = 2.0 if camera.type == "ORTHO" else 0.05
        camera.dof.focus_distance = 15.0


def lamp_of():
    return next(thing for thing in bpy.data.objects if thing.type == "LIGHT")


def mesh_of():
    return next(t for t in bpy.data.objects if t.type == "MESH" and t.data.materials)


def fstop_of(scene):
    return scene.camera.data.dof.aperture_fstop


def color_of():
    """The colour socket of a material's first shader."""
    nodes = mesh_of().data.materials[0].node_tree.nodes
    shader = next(n for n in nodes if n.type.startswith(("BSDF", "EMISSION")))
    return next(s for s in shader.inputs if s.name in ("Color", "Base Color"))


def orbit(view, k):
    from mathutils import Quaternion

    if view.view_perspective == "CAMERA":
        view.view_perspective = "PERSP"
        view.view_distance, view.view_location = 20.0, (0, 0, 0)
        view.view_rotation = Quaternion((1, 0, 0), 0.4)
    view.view_rotation = Quaternion((0, 0, 1), 0.02 * (1 + k)) @ view.view_rotation


def show_pass(scene, name):
    areas = bpy.context.window_manager.windows[0].screen.areas
    area = next(area for area in areas if area.type == "VIEW_3D")
    shading = area.spaces.active.shading
    owner = shading.granita if scene.render.engine == "GRANITA" else shading.cycles
    owner.render_pass = name
    area.tag_redraw()


# edit(scene, RegionView3D, k): k counts the calls, each makes another picture.
EDITS = {
    "shutter": lambda s, v, k: setattr(s.render, "motion_blur_shutter", 0.6 + 0.02 * k),
    "f-stop": lambda s, v, k: setattr(s.camera.data.dof, "aperture_fstop", fstop_of(s) * 1.02),
    "focus": lambda s, v, k: setattr(s.camera.data.dof, "focus_distance", 14.0 + 0.1 * k),
    "lamp strength": lambda s, v, k: setattr(
        lamp_of().data, "energy", lamp_of().data.energy * (1.2 if k == 0 else 1.03)
    ),
    "lamp color": lambda s, v, k: setattr(lamp_of().data, "color", (1, 0.7 - 0.01 * k, 0.5)),
    "material color": lambda s, v, k: setattr(
        color_of(), "default_value", (0.9, 0.2 + 0.01 * k, 0.1, 1)
    ),
    "lamp moved": lambda s, v, k: setattr(lamp_of(), "location", (0.2 * k, 1.0, 8.0)),
    "object moved": lambda s, v, k: setattr(
        mesh_of(), "location", (0.1 + 0.02 * k, 0.1, mesh_of().location[2])
    ),
    "frame": lambda s, v, k: s.frame_set(s.frame_current + 1),
    "orbit": lambda s, v, k: orbit(v, k),
    "pass": lambda s, v, k: show_pass(s, "NORMAL"),
    "back from pass": lambda s, v, k: show_pass(s, "COMBINED"),
    "to camera": lambda s, v, k: setattr(v, "view_perspective", "CAMERA"),
}
