# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene of sessions, edits of it, and a session that is held against frames alone."""

import numpy as np
import snapshots as s

DOWN = np.diag([1.0, -1.0, -1.0, 1.0])  # shines along +z, away from the camera


def matte(snapshot, color, alpha=None):
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (*color, 1)}}]
    surface = (0, "BSDF")
    if alpha is not None:
        nodes.append({"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1, 1, 1, 1)}})
        mixed = {"Fac": alpha, "Shader": ("LINK", 1, "BSDF"), "Shader_001": ("LINK", 0, "BSDF")}
        nodes.append({"type": "ShaderNodeMixShader", "inputs": mixed})
        surface = (2, "Shader")
    name = f"Matte {len(snapshot['materials'])}"
    snapshot["materials"].append({"name": name, "nodes": nodes, "surface": surface})
    return len(snapshot["materials"]) - 1


def sun(snapshot, world_from_light=DOWN, **extra):
    """The scene's only lamp, straight above it."""
    lamp = {"name": "Sun", "kind": "SUN", "world_from_light": world_from_light[None], "energy": 3.0}
    snapshot["lights"] = [{**lamp, **extra}]


def scene():
    """A floor, a moving card, a subdivided cube, and a strand before them, under a sun with a lens."""
    snapshot = s.perspective((48, 32), 60.0, executor="SIMD", samples=4)
    snapshot["camera"].update(lens_radius=0.02, focus_distance=6.0)
    s.quad(snapshot, s.rectangle(-6, -6, 6, 6, 9.0), matte(snapshot, (0.8, 0.8, 0.8)))
    ends = [s.translation(-0.3), s.translation(0.3)]
    card = s.rectangle(-1.5, -1, 0, 1, 6.0)
    s.quad(snapshot, card, matte(snapshot, (0.9, 0.3, 0.1)), transforms=ends)
    corners = [(x, y, z) for x in (0.3, 1.7) for y in (-0.7, 0.7) for z in (5.3, 6.7)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    cage = {"subdivision": {"scheme": "CATMULL_CLARK"}, "smooth": np.ones(6, np.uint8)}
    s.mesh(snapshot, corners, faces, matte(snapshot, (0.2, 0.5, 0.9)), **cage)
    sun(snapshot)
    return snapshot


def moved_camera(snapshot):
    snapshot["camera"]["world_from_camera"] = s.translation(0.2)[None]


def moved_card(snapshot):
    snapshot["instances"]["world_from_object"][1] = s.translation(-0.5, 0.1)


def bent_card(snapshot):
    points = snapshot["geometries"][1]["points"].copy()
    points[0, 0, 2] += 0.5
    snapshot["geometries"][1]["points"] = points


def see_through_card(snapshot):
    snapshot["instances"]["materials"][1] = matte(snapshot, (0.9, 0.3, 0.1), 0.5)


def other_light(snapshot):
    snapshot["lights"][0]["energy"] = 5.0
    snapshot["lights"][0]["world_from_light"] = s.translation(1.0)[None] @ DOWN


def other_color(snapshot):
    snapshot["materials"][0]["nodes"][0]["inputs"]["Color"] = (0.1, 0.8, 0.1, 1)


def shining_cube(snapshot, strength=1.0):
    nodes = [
        {"type": "ShaderNodeEmission", "inputs": {"Color": (1, 1, 1, 1), "Strength": strength}}
    ]
    snapshot["materials"][2].update(nodes=nodes, surface=(0, "Emission"))


def later_frame(snapshot):
    snapshot["options"]["frame_time"] = 0.0


def other_lens(snapshot):
    snapshot["camera"].update(lens_radius=0.1, focus_distance=9.0)


def slightly_other_lens(snapshot):
    snapshot["camera"].update(lens_radius=0.0201, focus_distance=6.01)


def other_world(snapshot):
    snapshot["world"] = {
        "name": "World",
        "nodes": [{"type": "ShaderNodeBackground", "inputs": {"Color": (0.2, 0.3, 0.9, 1)}}],
        "surface": (0, "Background"),
    }


def unlit_card(snapshot):
    snapshot["lights"][0]["receiver_set"] = 0
    snapshot["instances"]["receives"] = [2**64 - 1, 0, 2**64 - 1]


def without_cube(snapshot):
    for name in ("name", "geometry", "knots", "slots", "materials", "lifespan"):
        del snapshot["instances"][name][2]
    del snapshot["instances"]["world_from_object"][3:]
    del snapshot["geometries"][2]


def displaced_cube(snapshot, height=0.3, color=(0.2, 0.5, 0.9)):
    nodes = [
        {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (*color, 1)}},
        {"type": "ShaderNodeTexNoise", "inputs": {"Scale": 3.0}},
        {
            "type": "ShaderNodeDisplacement",
            "inputs": {"Height": ("LINK", 1, "Fac"), "Midlevel": 0.5, "Scale": height},
        },
    ]
    moved = {"displacement": (2, "Displacement"), "displacement_method": "DISPLACEMENT"}
    snapshot["materials"][2].update(nodes=nodes, surface=(0, "BSDF"), **moved)


class Kept:
    def __init__(self):
        import granita_core

        self.core = granita_core
        self.session = granita_core.Session()

    def picture(self, snapshot, shown=None):
        """float32 [height, width, n] of Combined, or of the pass that is shown."""
        width, height = snapshot["options"]["width"], snapshot["options"]["height"]
        job = self.core.Render(self.core.Scene(s.packed(snapshot), self.session))
        found = None
        while not job.done():
            for tile in job.take_tiles(0.1):
                values = tile.passes[shown] if shown else tile.combined
                if found is None:
                    found = np.zeros((height, width, values.shape[2]), np.float32)
                y, x = tile.y, tile.x
                found[y : y + values.shape[0], x : x + values.shape[1]] = values
        job.finish()
        self.statistics = job.statistics()
        return found

    def follow(self, snapshot):
        """A frame of the snapshot alone, whose picture it makes as well."""
        alone = s.render(snapshot)
        np.testing.assert_array_equal(self.picture(snapshot), alone["combined"])
        return alone

    def made(self):
        return np.array([self.session.geometries_made, self.session.ray_shapes_made])
