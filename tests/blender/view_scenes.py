# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of all that a picture may hold, and edits of each kind, for views that are held against F12."""

import bpy
import scene_parts as parts


def _sphere(name, material, location=(0, 0, 0), radius=1.0, levels=0):
    bpy.ops.mesh.primitive_uv_sphere_add(
        segments=12, ring_count=8, radius=radius, location=location
    )
    ball = bpy.context.object
    ball.name = name
    bpy.ops.object.shade_smooth()
    ball.data.materials.append(material)
    if levels:
        ball.modifiers.new("Subdivision", "SUBSURF").levels = levels
        ball.modifiers["Subdivision"].render_levels = levels
    return ball


def _lamp(kind, energy, location, **settings):
    bpy.ops.object.light_add(type=kind, location=location)
    lamp = bpy.context.object.data
    lamp.energy = energy
    for name, value in settings.items():
        setattr(lamp, name, value)
    return bpy.context.object


def _slides(thing, way):
    """Through frame 3, at which the scene then stands: F12 shows what is keyed."""
    place = thing.location.copy()
    thing.keyframe_insert("location", frame=1)
    thing.location = place + thing.location.__class__(way)
    thing.keyframe_insert("location", frame=5)
    bpy.context.scene.frame_set(3)


def _room(scene):
    """A floor, a wall, a lamp and a world, a camera with a lens that moves, an open shutter."""
    camera = parts.add_camera(scene, (0, 0, 8))
    camera.data.dof.use_dof = True
    camera.data.dof.focus_distance, camera.data.dof.aperture_fstop = 8.0, 0.2
    _slides(camera, (0.3, 0, 0))
    grey = parts.closure("Grey", "ShaderNodeBsdfDiffuse", Color=(0.6, 0.6, 0.6, 1))
    parts.add_square(scene, "Wall", 12.0, (0, 0, -2), grey)
    _lamp("AREA", 300.0, (2, 3, 5), size=1.0).name = "Lamp"
    bpy.data.objects["Lamp"].rotation_euler = (-0.5, 0.35, 0)
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.3, 0.5, 1)
    scene.render.use_motion_blur = True
    scene.granita.samples = scene.granita.preview_samples = 4
    scene.granita.light_samples = 4
    return grey


def _fill_world(scene, shader, density):
    tree = scene.world.node_tree
    mist = tree.nodes.new(shader)
    mist.inputs["Density"].default_value = density
    output = next(n for n in tree.nodes if n.type == "OUTPUT_WORLD")
    tree.links.new(mist.outputs[0], output.inputs["Volume"])


def bounced(scene):
    """Light from glass, a mirror, a coloured wall and a mesh that shines."""
    _room(scene)
    scene.granita.bounces = "FULL"
    glass = parts.closure("Glass", "ShaderNodeBsdfGlass", Roughness=0.0, IOR=1.4)
    mirror = parts.closure("Mirror", "ShaderNodeBsdfGlossy", Roughness=0.1)
    red = parts.closure("Subject", "ShaderNodeBsdfPrincipled", Roughness=0.4)
    red.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.8, 0.1, 0.1, 1)
    _slides(_sphere("Thing", red, (-1.2, 0, 0)), (0.4, 0.2, 0))
    _sphere("Glass", glass, (1.0, 0.6, 0.5), 0.8)
    _sphere("Mirror", mirror, (0.8, -1.2, 0), 0.9)
    parts.add_square(
        scene, "Panel", 0.6, (-1.5, 1.8, 0.4), parts.emission("Panel", (1, 0.7, 0.3), 4.0)
    )


def filled(scene):
    """Smoke that varies in a cube, mist in the world, a spot through both."""
    _room(scene)
    scene.granita.bounces = "FAST"
    material, nodes, links, output = parts.node_material("Subject")
    volume = nodes.new("ShaderNodeVolumePrincipled")
    noise = nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 2.0
    links.new(noise.outputs["Fac"], volume.inputs["Density"])
    links.new(volume.outputs[0], output.inputs["Volume"])
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(-0.5, 0, 0), rotation=(0.4, 0.3, 0.2))
    bpy.context.object.name = "Thing"
    bpy.context.object.data.materials.append(material)
    _slides(bpy.context.object, (0.4, 0.2, 0))
    ball = parts.closure("Ball", "ShaderNodeBsdfDiffuse", Color=(0.1, 0.6, 0.2, 1))
    _sphere("Ball", ball, (1.3, -0.5, 0.2), 0.7)
    _lamp("SPOT", 500.0, (0, 0, 6), spot_size=0.6)
    _fill_world(scene, "ShaderNodeVolumeScatter", 0.02)


