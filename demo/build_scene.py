# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo scene: a knight takes a pawn.

    blender -b --factory-startup --python demo/build_scene.py -- FILE.blend

Everything is made here from demo/assets: skinned figures with textures, turned pieces and a cow as
subdivision surfaces, a swing caught by the shutter, a lens wide open.  One unit is one square of the
board, so the lens is far faster than real ones.
"""

import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import keyframes  # noqa: E402
import textures  # noqa: E402
import turned  # noqa: E402

ASSETS = HERE / "assets"
FRAME = 12
SQUARE = 2.0
CHOP = 19.4  # of the clip: the sword is on its way down
SLOWED = 0.42  # the speed the clip plays at: as made, half a frame of it blurs the sword to nothing
# Blender's glTF importer still asks NumPy for a name that NumPy 1.24 took away.
if "bool" not in vars(np):
    np.bool = bool


def square(column: float, row: float, height: float = 0.0) -> tuple[float, float, float]:
    """The middle of a square; (0, 0) is the knight's."""
    return (column * SQUARE, row * SQUARE, height)


def principled(name: str, **inputs) -> bpy.types.Material:
    """A material of one Principled BSDF; inputs are named as its sockets, underscores for spaces."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    bsdf = material.node_tree.nodes["Principled BSDF"]
    for socket, value in inputs.items():
        bsdf.inputs[socket.replace("_", " ")].default_value = value
    return material


def textured(name: str, image: bpy.types.Image, **inputs) -> bpy.types.Material:
    """The same with an image as its base colour."""
    material = principled(name, **inputs)
    nodes = material.node_tree.nodes
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    bsdf = nodes["Principled BSDF"]
    material.node_tree.links.new(texture.outputs["Color"], bsdf.inputs["Base Color"])
    return material


def import_gltf(file: str) -> list[bpy.types.Object]:
    """Import a file of the assets; every clip muted, smooth objects left as they come."""
    before = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=str(ASSETS / file))
    return [item for item in bpy.data.objects if item not in before]


def pose(objects: list[bpy.types.Object], clip: str, start: float, speed: float = 1.0) -> None:
    """Play one clip of a figure, its frame 0 at `start`, in place of the importer's tracks."""
    animation = next(item for item in objects if item.type == "ARMATURE").animation_data
    animation.action = None
    for track in list(animation.nla_tracks):
        animation.nla_tracks.remove(track)
    strip = animation.nla_tracks.new().strips.new(clip, 0, bpy.data.actions[clip])
    strip.scale = 1 / speed
    strip.frame_start_ui = start


def place(objects: list[bpy.types.Object], location: tuple, turn: float, scale: float) -> None:
    """Set the roots of an import on the board; turn in degrees about z."""
    root = bpy.data.objects.new(objects[0].name + "_place", None)
    bpy.context.scene.collection.objects.link(root)
    root.location = location
    root.rotation_euler.z = math.radians(turn)
    root.scale = (scale,) * 3
    for item in objects:
        if item.parent is None:
            item.parent = root


def add_knight() -> None:
    """The hero, between the top and the bottom of a two-handed chop."""
    objects = import_gltf("knight.glb")
    spare = {
        "1H_Sword", "1H_Sword_Offhand", "Badge_Shield", "Rectangle_Shield", "Round_Shield",
        "Spike_Shield",
    }  # fmt: skip
    for item in [item for item in objects if item.name in spare]:
        objects.remove(item)
        bpy.data.objects.remove(item)
    pose(objects, "2H_Melee_Attack_Chop_Rig", FRAME - CHOP / SLOWED, SLOWED)
    place(objects, square(0, 0), -60, 1.0)
    for material in bpy.data.materials:
        if material.name.startswith("knight"):
            material.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.35


def add_bunny() -> None:
    objects = import_gltf("bunny.gltf")
    pose(objects, "Wave_CharacterArmature", FRAME - 14.0)
    place(objects, square(1.0, 1.7), -20, 0.55)


def add_alien() -> None:
    objects = import_gltf("Alien_Scolitex.gltf")
    pose(objects, "Alien_Idle_Alien_Armature", FRAME - 20.0)
    place(objects, square(-1.55, 3.0), 55, 0.8)


