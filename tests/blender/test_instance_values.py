# SPDX-License-Identifier: GPL-3.0-or-later
"""What shaders find on instances, against Cycles: colours, attributes of objects and of what instances them,
places on the instancer."""

import bpy
import node_parts
import numpy as np
import pytest
import scene_parts
from node_comparison import LIMIT, Tree, render_both, rmse, socket

PIXELS = 32


def _view(scene, scale=4.0):
    scene_parts.add_camera(scene, ortho_scale=scale)
    scene.render.resolution_x = scene.render.resolution_y = PIXELS


def _agree(scene, render, least=0.05):
    """Squares end between pixels' centres: no noise of edges."""
    theirs, ours = render_both(scene, render, samples=16)
    assert theirs.std() >= least, theirs.std()
    error = rmse(theirs, ours)
    assert error < LIMIT, f"error {error:.5f}, deviation {theirs.std():.4f}"


def _two_squares(scene):
    _view(scene)
    return [scene_parts.add_square(scene, f"Square{x}", 1.0, (x, 0.0, 0.0)) for x in (-1.0, 1.0)]


def _shown(things, kind, output, **properties):
    tree = Tree(things[0])
    node = tree.add(kind, **properties)
    tree.emit(socket(node.outputs, output))
    for thing in things[1:]:
        thing.data.materials.append(tree.material)
    return tree, node


@pytest.mark.parametrize("output", ["Color", "Alpha"])
def test_object_info_has_the_objects_color(scene, render, output):
    if output == "Alpha" and bpy.app.version < (3, 6, 0):
        output = "Color"
    things = _two_squares(scene)
    things[0].color, things[1].color = (0.2, 0.7, 0.4, 0.3), (0.9, 0.1, 0.5, 0.8)
    _shown(things, "ShaderNodeObjectInfo", output)
    _agree(scene, render)


@pytest.mark.parametrize("nested", [False, True])
def test_instances_have_the_colour_of_their_instancer(scene, render, nested):
    _view(scene)
    inside = scene_parts.add_square(scene, "Inside", 1.0)
    inside.color = (0.1, 0.2, 0.9, 1.0)
    place = inside
    for level in range(2 if nested else 1):
        part = bpy.data.collections.new(f"Part{level}")
        part.objects.link(place)
        scene.collection.objects.unlink(place)
        place = scene_parts.add_object(scene, f"Place{level}", None, (0.5 * level, 0.0, 0.0))
        place.instance_type, place.instance_collection = "COLLECTION", part
        place.color = (0.9, 0.3 + 0.3 * level, 0.1, 1.0)
    _shown([inside], "ShaderNodeObjectInfo", "Color")
    _agree(scene, render)


@pytest.mark.parametrize("output", ["Color", "Vector", "Fac", "Alpha"])
@pytest.mark.parametrize("name", ["shade", "number", "location", "color", "nothing"])
def test_attributes_of_objects(scene, render, name, output):
    things = _two_squares(scene)
    for value, thing in enumerate(things):
        thing["shade"] = (0.2 + 0.3 * value, 0.6, 0.1)
        thing["number"] = 0.3 + 0.5 * value
        thing.color = (0.2, 0.7, 0.4 * value, 0.3)
    _shown(things, "ShaderNodeAttribute", output, attribute_type="OBJECT", attribute_name=name)
    _agree(scene, render, 0.0 if name in ("nothing", "location") else 0.02)


def test_attributes_of_an_objects_data(scene, render):
    things = _two_squares(scene)
    things[0].data["shade"], things[1].data["shade"] = 0.25, 0.75
    _shown(things, "ShaderNodeAttribute", "Fac", attribute_type="OBJECT", attribute_name="shade")
    _agree(scene, render)


@pytest.mark.parametrize("owner", ["view layer", "scene", "world", "nothing"])
def test_attributes_of_the_view_layer(scene, render, owner):
    things = _two_squares(scene)
    scene.world = bpy.data.worlds.new("World")
    owners = {"view layer": scene.view_layers[0], "scene": scene, "world": scene.world}
    if owner in owners:
        owners[owner]["tint"] = (0.5, 0.25, 0.75)
    _shown(
        things, "ShaderNodeAttribute", "Color", attribute_type="VIEW_LAYER", attribute_name="tint"
    )
    _agree(scene, render, 0.0 if owner == "nothing" else 0.05)


