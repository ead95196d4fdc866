# SPDX-License-Identifier: GPL-3.0-or-later
"""A Subsurf that is last arrives as its cage; any other is Blender's to tessellate."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from export_probe import attribute_of, geometry_of
from mesh_parts import cube_in_view  # noqa: F401


def set_crease(mesh, edges=None, verts=None):
    """Creases 0..1, where this Blender keeps them."""
    for values, attribute, domain in (
        (edges, "crease_edge", "EDGE"),
        (verts, "crease_vert", "POINT"),
    ):
        if values is None:
            continue
        if (
            hasattr(bpy.types.MeshEdge, "crease")
            or "crease" in bpy.types.MeshEdge.bl_rna.properties
        ):
            if domain == "EDGE":
                mesh.edges.foreach_set("crease", values)
                continue
            bpy.context.view_layer.objects.active = bpy.data.objects["Cube"]
            bpy.ops.mesh.customdata_crease_vertex_add()
            mesh.vertex_creases[0].data.foreach_set("value", values)
        else:
            layer = mesh.attributes.new(attribute, "FLOAT", domain)
            layer.data.foreach_set("value", values)
    mesh.update()


@pytest.mark.smoke
def test_cage(scene, cube):
    modifier = scene_parts.add_subsurf(cube, 3)
    modifier.boundary_smooth = "PRESERVE_CORNERS"
    modifier.uv_smooth = "SMOOTH_ALL"
    cube.data.uv_layers.new(name="UV")
    for snapshot in (export_probe.through_script()[0], export_probe.through_engine(scene)[0]):
        geometry = geometry_of(snapshot, "Cube")
        assert geometry["points"].shape == (1, 8, 3) and len(geometry["face_sizes"]) == 6
        assert attribute_of(geometry, "UV")["values"].shape == (24, 2)
        subdivision = geometry["subdivision"]
        assert subdivision["scheme"] == "CATMULL_CLARK"
        assert subdivision["boundary"] == "PRESERVE_CORNERS"
        assert subdivision["uv_smooth"] == "SMOOTH_ALL"
        assert "crease_verts" not in subdivision and "vertex_creases" not in subdivision
    assert modifier.show_render and modifier.show_viewport


def test_cage_is_deformed_by_what_comes_before(scene, cube):
    mirror = cube.modifiers.new("Array", "ARRAY")
    mirror.count = 3
    mirror.relative_offset_displace = (2, 0, 0)
    scene_parts.add_subsurf(cube)
    geometry = geometry_of(export_probe.through_engine(scene)[0], "Cube")
    assert geometry["points"].shape == (1, 24, 3)
    assert geometry["points"][0, :, 0].max() == pytest.approx(9)


def test_flat_faces_are_blenders_own_facets(scene, cube):
    scene_parts.add_subsurf(cube, 2)
    cube.data.polygons[2].use_smooth = False
    geometry = geometry_of(export_probe.through_engine(scene)[0], "Cube")
    assert geometry.get("subdivision") is None
    assert len(geometry["face_sizes"]) == 6 * 16 and geometry["smooth"].sum() == 5 * 16


def test_simple_subdivision_is_blenders_own_mesh(scene, cube):
    cube.data.polygons.foreach_set("use_smooth", [True] * 6)
    scene_parts.add_subsurf(cube, 2).subdivision_type = "SIMPLE"
    geometry = geometry_of(export_probe.through_engine(scene)[0], "Cube")
    assert geometry.get("subdivision") is None
    assert len(geometry["face_sizes"]) == 6 * 16 and geometry["smooth"].all()


def test_creases_become_sharpness(scene, cube):
    edges = np.zeros(12, dtype=np.float32)
    edges[[2, 7]] = 0.5, 1.0
    verts = np.zeros(8, dtype=np.float32)
    verts[3] = 0.7
    set_crease(cube.data, edges, verts)
    modifier = scene_parts.add_subsurf(cube)
    subdivision = geometry_of(export_probe.through_engine(scene)[0], "Cube")["subdivision"]
    expected = [tuple(cube.data.edges[i].vertices) for i in (2, 7)]
    assert [tuple(pair) for pair in subdivision["crease_verts"]] == expected
    # Ten times the square, at most the quality.
    assert subdivision["crease_values"] == pytest.approx([2.5, 10.0])
    assert subdivision["vertex_creases"] == pytest.approx([0, 0, 0, 3.0, 0, 0, 0, 0], abs=1e-5)
    modifier.quality = 5
    subdivision = geometry_of(export_probe.through_engine(scene)[0], "Cube")["subdivision"]
    assert subdivision["vertex_creases"] == pytest.approx([0, 0, 0, 4.9, 0, 0, 0, 0], abs=1e-5)
    modifier.use_creases = False
    subdivision = geometry_of(export_probe.through_engine(scene)[0], "Cube")["subdivision"]
    assert "crease_verts" not in subdivision and "vertex_creases" not in subdivision


def greatest_sum(cube):
    """How far Blender's own subdivided mesh reaches along (1, 1, 1)."""
    bpy.context.view_layer.update()
    evaluated = cube.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return max(sum(vertex.co) for vertex in evaluated.data.vertices)


