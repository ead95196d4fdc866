# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes of limits.py, built inside Blender: more of one thing than an artist has."""

import math
import shutil

import bpy
import crowd_scenes
import frames
import hero_scene
import lit_scenes
import numpy as np
import scenes
from figure_files import write_png


def lit(width, tilt=0.0, place=(0, 0, 20), focal=None):
    """An empty file under a sun, on all cores."""
    scene = scenes.empty(width)
    scene.render.threads_mode = "AUTO"
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, math.radians(0.5)
    scenes.add(scene, "Sun", sun).rotation_euler = (0.6, 0.5, 0.0)
    scenes.add_camera(scene, place, focal=focal, tilt=tilt)
    return scene


def clay():
    return scenes.material("Clay", "ShaderNodeBsdfDiffuse", (0.8, 0.6, 0.4))


def plane(scene, name, size, place, surface):
    """A square with UVs."""
    item = lit_scenes.plane(scene, name, surface, size / 2, place)
    item.data.uv_layers.new()
    return item


def moving_things():
    """100,000 things of 100 faces that move by a metre."""
    scene = lit(960, math.radians(67), (0, -72, 30), focal=50)
    mesh = crowd_scenes.sheet(10, 0.35, 1)
    mesh.materials.append(clay())
    owner = crowd_scenes.scatter(scene, mesh, 100_000, 45.0, 2)
    scenes.animate(owner, "location", 0, 1.0)
    scene.frame_set(1)
    return scene


def hairs():
    """A million child hairs on a ball."""
    scene = lit(480)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=2.5)
    ball = bpy.context.object
    ball.data.materials.append(clay())
    settings = ball.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type = "HAIR"
    settings.count, settings.hair_length = 10_000, 1.0
    settings.child_type = "SIMPLE"
    settings.rendered_child_count = 100
    settings.root_radius, settings.radius_scale = 1.0, 0.004
    return scene


def textured_planes(columns, count, size, step, side):
    """Planes in rows, each with a PNG of its own, of side x side texels."""
    folder = frames.CACHE / "limits" / str(side)
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"{i}.png" for i in range(count)]
    if not files[-1].exists():
        noise = np.random.default_rng(3).integers(96, 160, (side, side, 3))
        write_png(files[0], noise.astype(np.uint8))
        for file in files[1:]:
            shutil.copy(files[0], file)
    scene = lit(960)
    rows = count // columns
    for i, file in enumerate(files):

        def textured(tree, node, file=file):
            image = tree.nodes.new("ShaderNodeTexImage")
            image.image = bpy.data.images.load(str(file))
            tree.links.new(image.outputs["Color"], node.inputs["Color"])
            return node.outputs[0]

        surface = scenes.material(file.stem, "ShaderNodeBsdfDiffuse", (1, 1, 1), textured)
        place = i % columns - (columns - 1) / 2, i // columns - rows / 2 + 0.5
        plane(scene, file.stem, size, (step * place[0], step * place[1], 0), surface)
    return scene


def textures():
    """40 planes with a PNG of 4096 x 4096 each."""
    return textured_planes(8, 40, 1.7, 1.85, 4096)


def many_textures():
    """2,000 planes with a PNG of 256 x 256 each."""
    return textured_planes(50, 2000, 0.27, 0.3, 256)


def ngon():
    """One face of 100,000 corners."""
    scene = lit(480)
    angle = np.linspace(0, 2 * math.pi, 100_000, endpoint=False)
    radius = 3.5 + 0.8 * np.sin(60 * angle)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)
    mesh = bpy.data.meshes.new("Gear")
    mesh.from_pydata(points.tolist(), [], [range(len(points))])
    mesh.materials.append(clay())
    scenes.add(scene, "Gear", mesh)
    return scene


def nodes():
    """One tree of 2,000 nodes: noises that are mixed in turn."""
    scene = lit(480)

    def chain(tree, node):
        last = None
        for i in range(1000):
            noise = tree.nodes.new("ShaderNodeTexNoise")
            noise.inputs["Scale"].default_value = 1 + 0.01 * i
            noise.inputs["Detail"].default_value = 0.0
            mix = tree.nodes.new("ShaderNodeMixRGB")
            mix.inputs["Fac"].default_value = 0.3
            tree.links.new(noise.outputs["Color"], mix.inputs["Color2"])
            if last:
                tree.links.new(last, mix.inputs["Color1"])
            last = mix.outputs["Color"]
        tree.links.new(last, node.inputs["Color"])
        return node.outputs[0]

    surface = scenes.material("Chain", "ShaderNodeBsdfDiffuse", (1, 1, 1), chain)
    plane(scene, "Plane", 12, (0, 0, 0), surface)
    return scene