def add_cow() -> None:
    """Spot, the subdivision surface of a thousand papers, in glazed china."""
    bpy.ops.import_scene.obj(filepath=str(ASSETS / "spot_control_mesh.obj"))
    cow = bpy.context.selected_objects[0]
    cow.name = "Spot"
    cow.data.materials.clear()
    china = textured("China", textures.image("Patches", textures.patches(1024)), Roughness=0.12)
    cow.data.materials.append(china)
    cow.data.polygons.foreach_set("use_smooth", [True] * len(cow.data.polygons))
    cow.modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    place([cow], square(0.85, 4.2, 1.0), -50, 1.35)


def add_pieces() -> None:
    boxwood = textured(
        "Boxwood",
        textures.image(
            "BoxwoodGrain", textures.wood(512, 512, (0.7, 0.5, 0.3), (0.92, 0.76, 0.53), 5)
        ),
        Roughness=0.25,
    )
    rosewood = textured(
        "Rosewood",
        textures.image(
            "RosewoodGrain", textures.wood(512, 512, (0.25, 0.07, 0.04), (0.5, 0.2, 0.1), 6)
        ),
        Roughness=0.25,
    )
    white = {
        name: turned.turned_mesh(f"White{name}", profile, boxwood)
        for name, profile in (("Pawn", turned.PAWN), ("Rook", turned.ROOK))
    }
    black = {
        name: turned.turned_mesh(f"Black{name}", profile, rosewood)
        for name, profile in (
            ("Pawn", turned.PAWN),
            ("Rook", turned.ROOK),
            ("Bishop", turned.BISHOP),
        )
    }
    for column, row in ((1.35, -1.6), (2, 1), (-1.75, -2)):
        turned.piece("WhitePawn", white["Pawn"], square(column, row))
    for column, row in ((-3, 2), (-2, 4), (3, 3)):
        turned.piece("BlackPawn", black["Pawn"], square(column, row))
    turned.piece("BlackRook", black["Rook"], square(-3, 4))
    turned.piece("BlackBishop", black["Bishop"], square(3, 4))
    add_taken_pawn(black["Pawn"])


def add_taken_pawn(mesh: bpy.types.Mesh) -> None:
    """The pawn that the sword has just hit, flying and turning."""
    pawn = turned.piece("TakenPawn", mesh, square(-1, -0.4))
    pawn.scale = (0.8,) * 3
    flight = (
        (FRAME - 2, (-2.15, -0.55, 0.75), (0.1, -0.2, 0.0)),
        (FRAME + 2, (-2.75, -0.45, 1.25), (0.35, -0.95, 0.3)),
    )
    for frame, location, rotation in flight:
        pawn.location, pawn.rotation_euler = location, rotation
        pawn.keyframe_insert("location", frame=frame)
        pawn.keyframe_insert("rotation_euler", frame=frame)
    keyframes.make_linear(pawn)