def skin(scene):
    """Light below bumpy surfaces, one of a cage."""
    _room(scene)
    material, nodes, links, output = parts.node_material("Subject")
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    weight = "Subsurface" if "Subsurface" in shader.inputs else "Subsurface Weight"
    shader.inputs[weight].default_value = 0.8
    shader.inputs["Subsurface Radius"].default_value = (0.4, 0.2, 0.1)
    shader.inputs["Base Color"].default_value = (0.8, 0.5, 0.4, 1)
    bump, noise = nodes.new("ShaderNodeBump"), nodes.new("ShaderNodeTexNoise")
    bump.inputs["Strength"].default_value = 0.4
    links.new(noise.outputs["Fac"], bump.inputs["Height"])
    links.new(bump.outputs[0], shader.inputs["Normal"])
    links.new(shader.outputs[0], output.inputs["Surface"])
    _slides(_sphere("Thing", material, (-0.9, 0, 0), 1.2, levels=1), (0.3, 0.1, 0))
    wax = parts.closure("Wax", "ShaderNodeSubsurfaceScattering", Color=(0.9, 0.8, 0.3, 1))
    _sphere("Wax", wax, (1.2, 0.5, 0.3), 0.8)


def strands(scene):
    """Hair of particles on a ball, lit by a sun."""
    _room(scene)
    hair = parts.closure("Subject", "ShaderNodeBsdfHairPrincipled", Roughness=0.4)
    skin_of = parts.closure("Skin", "ShaderNodeBsdfDiffuse", Color=(0.5, 0.3, 0.2, 1))
    ball = _sphere("Thing", skin_of)
    ball.data.materials.append(hair)
    settings = ball.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count, settings.hair_length = "HAIR", 60, 0.8
    settings.material = 2
    settings.root_radius = 4.0
    settings.display_step = settings.render_step  # else a view has coarser hair
    _slides(ball, (0.4, 0.2, 0))
    _lamp("SUN", 2.0, (0, 0, 4), angle=0.1)


def instanced(scene):
    """A collection with a lamp in it, placed three times, and balls as the particles of a square."""
    grey = _room(scene)
    leaf = parts.closure("Subject", "ShaderNodeBsdfTranslucent", Color=(0.2, 0.7, 0.1, 1))
    leaves = bpy.data.collections.new("Leaves")
    thing = _sphere("Thing", leaf, (0, 0, 0), 0.5)
    spark = _lamp("POINT", 20.0, (0, 0, 1))
    for each in (thing, spark):
        scene.collection.objects.unlink(each)
        leaves.objects.link(each)
    for k in range(3):
        place = parts.add_object(scene, f"Place {k}", None, (k * 1.5 - 1.5, 0.8, 0.3 * k))
        place.instance_type, place.instance_collection = "COLLECTION", leaves
    _slides(bpy.data.objects["Place 1"], (0.3, 0.3, 0))
    base = parts.add_square(scene, "Base", 2.5, (0, -1.5, 0))
    system = base.modifiers.new("Beads", "PARTICLE_SYSTEM").particle_system.settings
    system.count, system.frame_start, system.frame_end = 8, 1, 1
    system.lifetime, system.physics_type = 100, "NO"
    system.render_type, system.particle_size = "OBJECT", 0.3
    system.instance_object = _sphere("Bead", grey, (1.5, -1.5, 0), 0.5)


SCENES = (bounced, filled, skin, strands, instanced)


# ---- edits ----------------------------------------------------------------------------------


def _thing():
    return bpy.data.objects["Thing"]


def _first_shader():
    nodes = bpy.data.materials["Subject"].node_tree.nodes
    names = ("BSDF", "PRINCIPLED_VOLUME", "SUBSURFACE")
    return next(n for n in nodes if n.type.startswith(names))


def _recolor(scene):
    node = _first_shader()
    socket = next(s for s in node.inputs if s.type == "RGBA")
    if socket.is_linked:
        bpy.data.materials["Subject"].node_tree.links.remove(socket.links[0])
    socket.default_value = (0.1, 0.4, 0.9, 1)


def _other_shader(scene):
    """The thing becomes something else altogether."""
    made = parts.closure("Other", "ShaderNodeEmission", Color=(0.3, 0.9, 0.4, 1), Strength=2.0)
    _thing().material_slots[-1].material = made


def _see_through(scene):
    tree = _thing().material_slots[-1].material.node_tree
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    mix = tree.nodes.new("ShaderNodeMixShader")
    if output.inputs["Surface"].links:
        tree.links.new(output.inputs["Surface"].links[0].from_socket, mix.inputs[1])
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


def _smoke(scene):
    """What fills the thing: denser, or for the first time."""
    tree = _thing().material_slots[-1].material.node_tree
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    smoke = tree.nodes.new("ShaderNodeVolumeAbsorption")
    smoke.inputs["Density"].default_value = 0.7
    smoke.inputs["Color"].default_value = (0.2, 0.9, 0.5, 1)
    tree.links.new(smoke.outputs[0], output.inputs["Volume"])


def _dent(scene):
    _thing().data.vertices[0].co.z += 0.8
    _thing().data.update()