@pytest.mark.parametrize("quality", [1, 2, 3, 4, 6])
def test_creases_are_as_round_as_blenders(scene, cube, quality):
    # A cube's corner at which three edges of sharpness n meet: n levels leave it in place and halve
    # the edges; the smooth limit of what is left reaches to 3/2 of a half cube's 3.
    modifier = scene_parts.add_subsurf(cube, 4)
    modifier.levels = 4
    modifier.quality = quality
    set_crease(cube.data, np.full(12, 0.6**0.5, dtype=np.float32), None)
    values = geometry_of(export_probe.through_engine(scene)[0], "Cube")["subdivision"][
        "crease_values"
    ]
    assert values == pytest.approx(np.full(12, min(quality, 6)), abs=1e-5)
    assert greatest_sum(cube) == pytest.approx(3 - 1.5 * 0.5 ** values[0], abs=1e-4)


def off(modifier, _cube, _scene):
    modifier.show_render = False


def no_levels(modifier, _cube, _scene):
    modifier.render_levels = 0


def simplified_away(_modifier, _cube, scene):
    scene.render.use_simplify = True
    scene.render.simplify_subdivision_render = 0


@pytest.mark.parametrize("switch", [off, no_levels, simplified_away])
def test_subsurf_that_does_not_render_is_a_plain_mesh(scene, cube, switch):
    switch(scene_parts.add_subsurf(cube), cube, scene)
    geometry = geometry_of(export_probe.through_engine(scene)[0], "Cube")
    assert "subdivision" not in geometry and geometry["points"].shape == (1, 8, 3)


def before_another(cube):
    scene_parts.add_subsurf(cube)
    cube.modifiers.new("Weld", "WELD").merge_threshold = 1e-6


def with_particles(cube):
    cube.modifiers.new("Particles", "PARTICLE_SYSTEM")
    scene_parts.add_subsurf(cube)


def instancing_on_faces(cube):
    scene_parts.add_subsurf(cube)
    cube.instance_type = "FACES"


@pytest.mark.parametrize("make", [before_another, with_particles, instancing_on_faces])
def test_blender_subdivides_what_else_depends_on_it(scene, cube, make):
    make(cube)
    geometry = geometry_of(export_probe.through_engine(scene)[0], "Cube")
    # A cube of 6 faces, twice split in four: 96 faces, 98 vertices.
    assert "subdivision" not in geometry and geometry["points"].shape == (1, 98, 3)


def test_objects_of_one_mesh_share_the_cage(scene, cube):
    other = scene_parts.add_object(scene, "Other", cube.data, (3, 0, 0))
    third = scene_parts.add_object(scene, "Third", cube.data, (6, 0, 0))
    for thing in (cube, other, third):
        scene_parts.add_subsurf(thing)
    third.modifiers[0].uv_smooth = "NONE"
    snapshot, _, _ = export_probe.through_engine(scene)
    assert snapshot["instances"]["geometry"].tolist() == [0, 0, 1]