def _instances_of_collection(scene, thing):
    part = node_parts.hidden_collection(scene, thing)
    places = []
    for x in (-1.0, 1.0):
        place = scene_parts.add_object(scene, f"Place{x}", None, (x, 0, 0))
        place.instance_type, place.instance_collection = "COLLECTION", part
        places.append(place)
    return places


@pytest.mark.parametrize("kind", ["OBJECT", "INSTANCER"])
def test_attributes_of_what_instances(scene, render, kind):
    _view(scene)
    square = scene_parts.add_square(scene, "Square", 1.0)
    square["shade"] = 0.4
    places = _instances_of_collection(scene, square)
    places[0]["shade"] = 0.9
    _shown([square], "ShaderNodeAttribute", "Fac", attribute_type=kind, attribute_name="shade")
    _agree(scene, render)


@pytest.mark.skipif(bpy.app.version < (4, 5, 0), reason="Blender hands them out since 4.5")
@pytest.mark.parametrize("numbered", [False, True], ids=["in order", "with numbers"])
@pytest.mark.parametrize("kind", ["FLOAT", "FLOAT_VECTOR", "FLOAT_COLOR"])
def test_attributes_that_geometry_nodes_give_instances(scene, render, kind, numbered):
    _view(scene)
    square = scene_parts.add_square(scene, "Square", 0.5)
    _shown(
        [square], "ShaderNodeAttribute", "Color", attribute_type="INSTANCER", attribute_name="shade"
    )
    _instances_with_attribute(scene, square, kind, numbered)
    _agree(scene, render)


def _instances_with_attribute(scene, part, kind, numbered=False):
    """`numbered`: as Distribute Points on Faces does, by what single precision does not tell apart."""

    def build(nodes, links, geometry):
        line, info = nodes.new("GeometryNodeMeshLine"), nodes.new("GeometryNodeObjectInfo")
        line.inputs["Count"].default_value = 3
        line.inputs["Start Location"].default_value = (-1, 0, 0)
        line.inputs["Offset"].default_value = (1, 0, 0)
        info.inputs["Object"].default_value = part
        info.inputs["As Instance"].default_value = True
        place, store = (
            nodes.new("GeometryNodeInstanceOnPoints"),
            nodes.new("GeometryNodeStoreNamedAttribute"),
        )
        links.new(line.outputs["Mesh"], place.inputs["Points"])
        links.new(info.outputs["Geometry"], place.inputs["Instance"])
        store.data_type, store.domain = kind, "INSTANCE"
        store.inputs["Name"].default_value = "shade"
        index, scaled = nodes.new("GeometryNodeInputIndex"), nodes.new("ShaderNodeMath")
        scaled.operation = "MULTIPLY_ADD"
        links.new(index.outputs[0], scaled.inputs[0])
        scaled.inputs[1].default_value, scaled.inputs[2].default_value = 0.3, 0.2
        value = next(s for s in store.inputs if s.name == "Value" and s.enabled)
        links.new(scaled.outputs[0], value)
        links.new(place.outputs[0], store.inputs["Geometry"])
        if numbered:
            number, great = nodes.new("GeometryNodeSetID"), nodes.new("FunctionNodeIntegerMath")
            great.inputs[1].default_value = 10**9 + 1
            links.new(index.outputs[0], great.inputs[0])
            links.new(great.outputs[0], number.inputs["ID"])
            links.new(line.outputs["Mesh"], number.inputs["Geometry"])
            links.new(number.outputs[0], place.inputs["Points"])
        return store.outputs[0]

    node_parts.with_nodes(scene_parts.add_square(scene, "Host"), build)
    node_parts.hidden_collection(scene, part)


@pytest.mark.skipif(bpy.app.version >= (4, 5, 0), reason="read since then")
def test_attributes_of_nodes_instances_that_cannot_be_read_are_named(scene, render, capfd):
    _view(scene)
    square = scene_parts.add_square(scene, "Square", 0.5)
    _shown(
        [square], "ShaderNodeAttribute", "Color", attribute_type="INSTANCER", attribute_name="shade"
    )
    _instances_with_attribute(scene, square, "FLOAT")
    render(scene)
    assert "object 'Host'" in (said := capfd.readouterr().out) and "'shade'" in said