def _paint(scene):
    image = bpy.data.images.get("Sky") or bpy.data.images.new("Sky", 4, 4)
    image.pixels.foreach_set([0.05 * (k % 17) for k in range(len(image.pixels))])
    image.update()
    tree = scene.world.node_tree
    if not any(n.type == "TEX_ENVIRONMENT" for n in tree.nodes):
        sky = tree.nodes.new("ShaderNodeTexEnvironment")
        sky.image = image
        tree.links.new(sky.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def _curve(scene):
    curve = scene.render.motion_blur_shutter_curve.curves[0]
    curve.points[0].location.y = 0.1


def _add(scene):
    _sphere("New", bpy.data.materials["Grey"], (0.3, 1.6, 1.0), 0.4)


def _duplicate(scene):
    scene.collection.objects.link(_thing().copy())


def _limits(scene):
    if hasattr(scene, "cycles"):
        scene.cycles.max_bounces, scene.cycles.glossy_bounces = 3, 1
        scene.cycles.sample_clamp_indirect = 0.0


def _background(scene):
    node = scene.world.node_tree.nodes["Background"]
    node.inputs["Strength"].default_value = 2.5


def _position(scene):
    owner = scene.render if hasattr(scene.render, "motion_blur_position") else scene.cycles
    owner.motion_blur_position = "START"


def _lamp_data():
    return bpy.data.objects["Lamp"].data


def _move_lamp(scene):
    bpy.data.objects["Lamp"].location.x -= 2.5


def _hide_lamp(scene):
    bpy.data.objects["Lamp"].hide_viewport = bpy.data.objects["Lamp"].hide_render = True


def _delete(scene):
    bpy.data.objects.remove(bpy.data.objects["Wall"])


def _parent(scene):
    _thing().parent = bpy.data.objects["Lamp"]


def _set(owner, name, value):
    return lambda scene: setattr(owner(scene), name, value)


def _lens(scene):
    return scene.camera.data


EDITS = {
    "lamp strength": _set(lambda s: _lamp_data(), "energy", 150.0),
    "lamp colour": _set(lambda s: _lamp_data(), "color", (1, 0.3, 0.2)),
    "lamp moved": _move_lamp,
    "lamp size": _set(lambda s: _lamp_data(), "size", 0.2),
    "lamp type": _set(lambda s: _lamp_data(), "type", "POINT"),
    "world strength": _background,
    "world image": _paint,
    "colour": _recolor,
    "shutter": _set(lambda s: s.render, "motion_blur_shutter", 1.3),
    "shutter curve": _curve,
    "shutter position": _position,
    "f-stop": _set(lambda s: _lens(s).dof, "aperture_fstop", 0.6),
    "focus": _set(lambda s: _lens(s).dof, "focus_distance", 6.0),
    "blades": _set(lambda s: _lens(s).dof, "aperture_blades", 5),
    "light samples": _set(lambda s: s.granita, "light_samples", 6),
    "filter": _set(lambda s: s.granita, "filter_width", 2.0),
    "film": _set(lambda s: s.render, "film_transparent", True),
    "limits": _limits,
    "frame": lambda s: s.frame_set(4),
    "thing moved": lambda s: setattr(_thing(), "rotation_euler", (0.2, 0.9, 0.1)),
    "thing unseen by the camera": lambda s: setattr(_thing(), "visible_camera", False),
    "thing seen again": lambda s: setattr(_thing(), "visible_camera", True),
    "thing without shadow": lambda s: setattr(_thing(), "visible_shadow", False),
    "thing held out": lambda s: setattr(_thing(), "is_holdout", True),
    "thing no more held out": lambda s: setattr(_thing(), "is_holdout", False),
    "dent": _dent,
    "see-through": _see_through,
    "smoke": _smoke,
    "mist": lambda s: _fill_world(s, "ShaderNodeVolumeAbsorption", 0.05),
    "added": _add,
    "duplicated": _duplicate,
    "other shader": _other_shader,
    "parented": _parent,
    "camera angle": lambda s: setattr(_lens(s), "lens", 35.0),
    "camera moved": lambda s: setattr(s.camera, "rotation_euler", (0.05, 0.02, 0.1)),
    "no lens": lambda s: setattr(_lens(s).dof, "use_dof", False),
    "no blur": lambda s: setattr(s.render, "use_motion_blur", False),
    "deleted": _delete,
    "seed": _set(lambda s: s.granita, "seed", 7),
    "regular": _set(lambda s: s.granita, "sampling", "REGULAR"),
    "noise threshold": _set(lambda s: s.granita, "noise_threshold", 0.1),
    "dicing rate": _set(lambda s: s.granita, "dicing_rate", 2.0),
    "no lamp": _hide_lamp,
    "no bounces": _set(lambda s: s.granita, "bounces", "NONE"),
    "bounces": _set(lambda s: s.granita, "bounces", "FULL"),
}
