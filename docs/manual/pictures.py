# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the manual's pictures of motion blur, all or those named, and prints what each one costs.

    blender -b --factory-startup --addons granita --python docs/manual/pictures.py [-- NAME ...]

A pinwheel that turns and a ball that flies through, seen with one setting after another; each strip shows
three values from left to right.
"""

import math
import os
import sys
from pathlib import Path

import bpy
import numpy as np

FOLDER = Path(__file__).parent / "images"
PRESETS = Path(__file__).parents[2] / "addon" / "presets"
WIDTH, HEIGHT = 240, 160
FRAME = 10
COLORS = ((0.9, 0.12, 0.05), (0.95, 0.6, 0.05), (0.05, 0.5, 0.15), (0.03, 0.25, 0.8))


def material(name, color, roughness=0.5):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = next(n for n in made.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    return made


def placed(name, data, location=(0, 0, 0)):
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    bpy.context.scene.collection.objects.link(thing)
    return thing


def mesh(name, vertices, faces, look):
    data = bpy.data.meshes.new(name)
    data.from_pydata(vertices, [], faces)
    data.materials.append(look)
    return data


def drive(thing, path, expression, index):
    thing.driver_add(path, index).driver.expression = expression


def pinwheel():
    hub = placed("Pinwheel", None, (-0.75, 0, 0.3))
    sail = [(0, 0, 0), (0.28, 0.2, 0.05), (1.0, 0.12, 0.25), (0.95, -0.1, 0.0)]
    for i, color in enumerate(COLORS):
        look = material(f"Sail {i}", color)
        blade = placed(f"Sail {i}", mesh(f"Sail {i}", sail, [(0, 1, 2), (0, 2, 3)], look))
        blade.parent, blade.rotation_euler.z = hub, i * math.pi / 2
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.1, segments=32, ring_count=16)
    pin = bpy.context.object
    pin.data.materials.append(material("Pin", (0.9, 0.9, 0.9), 0.2))
    pin.parent, pin.location.z = hub, 0.2
    return hub


def ball():
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, segments=48, ring_count=24)
    thing = bpy.context.object
    thing.name = "Ball"
    for polygon in thing.data.polygons:
        polygon.use_smooth = True
    thing.data.materials.append(material("Ball", (0.85, 0.25, 0.5), 0.3))
    thing.location = (1.0, -0.45, 0.3)
    return thing


def set_stage():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "GRANITA"
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.view_settings.view_transform = "Standard"
    scene.granita.samples = 256
    scene.granita.device = "CPU"
    scene.granita.bounces = "FULL"
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.5
    corners = [(-9, -9, -0.5), (9, -9, -0.5), (9, 9, -0.5), (-9, 9, -0.5)]
    placed("Wall", mesh("Wall", corners, [(0, 1, 2, 3)], material("Wall", (0.3, 0.33, 0.37))))
    stripes = material("Stripe", (0.15, 0.17, 0.2))
    for i in range(-4, 5):
        x = 0.5 * i - 0.02
        bar = [(x, -9, -0.49), (x + 0.04, -9, -0.49), (x + 0.04, 9, -0.49), (x, 9, -0.49)]
        placed(f"Stripe {i}", mesh(f"Stripe {i}", bar, [(0, 1, 2, 3)], stripes))
    drive(pinwheel(), "rotation_euler", "1.1 * (frame - 10) + 0.3", 2)
    drive(ball(), "location", "1.0 + 1.2 * (frame - 10)", 0)
    camera = bpy.data.cameras.new("Camera")
    camera.lens = 50.0
    scene.camera = placed("Camera", camera, (0, 0, 6.0))
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 2.5, 0.1
    placed("Sun", sun).rotation_euler = (0.5, 0.5, 0.0)
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.25, 0.3, 0.4, 1.0)
    scene.world = world
    scene.frame_set(FRAME)
    return scene


def set_position(scene, position):
    owner = scene.render if hasattr(scene.render, "motion_blur_position") else scene.cycles
    owner.motion_blur_position = position


def set_curve(scene, points):
    mapping = scene.render.motion_blur_shutter_curve
    curve = mapping.curves[0]
    while len(curve.points) > 2:
        curve.points.remove(curve.points[1])
    curve.points[0].location, curve.points[-1].location = points[0], points[-1]
    for point in points[1:-1]:
        curve.points.new(*point)
    for point in curve.points:
        point.handle_type = "VECTOR"
    mapping.update()


def shutter(length):
    def change(scene):
        scene.render.use_motion_blur = length > 0.0
        scene.render.motion_blur_shutter = length

    return change


def position(name):
    def change(scene):
        set_position(scene, name)
        scene.render.motion_blur_shutter = 0.6

    return change


def curve(*points):
    def change(scene):
        scene.render.motion_blur_shutter = 1.0
        set_curve(scene, points)

    return change


def steps(number):
    """One sail, by half a turn while the shutter is open."""

    def change(scene):
        scene.render.motion_blur_shutter = 1.0
        scene.granita.motion_steps = number
        wheel = scene.objects["Pinwheel"]
        wheel.driver_remove("rotation_euler", 2)
        drive(wheel, "rotation_euler", "pi * (frame - 10)", 2)
        for i in (1, 2, 3):
            scene.objects[f"Sail {i}"].hide_render = True

    return change


def rolling(duration):
    def change(scene):
        scene.render.motion_blur_shutter = 1.0
        scene.cycles.rolling_shutter_type = "TOP" if duration else "NONE"
        scene.cycles.rolling_shutter_duration = duration

    return change


def sails(blur):
    def change(scene):
        scene.render.motion_blur_shutter = 1.0
        for i in range(4):
            scene.objects[f"Sail {i}"].cycles.use_motion_blur = blur

    return change


def preset(name):
    file = PRESETS / f"{name}.py"
    return lambda _scene: exec(compile(file.read_text(), file, "exec"), {})


# Name of the strip -> [(caption, change of the scene)].
STRIPS = {
    "shutter": [("off", shutter(0.0)), ("0.5", shutter(0.5)), ("1.5", shutter(1.5))],
    "position": [(name.title(), position(name)) for name in ("START", "CENTER", "END")],
    "curve": [
        ("box", curve((0, 1), (1, 1))),
        ("tent", curve((0, 0), (0.5, 1), (1, 0))),
        ("falling", curve((0, 1), (1, 0))),
    ],
    "steps": [(str(number), steps(number)) for number in (3, 5, 17)],
    "rolling": [("off", rolling(0.0)), ("0.5", rolling(0.5)), ("0.05", rolling(0.05))],
    "preset": [(name, preset(name)) for name in ("Preview", "Final")],
    "object": [("all", sails(True)), ("not the sails", sails(False))],
}


def rendered(scene):
    """(float32 [height, width, 4] as displayed, seconds of all processors)."""
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = str(FOLDER / "one.png")
    before = sum(os.times()[:2])
    bpy.ops.render.render(write_still=True)
    seconds = sum(os.times()[:2]) - before
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(WIDTH * HEIGHT * 4, np.float32)
    image.pixels.foreach_get(pixels)
    os.remove(scene.render.filepath)
    return pixels.reshape(HEIGHT, WIDTH, 4), seconds


def save(name, parts):
    gap = np.ones((HEIGHT, 6, 4), np.float32)
    strip = np.concatenate([x for part in parts for x in (part, gap)][:-1], axis=1)
    image = bpy.data.images.new(name, strip.shape[1], HEIGHT)
    image.pixels.foreach_set(np.ascontiguousarray(strip).reshape(-1))
    image.filepath_raw, image.file_format = str(FOLDER / f"motion_{name}.jpg"), "JPEG"
    image.save()


def main():
    FOLDER.mkdir(exist_ok=True)
    after = sys.argv.index("--") + 1 if "--" in sys.argv else len(sys.argv)
    for name in sys.argv[after:] or STRIPS:
        parts = []
        for caption, change in STRIPS[name]:
            scene = set_stage()
            change(scene)
            pixels, seconds = rendered(scene)
            parts.append(pixels)
            print(f"{name:9} {caption:14} {seconds:.2f} s")
        save(name, parts)


if __name__ == "__main__":
    main()
