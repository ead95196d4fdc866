# SPDX-License-Identifier: GPL-3.0-or-later
"""What arrives of a mesh: faces, normals, attributes, materials."""

import math

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from export_probe import attribute_of, geometry_of
from mesh_parts import CUBE_FACES, cube_in_view  # noqa: F401


def test_polygons_of_any_size(scene):
    scene_parts.add_camera(scene)
    verts = [(0, 0, 0), (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (3, 3, 0), (4, 3, 0)]
    thing = scene_parts.add_mesh(scene, "Shapes", verts, [(0, 1, 2, 3, 4), (2, 5, 6), (2, 3, 5, 6)])
    thing.data.polygons[1].use_smooth = True
    thing.data.polygons[2].material_index = 1
    geometry = geometry_of(export_probe.through_script()[0], "Shapes")
    assert geometry["name"] == "mesh 'Shapes'"
    assert geometry["points"].dtype == np.float32 and geometry["points"].shape == (1, 7, 3)
    assert geometry["points"][0] == pytest.approx(np.array(verts, dtype=np.float32))
    assert geometry["face_sizes"].tolist() == [5, 3, 4]
    assert geometry["corner_verts"].tolist() == [0, 1, 2, 3, 4, 2, 5, 6, 2, 3, 5, 6]
    assert geometry["material_index"].tolist() == [0, 0, 1]
    assert geometry["smooth"].tolist() == [0, 1, 0]
    # Of faces of more than four corners, Blender's own triangles, as corners within the face.
    thing.data.calc_loop_triangles()
    expected = [list(t.loops) for t in thing.data.loop_triangles if t.polygon_index == 0]
    assert geometry["ngon_triangles"].tolist() == expected and len(expected) == 3


def test_every_uv_map_the_active_one_first(scene, cube):
    for i, name in enumerate(("First", "Second", "Third")):
        layer = cube.data.uv_layers.new(name=name)
        layer.data.foreach_set("uv", np.full(48, i + 0.25, dtype=np.float32))
    cube.data.uv_layers["Second"].active_render = True
    geometry = geometry_of(export_probe.through_script()[0], "Cube")
    maps = [a for a in geometry["attributes"] if a["kind"] == "UV"]
    assert [a["name"] for a in maps] == ["Second", "First", "Third"]
    assert all(a["domain"] == "CORNER" and a["values"].shape == (24, 2) for a in maps)
    assert [a["values"][7, 0] for a in maps] == [1.25, 0.25, 2.25]


def test_colors_are_linear_and_the_rendered_one_is_first(scene, cube):
    floats = cube.data.color_attributes.new("Floats", "FLOAT_COLOR", "POINT")
    floats.data.foreach_set("color", np.tile([2.0, 0.5, 0.25, 1.0], 8))
    bytes_ = cube.data.color_attributes.new("Bytes", "BYTE_COLOR", "CORNER")
    bytes_.data.foreach_set("color_srgb", np.tile([0.5, 1.0, 0.0, 1.0], 24))
    cube.data.color_attributes.render_color_index = 1
    geometry = geometry_of(export_probe.through_script()[0], "Cube")
    colors = [a for a in geometry["attributes"] if a["kind"] == "COLOR"]
    assert [(a["name"], a["domain"]) for a in colors] == [("Bytes", "CORNER"), ("Floats", "POINT")]
    # sRGB .5 is linear .2140; a byte holds it to half a step of 1/255, .0022 linear.
    assert colors[0]["values"][5] == pytest.approx([0.2140, 1, 0, 1], abs=0.0023)
    assert colors[1]["values"][5] == pytest.approx([2.0, 0.5, 0.25, 1.0])


def shading(name):
    """A material whose Attribute node reads `name`."""
    material = bpy.data.materials.new("Shading")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    attribute = nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = name
    surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    links.new(attribute.outputs["Color"], surface.inputs["Base Color"])
    return material


@pytest.mark.parametrize(
    "kind, member, domain, count, width, value",
    [
        ("FLOAT", "value", "POINT", 8, 1, 1.5),
        ("INT", "value", "FACE", 6, 1, -3),
        ("BOOLEAN", "value", "FACE", 6, 1, True),
        ("FLOAT_VECTOR", "vector", "CORNER", 24, 3, 0.75),
        ("FLOAT2", "vector", "POINT", 8, 2, 0.25),
    ],
)
def test_attributes_that_materials_ask_for(scene, cube, kind, member, domain, count, width, value):
    layer = cube.data.attributes.new("wanted", kind, domain)
    layer.data.foreach_set(member, [value] * (count * width))
    cube.data.attributes.new("unwanted", "FLOAT", "POINT")
    cube.data.materials.append(shading("wanted"))
    geometry = geometry_of(export_probe.through_script()[0], "Cube")
    found = attribute_of(geometry, "wanted")
    assert (found["domain"], found["kind"]) == (domain, "GENERIC")
    assert found["values"].dtype == np.float32 and found["values"].shape == (count, width)
    assert (found["values"] == float(value)).all()
    assert "unwanted" not in [a["name"] for a in geometry["attributes"]]


def test_an_attribute_on_edges_comes_as_its_means_at_vertices(scene, cube):
    edges = cube.data.attributes.new("wanted", "FLOAT", "EDGE")
    edges.data.foreach_set("value", np.arange(12, dtype=np.float32))
    cube.data.vertices.add(1)
    cube.data.materials.append(shading("wanted"))
    snapshot, report, *_ = export_probe.through_script()
    found = attribute_of(geometry_of(snapshot, "Cube"), "wanted")
    means = [
        [edge.index for edge in cube.data.edges if vertex in edge.vertices] or [0]
        for vertex in range(9)
    ]
    assert found["domain"] == "POINT" and not report.entries()
    assert found["values"][:, 0].tolist() == pytest.approx([sum(m) / len(m) for m in means])


@pytest.mark.skipif(bpy.app.version < (4, 0, 0), reason="means then, as of any numbers")
@pytest.mark.parametrize(
    "data_type, of_vertex",
    [
        ("BOOLEAN", any),
        # Blender rounds means of whole numbers, halves away from 0.
        ("INT", lambda met: math.floor(abs(sum(met) / len(met)) + 0.5) * (-1) ** (sum(met) < 0)),
    ],
)
def test_whole_numbers_on_edges_stay_whole_numbers(scene, cube, data_type, of_vertex):
    edges = cube.data.attributes.new("wanted", data_type, "EDGE")
    values = [i in (0, 7) for i in range(12)] if data_type == "BOOLEAN" else list(range(-6, 6))
    edges.data.foreach_set("value", values)
    cube.data.materials.append(shading("wanted"))
    found = attribute_of(geometry_of(export_probe.through_script()[0], "Cube"), "wanted")
    of_vertices = [
        of_vertex([v for v, edge in zip(values, cube.data.edges) if vertex in edge.vertices])
        for vertex in range(8)
    ]
    assert len(set(of_vertices)) > 1
    assert found["values"][:, 0].tolist() == of_vertices


def test_plain_smooth_and_flat_need_no_corner_normals(scene, cube):
    assert "corner_normals" not in geometry_of(export_probe.through_script()[0], "Cube")
    cube.data.polygons.foreach_set("use_smooth", [True] * 6)
    cube.data.update()
    geometry = geometry_of(export_probe.through_script()[0], "Cube")
    assert "corner_normals" not in geometry and geometry["smooth"].tolist() == [1] * 6


@pytest.mark.parametrize("smooth", [True, False])
def test_custom_normals(scene, cube, smooth):
    mesh = cube.data
    mesh.polygons.foreach_set("use_smooth", [smooth] * 6)
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
    wanted = np.tile(np.array([0.6, 0.0, 0.8]), (24, 1))
    mesh.normals_split_custom_set([tuple(n) for n in wanted])
    mesh.update()
    normals = geometry_of(export_probe.through_script()[0], "Cube")["corner_normals"]
    # Blender keeps custom normals as 16-bit angles.
    assert normals == pytest.approx(wanted, abs=1e-3)


def test_a_cube_of_sharp_edges_is_flat(scene, cube):
    mesh = cube.data
    mesh.polygons.foreach_set("use_smooth", [True] * 6)
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = 3.0
    mesh.edges.foreach_set("use_edge_sharp", [True] * 12)
    mesh.update()
    geometry = geometry_of(export_probe.through_script()[0], "Cube")
    axes = [(0, 0, -1), (0, 0, 1), (0, -1, 0), (0, 1, 0), (-1, 0, 0), (1, 0, 0)]
    if "corner_normals" in geometry:
        assert geometry["corner_normals"] == pytest.approx(np.repeat(axes, 4, axis=0), abs=1e-6)
    else:
        assert "smooth" not in geometry


def test_one_sharp_edge_splits_normals_along_it(scene):
    """A roof: two smooth squares that meet at a right angle, along the y axis."""
    scene_parts.add_camera(scene)
    verts = [(-1, 0, -1), (0, 0, 0), (0, 1, 0), (-1, 1, -1), (1, 0, -1), (1, 1, -1)]
    mesh = scene_parts.add_mesh(scene, "Roof", verts, [(0, 1, 2, 3), (1, 4, 5, 2)]).data
    mesh.polygons.foreach_set("use_smooth", [True] * 2)
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = 3.0
    ridge = next(edge for edge in mesh.edges if set(edge.vertices) == {1, 2})
    half = 0.5**0.5
    for sharp in (False, True):
        ridge.use_edge_sharp = sharp
        mesh.update()
        geometry = geometry_of(export_probe.through_script()[0], "Roof")
        if sharp:
            expected = np.repeat([(-half, 0, half), (half, 0, half)], 4, axis=0)
            assert geometry["corner_normals"] == pytest.approx(expected, abs=1e-6)
        elif "corner_normals" in geometry:
            assert geometry["corner_normals"][1] == pytest.approx([0, 0, 1], abs=1e-6)
        assert geometry["smooth"].tolist() == [1, 1]


def test_faces_with_vertices_that_are_not_finite_are_left_out_and_named(scene, cube):
    layer = cube.data.uv_layers.new(name="UV")
    layer.data.foreach_set("uv", np.arange(48, dtype=np.float32))
    cube.data.vertices[0].co.x = float("nan")
    snapshot, report = export_probe.through_script()
    geometry = geometry_of(snapshot, "Cube")
    # Vertex 0 belongs to faces 0, 2 and 4.
    assert geometry["corner_verts"].tolist() == [*CUBE_FACES[1], *CUBE_FACES[3], *CUBE_FACES[5]]
    assert np.isfinite(geometry["points"]).all()
    uv = attribute_of(geometry, "UV")["values"]
    assert uv[:, 0].tolist() == [8, 10, 12, 14, 24, 26, 28, 30, 40, 42, 44, 46]
    assert report.entries() == [("mesh 'Cube'", "3 faces left out: 1 vertex not finite", 1)]


def test_values_of_faces_that_are_left_out_go_with_them(scene, cube):
    tint = cube.data.attributes.new("tint", "FLOAT", "FACE")
    tint.data.foreach_set("value", np.arange(6, dtype=np.float32))
    cube.data.materials.append(shading("tint"))
    cube.data.vertices[0].co.x = float("nan")
    geometry = geometry_of(export_probe.through_script()[0], "Cube")
    kept = [i for i, face in enumerate(CUBE_FACES) if 0 not in face]
    assert attribute_of(geometry, "tint")["values"].ravel().tolist() == kept


def test_attribute_values_that_are_not_finite_are_named(scene, cube):
    layer = cube.data.uv_layers.new(name="UV")
    values = np.full(48, 0.5, dtype=np.float32)
    values[[0, 7]] = np.nan, np.inf
    layer.data.foreach_set("uv", values)
    snapshot, report = export_probe.through_script()
    uv = attribute_of(geometry_of(snapshot, "Cube"), "UV")["values"].reshape(-1)
    assert np.flatnonzero(uv != 0.5).tolist() == [0, 7] and uv[0] == uv[7] == 0.0
    assert [(d, "UV" in m) for d, m, _ in report.entries()] == [("mesh 'Cube'", True)]


def test_empty_meshes_are_nothing(scene):
    scene_parts.add_camera(scene)
    scene_parts.add_mesh(scene, "Empty", [], [])
    scene_parts.add_mesh(scene, "Points", [(0, 0, 0)], [])
    snapshot, report = export_probe.through_script()
    assert snapshot["geometries"] == [] and snapshot["instances"]["name"] == []
    assert len(report) == 0


def test_material_slots(scene, cube):
    red, blue = bpy.data.materials.new("Red"), bpy.data.materials.new("Blue")
    for material in (red, None, blue):
        cube.data.materials.append(material)
    other = scene_parts.add_object(scene, "Other", cube.data)
    other.material_slots[0].link = "OBJECT"
    other.material_slots[0].material = blue
    snapshot, _ = export_probe.through_script()
    names = [material["name"] for material in snapshot["materials"]]
    instances = snapshot["instances"]
    assert instances["slots"].tolist() == [3, 3]
    # Cycles' material for an empty slot, which is a nameless record since Blender 5.
    used = [names[i] or None if i >= 0 else None for i in instances["materials"]]
    assert used == ["Red", None, "Blue", "Blue", None, "Blue"]
    assert instances["geometry"].tolist() == [0, 0]


def test_material_override(scene, cube):
    cube.data.materials.append(bpy.data.materials.new("Own"))
    bare = scene_parts.add_object(scene, "Bare", bpy.data.meshes.new_from_object(cube))
    bare.data.materials.clear()
    bpy.context.view_layer.material_override = bpy.data.materials.new("Clay")
    snapshot, _, _ = export_probe.through_engine(scene)
    assert [material["name"] for material in snapshot["materials"]] == ["Clay"]
    assert snapshot["instances"]["materials"].tolist() == [0, 0]
