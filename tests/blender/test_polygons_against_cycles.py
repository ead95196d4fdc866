# SPDX-License-Identifier: GPL-3.0-or-later
"""Polygons without subdivision are Blender's triangles: shading and coverage against Cycles."""

import bpy
import numpy as np
import pytest
import scene_parts
from mesh_parts import CUBE, CUBE_FACES
from node_comparison import Tree

WIDTH = 96


def add_sun(scene):
    sun = scene_parts.add_object(scene, "Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle = 3.0, 0.0
    sun.rotation_euler = (0.9, 0.3, 0.4)


def add_waves(scene, faces, height, smooth=False):
    """A square of faces by faces quads, which bend along both of their directions."""
    n = faces + 1
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    z = height * np.sin(5 * x + 2 * y) * np.cos(6 * y - x)
    vertices = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    first = (np.arange(faces)[:, None] * n + np.arange(faces)).ravel()
    quads = first[:, None] + np.array([0, 1, n + 1, n])
    thing = scene_parts.add_mesh(scene, "Waves", vertices.tolist(), quads.tolist())
    thing.data.polygons.foreach_set("use_smooth", [smooth] * len(quads))
    thing.data.materials.append(bpy.data.materials.new("Diffuse"))
    return thing


def add_roofs(scene, height):
    """Quads whose first and third corner are that far above the others."""
    vertices, faces = [], []
    for row in range(2):
        for column in range(2):
            x, y = column - 0.5, row - 0.5
            faces.append(list(range(len(vertices), len(vertices) + 4)))
            corners = ((0, -1, height), (1, 0, 0), (0, 1, height), (-1, 0, 0))
            vertices += [(x + 0.45 * a, y + 0.45 * b, 0.45 * c) for a, b, c in corners]
    thing = scene_parts.add_mesh(scene, "Roofs", vertices, faces)
    thing.data.materials.append(bpy.data.materials.new("Diffuse"))
    return thing


def add_petals(scene, concave):
    """Faces of many corners that go up and down: which corners are joined decides what is seen."""
    random = np.random.default_rng(5)
    vertices, faces = [], []
    for row in range(3):
        for column in range(3):
            angle = np.arange(10) * np.pi / 5
            radius = np.where(np.arange(10) % 2, 0.12 if concave else 0.31, 0.31)
            radius = radius * random.uniform(0.9, 1.1, 10)
            x, y = radius * np.cos(angle), radius * np.sin(angle)
            z = random.uniform(-0.08, 0.08, 10)
            faces.append(list(range(len(vertices), len(vertices) + 10)))
            center = 0.66 * np.array([column - 1, row - 1])
            vertices += np.stack([x + center[0], y + center[1], z], axis=-1).tolist()
    thing = scene_parts.add_mesh(scene, "Petals", vertices, faces)
    thing.data.materials.append(bpy.data.materials.new("Diffuse"))


def pictures(scene, render):
    """[Granita's, Cycles'] (luminance, alpha), float32 [h, w]."""
    scene.render.resolution_x = scene.render.resolution_y = WIDTH
    scene.render.film_transparent = True
    made = scene_parts.direct_light_of_both(scene, render, 64)
    return [
        [next(v for k, v in passes.items() if k.endswith("Combined." + c)) for c in ("G", "A")]
        for passes in made
    ]


def check(scene, render, rms=0.03):
    """Means within .2 %: both take one sun from a direction, and differ by their sampling of pixels alone, which
    is .05 to .09 % here.  `rms`, of the mean, is for edges between bright and dark faces."""
    (ours, alpha), (theirs, their_alpha) = pictures(scene, render)
    mean, error = ours.mean() / theirs.mean() - 1, np.sqrt(np.mean((ours - theirs) ** 2))
    covered = abs(alpha.mean() - their_alpha.mean())
    print(f"mean {mean:+.4f}, rms {error / theirs.mean():.4f} of the mean, coverage {covered:.5f}")
    assert theirs.std() > 0.1 * theirs.mean()
    assert abs(mean) < 0.002
    assert error < rms * theirs.mean()
    assert covered < 0.001


@pytest.mark.parametrize("faces", [8, 24, 96])
@pytest.mark.parametrize("tilt", [0.0, 1.2])
def test_flat_waves(scene, render, faces, tilt):
    """Faces of 12, 4 and 1 pixels, as they are and foreshortened; as bent patches, 8 of them were 1.6 % too bright."""
    add_sun(scene)
    add_waves(scene, faces, 0.12).rotation_euler.x = tilt
    scene_parts.add_camera(scene, ortho_scale=2.2)
    check(scene, render)


@pytest.mark.parametrize("height", [0.9, 1.2])
def test_quads_that_are_folded(scene, render, height):
    """By more than a right angle from a height of 1 on: which corners are then joined is not the same in each Blender."""
    add_sun(scene)
    add_roofs(scene, height).rotation_euler.x = 0.4
    scene_parts.add_camera(scene, ortho_scale=2.2)
    check(scene, render, 0.1)


def test_creases_of_metaballs(scene, render):
    """3.4 shades them by the field's normals, which at a crease are those of one of its sides."""
    balls = bpy.data.metaballs.new("Balls")
    balls.render_resolution = 0.2
    for place, radius, hollow in (((0, 0, 0), 1.2, False), ((0.3, -0.2, 0.7), 0.9, True)):
        ball = balls.elements.new()
        ball.co, ball.radius, ball.use_negative = place, radius, hollow
    balls.materials.append(bpy.data.materials.new("Diffuse"))
    scene_parts.add_object(scene, "Balls", balls)
    add_sun(scene)
    scene_parts.add_camera(scene, ortho_scale=2.2)
    check(scene, render)


@pytest.mark.parametrize("faces", [8, 24])
def test_smooth_waves(scene, render, faces):
    add_sun(scene)
    add_waves(scene, faces, 0.12, smooth=True)
    scene_parts.add_camera(scene, ortho_scale=2.2)
    check(scene, render, rms=0.01)


def split_nothing(mesh):
    pass


def split_edges(mesh):
    mesh.edges.foreach_set("use_edge_sharp", [i % 5 == 0 for i in range(len(mesh.edges))])


def bend_normals(mesh):
    mesh.normals_split_custom_set([(0.6, 0.0, 0.8)] * len(mesh.loops))


@pytest.mark.parametrize("split", [split_nothing, split_edges, bend_normals])
@pytest.mark.parametrize("smooth_faces", [0, 1])
@pytest.mark.parametrize("auto_smooth", [False, True])
def test_flat_faces_and_split_normals(scene, render, split, smooth_faces, auto_smooth):
    """Faces: all flat, or every second one smooth."""
    add_sun(scene)
    thing = add_waves(scene, 8, 0.12)
    mesh = thing.data
    mesh.polygons.foreach_set("use_smooth", [bool(smooth_faces and i % 2) for i in range(64)])
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth, mesh.auto_smooth_angle = auto_smooth, 3.0
    split(mesh)
    mesh.update()
    scene_parts.add_camera(scene, ortho_scale=2.2)
    check(scene, render)


def add_ball():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=8, ring_count=6)