def plane(
    name: str, size: float, location: tuple, material: bpy.types.Material
) -> bpy.types.Object:
    """A square of four vertices in the plane of x and y, its UVs in 0..1."""
    half = size / 2
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(
        [(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [], [(0, 1, 2, 3)]
    )
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
    mesh.materials.append(material)
    result = bpy.data.objects.new(name, mesh)
    result.location = location
    bpy.context.scene.collection.objects.link(result)
    return result


def add_room() -> None:
    board = textured(
        "Board", textures.image("Chessboard", textures.chessboard(8, 256)), Roughness=0.38
    )
    plane("Board", 8 * SQUARE, square(0.5, 1.5), board)
    table = principled("Table", Base_Color=(0.02, 0.014, 0.012, 1), Roughness=0.5)
    plane("Table", 60, (0, 36, -0.6), table)
    wall = principled("Wall", Base_Color=(0.05, 0.09, 0.11, 1), Roughness=0.9)
    backdrop = plane("Wall", 120, (0, 40, 0), wall)
    backdrop.rotation_euler.x = math.radians(90)
    add_lanterns()


def add_lanterns() -> None:
    """Small lamps far behind: what the lens makes discs of."""
    mesh = bpy.data.meshes.new("Lantern")
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh.from_pydata(corners, [], quads)
    mesh.polygons.foreach_set("use_smooth", [True] * 6)
    dice = np.random.default_rng(7)
    for index in range(26):
        tint = (1.0, dice.uniform(0.42, 0.72), dice.uniform(0.12, 0.4), 1)
        copy = mesh.copy()
        copy.materials.append(
            principled(
                f"Lantern{index}",
                Base_Color=(0, 0, 0, 1),
                Emission=tint,
                Emission_Strength=dice.uniform(5, 14),
            )
        )
        x, z = dice.uniform(-17, 17), dice.uniform(1.5, 9)
        lantern = turned.piece(f"Lantern{index}", copy, (x, dice.uniform(24, 34), z))
        lantern.scale = (dice.uniform(0.10, 0.16),) * 3
        lantern.visible_diffuse = lantern.visible_glossy = False  # seen, but no lamps


def add_light(name: str, kind: str, location: tuple, target: tuple, **settings) -> None:
    light = bpy.data.lights.new(name, kind)
    for key, value in settings.items():
        setattr(light, key, value)
    item = bpy.data.objects.new(name, light)
    item.location = location
    aim(item, target)
    bpy.context.scene.collection.objects.link(item)


def aim(item: bpy.types.Object, target: tuple) -> None:
    """Turn an object's -z to a point."""
    direction = Vector(target) - item.location
    item.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()


def light_scene() -> None:
    add_light(
        "Key", "AREA", (-5.5, -6.5, 5.5), (0, 0, 1.0), energy=800, color=(1.0, 0.80, 0.58),
        shape="DISK", size=2.2,
    )  # fmt: skip
    add_light(
        "Rim", "AREA", (5.5, 6.5, 5.5), (0, 0, 1.2), energy=700, color=(0.55, 0.75, 1.0),
        shape="RECTANGLE", size=2.0, size_y=3.0,
    )  # fmt: skip
    world = bpy.data.worlds.new("Studio")
    bpy.context.scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    environment = nodes.new("ShaderNodeTexEnvironment")
    environment.image = bpy.data.images.load(str(ASSETS / "studio.hdr"))
    environment.image.pack()
    links.new(environment.outputs["Color"], nodes["Background"].inputs["Color"])
    nodes["Background"].inputs["Strength"].default_value = 0.35


def add_camera() -> None:
    camera = bpy.data.cameras.new("Camera")
    camera.lens = 50
    camera.dof.use_dof = True
    camera.dof.aperture_fstop = 0.36
    item = bpy.data.objects.new("Camera", camera)
    item.location = (0.3, -9.0, 2.3)
    aim(item, (-0.95, 0, 1.25))
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.camera = item
    # Focus is measured along the axis, not to the point.
    axis = item.rotation_euler.to_matrix() @ Vector((0, 0, -1))
    camera.dof.focus_distance = (Vector((-0.35, -0.5, 1.4)) - item.location).dot(axis)


def set_render(scene: bpy.types.Scene) -> None:
    scene.frame_start = scene.frame_end = FRAME
    scene.frame_set(FRAME)
    scene.render.resolution_x, scene.render.resolution_y = 960, 540
    scene.render.resolution_percentage = 100
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.5
    if hasattr(scene, "granita"):
        # Next to nothing is in focus and the figures are smooth: finer micropolygons would not show.
        scene.granita.dicing_rate = 1.5
    scene.view_settings.view_transform = "Filmic"
    scene.view_settings.look = "Medium High Contrast"


def build() -> None:
    """Make the scene in place of whatever is open."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    add_knight()
    add_bunny()
    add_alien()
    add_cow()
    add_pieces()
    add_room()
    light_scene()
    add_camera()
    set_render(scene)


def main() -> None:
    build()
    target = Path(sys.argv[sys.argv.index("--") + 1]).resolve()
    bpy.ops.wm.save_as_mainfile(filepath=str(target), compress=True)


if __name__ == "__main__":
    main()