@pytest.mark.parametrize("output", ["UV", "Generated"])
@pytest.mark.parametrize("kind", ["VERTS", "FACES"])
def test_places_on_the_instancer(scene, render, kind, output):
    _view(scene)
    small = scene_parts.add_square(scene, "Small", 0.25)
    _shown([small], "ShaderNodeTexCoord", output, from_instancer=True)
    corners = [(x, y, 0.0) for y in (-1.0, 0.0, 1.0) for x in (-1.0, 0.0, 1.0)]
    faces = [(i, i + 1, i + 4, i + 3) for i in (0, 1, 3, 4)]
    parent = scene_parts.add_mesh(scene, "Parent", corners, faces)
    uv = np.random.default_rng(1).uniform(0.1, 0.9, 2 * len(parent.data.loops)).astype(np.float32)
    parent.data.uv_layers.new(name="UVMap").data.foreach_set("uv", uv)
    small.parent, parent.instance_type = parent, kind
    parent.show_instancer_for_render = False
    _agree(scene, render, 0.0 if kind == "VERTS" and output == "UV" else 0.02)


def test_the_uv_of_the_instancer_by_the_node_uv_map(scene, render):
    _view(scene)
    small = scene_parts.add_square(scene, "Small", 0.5)
    _shown([small], "ShaderNodeUVMap", "UV", from_instancer=True)
    parent = scene_parts.add_square(scene, "Parent", 2.0)
    uv = np.array([(0.1, 0.2), (0.3, 0.9), (0.8, 0.7), (0.6, 0.1)], dtype=np.float32)
    parent.data.uv_layers.new(name="UVMap").data.foreach_set("uv", uv.ravel())
    small.parent, parent.instance_type = parent, "FACES"
    parent.show_instancer_for_render = False
    _agree(scene, render, 0.02)


def test_random_per_island(scene, render):
    """Four squares, two of which share an edge; Cycles' own numbers."""
    _view(scene)
    corners, faces = [], []
    for x, y in ((-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)):
        first = len(corners)
        corners += [
            (x - 0.5, y - 0.5, 0),
            (x + 0.5, y - 0.5, 0),
            (x + 0.5, y + 0.5, 0),
            (x - 0.5, y + 0.5, 0),
        ]
        faces.append((first, first + 1, first + 2, first + 3))
    corners += [(2.0, -1.5, 0.0), (2.0, -0.5, 0.0)]
    faces.append((5, 12, 13, 6))
    thing = scene_parts.add_mesh(scene, "Islands", corners, faces)
    _shown([thing], "ShaderNodeNewGeometry", "Random Per Island")
    _agree(scene, render, 0.1)


def test_an_attribute_that_is_not_there_is_opaque(scene, render):
    things = _two_squares(scene)
    _shown(things, "ShaderNodeAttribute", "Alpha", attribute_name="nope")
    _agree(scene, render)


PARTICLE = {
    "Index": 0.03, "Random": 1.0, "Age": 0.02, "Lifetime": 0.02, "Size": 1.0,
    "Location": 0.4, "Velocity": 0.2, "Angular Velocity": 0.5,
}  # fmt: skip


@pytest.mark.parametrize("output", PARTICLE)
def test_particle_info(scene, render, output):
    """Also of things that no particle makes."""
    _view(scene, 4.0)
    shape = scene_parts.add_square(scene, "Shape", 0.5, (0.0, 0.0, 1.0))
    maker = scene_parts.add_square(scene, "Maker", 3.0)
    maker.modifiers.new("System", "PARTICLE_SYSTEM")
    settings = maker.particle_systems[0].settings
    values = {
        "count": 30, "frame_start": -20, "frame_end": 0, "lifetime": 60, "lifetime_random": 0.5,
        "emit_from": "FACE", "normal_factor": 0.0, "factor_random": 0.8, "render_type": "OBJECT",
        "instance_object": shape, "particle_size": 1.2, "size_random": 0.6,
        "use_rotations": True, "angular_velocity_mode": "VELOCITY", "angular_velocity_factor": 0.7,
    }  # fmt: skip
    for key, value in values.items():
        setattr(settings, key, value)
    settings.effector_weights.gravity = 0.1
    maker.show_instancer_for_render = False
    for frame in range(-20, 11):
        scene.frame_set(frame)
    tree, node = _shown([shape], "ShaderNodeParticleInfo", output)
    tree.emit(socket(node.outputs, output), PARTICLE[output])
    theirs, ours = render_both(scene, render, samples=64)
    assert theirs.std() > 0.02
    # Edges of turned squares have the noise of both.
    assert rmse(theirs, ours) < 0.1 * theirs.std(), rmse(theirs, ours) / theirs.std()
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.03)