def add_cylinder():
    bpy.ops.mesh.primitive_cylinder_add(vertices=16, radius=0.7, depth=1.4)


def add_cube():
    bpy.ops.mesh.primitive_cube_add(size=1.2)


def add_card():
    """A leaf that light falls on from behind, with the normals of what it stands for."""
    bpy.ops.mesh.primitive_plane_add(size=1.6)
    mesh = bpy.context.object.data
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set(
        [
            (0.6 + 0.2 * x, 0.2 * y, 0.7)
            for x, y, _ in map(tuple, (mesh.vertices[loop.vertex_index].co for loop in mesh.loops))
        ]
    )


@pytest.mark.parametrize("offset", [0.0, 0.1])
@pytest.mark.parametrize("add", [add_ball, add_cylinder, add_cube, add_card])
def test_where_light_ends_on_coarse_smooth_faces(scene, render, add, offset):
    """Cycles' Geometry Offset lifts shadow rays above them; without it each face ends light by itself."""
    add()
    thing = bpy.context.object
    mesh = thing.data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.materials.append(bpy.data.materials.new("Diffuse"))
    mesh.update()
    thing.rotation_euler = (0.6, 0.2, 0.3)
    scene_parts.set_terminator_offset(thing, offset)
    add_sun(scene)
    scene.objects["Sun"].rotation_euler = (0.0, 1.4, 0.0)
    if add is add_card:
        thing.rotation_euler = (0.0, 0.0, 0.0)
        scene.objects["Sun"].rotation_euler = (0.0, 1.8, 0.0)
    scene_parts.add_camera(scene, ortho_scale=2.6)
    check(scene, render, rms=0.055)  # outlines against nothing


@pytest.mark.parametrize("levels", [1, 2])
def test_flat_faces_under_subdivision_show_the_facets_of_their_level(scene, render, levels):
    add_sun(scene)
    cube = scene_parts.add_mesh(scene, "Cube", CUBE, CUBE_FACES)
    cube.rotation_euler = (0.5, 0.3, 0.2)
    cube.data.materials.append(bpy.data.materials.new("Diffuse"))
    cube.modifiers.new("Subdivision", "SUBSURF").render_levels = levels
    scene_parts.add_camera(scene, ortho_scale=3.0)
    check(scene, render, rms=0.06)  # an outline against nothing


@pytest.mark.parametrize("concave", [False, True])
def test_faces_of_many_corners(scene, render, concave):
    add_sun(scene)
    add_petals(scene, concave)
    scene_parts.add_camera(scene, ortho_scale=2.0)
    check(scene, render, rms=0.08)  # nine outlines against nothing


def test_normal_maps_lean_with_the_tangents_of_bent_quads(scene, render):
    """Half of each had those of the face after it."""
    waves = add_waves(scene, 16, 0.15, smooth=True)
    mesh = waves.data
    places = np.array([mesh.vertices[loop.vertex_index].co[:2] for loop in mesh.loops])
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", (places / 2 + 0.5).ravel())
    mesh.materials.clear()
    tree = Tree(waves)
    lean, diffuse = tree.add("ShaderNodeNormalMap"), tree.add("ShaderNodeBsdfDiffuse")
    lean.inputs["Color"].default_value = (0.85, 0.5, 0.8, 1.0)
    tree.link(lean.outputs[0], diffuse.inputs["Normal"])
    tree.link(diffuse.outputs[0], tree.output.inputs["Surface"])
    scene_parts.add_camera(scene, ortho_scale=1.8)
    add_sun(scene)
    check(scene, render, rms=0.01)