def faces():
    """A mesh of 5 M faces."""
    scene = lit(960)
    across, up = np.meshgrid(np.linspace(-8, 8, 2800), np.linspace(-4.5, 4.5, 1800))
    mesh = hero_scene.grid_mesh(
        "Land", np.stack([across, up, 0.2 * np.sin(9 * across) * np.sin(7 * up)], axis=-1)
    )
    mesh.materials.append(clay())
    scenes.add(scene, "Land", mesh)
    return scene


def displaced_faces():
    """2 M faces, a third of a pixel each, that a noise moves; seen at an angle."""
    scene = lit(480, math.radians(66), (0, -16, 7))
    side = np.linspace(-10, 10, 1415)
    across, up = np.meshgrid(side, side)
    mesh = hero_scene.grid_mesh("Hills", np.stack([across, up, 0 * up], axis=-1))
    surface = clay()
    surface.cycles.displacement_method = "DISPLACEMENT"
    tree = surface.node_tree
    place = tree.nodes.new("ShaderNodeTexCoord").outputs["Object"]
    noise, moved = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexNoise", "Displacement"))
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 0.6, 6.0
    moved.inputs["Scale"].default_value = 2.0
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(place, noise.inputs["Vector"])
    tree.links.new(noise.outputs["Fac"], moved.inputs["Height"])
    tree.links.new(moved.outputs["Displacement"], output.inputs["Displacement"])
    mesh.materials.append(surface)
    scenes.add(scene, "Hills", mesh)
    return scene


def tiles(faces_a_pixel):
    """The frame covered by tiles of 10,000 faces: a pixel holds so many."""
    scene = lit(480)
    size = math.sqrt(10_000 / faces_a_pixel) * scenes.pixel(scene)
    mesh = crowd_scenes.sheet(100, size, 1)
    mesh.materials.append(clay())
    columns, rows = math.ceil(16 / size) + 1, math.ceil(9 / size) + 1
    carrier = bpy.data.meshes.new("Places")
    x, y = np.meshgrid(np.arange(columns) - columns / 2, np.arange(rows) - rows / 2)
    places = size * np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    carrier.from_pydata(places.tolist(), [], [])
    owner = scenes.add(scene, "Places", carrier)
    owner.instance_type = "VERTS"
    scenes.add(scene, "Tile", mesh).parent = owner
    return scene


def balls(width, height):
    """Small balls of a matte material, all over the frame."""
    scene = lit(width)
    scene.render.resolution_y = height
    scenes.add_spheres(scene, "ShaderNodeBsdfDiffuse", None, (-7, -7, -5), (7, 7, 5))
    return scene


def values():
    """200 AOVs, a colour and a value by turns."""
    scene = balls(480, 270)
    layer = scene.view_layers[0]
    for i in range(200):
        aov = layer.aovs.add()
        aov.name, aov.type = f"aov{i}", ("COLOR", "VALUE")[i % 2]
    trees = {item.active_material.node_tree for item in scene.objects if item.active_material}
    for tree in trees:
        for i in range(200):
            output = tree.nodes.new("ShaderNodeOutputAOV")
            # Until Blender 4.2 it is the name of the node.
            setattr(output, "aov_name" if hasattr(output, "aov_name") else "name", f"aov{i}")
            output.inputs["Color"].default_value = (i / 200, 0.5, 0.1, 1)
            output.inputs["Value"].default_value = i / 200
    return scene


def layers():
    """50 view layers of the same things."""
    scene = balls(480, 270)
    for i in range(49):
        scene.view_layers.new(f"Layer{i}")
    return scene


SCENES = {
    "100,000 things of 100 faces that move": moving_things,
    "1 M hairs": hairs,
    "40 textures of 4096 x 4096": textures,
    "2,000 textures of 256 x 256": many_textures,
    "n-gon of 100,000 corners": ngon,
    "2,000 nodes": nodes,
    "5 M faces": faces,
    "2 M faces that are displaced": displaced_faces,
    "4 faces a pixel": lambda: tiles(4),
    "700 faces a pixel": lambda: tiles(700),
    "200 AOVs": values,
    "50 view layers": layers,
    "8192 x 8192 pixels": lambda: balls(8192, 8192),
    "16384 x 16384 pixels": lambda: balls(16384, 16384),
}
