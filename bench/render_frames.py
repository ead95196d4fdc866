# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders one scene in several settings, in turns.  Runs inside Blender, for the benches.

    blender -b --factory-startup --addons granita --python bench/render_frames.py -- JOB.json

JOB: {"module": "scenes", "lit_scenes", "lamp_scenes", "bounced_scenes", "bounced_places", "crowd_scenes", "limit_scenes", "hero_scene", "moving_files", "walk_scene", "opened_files" (the scene is a path), "random_stage" (a seed) or "demo", "scene", "variant" (of moving_files; frames of walk_scene), "folder", "file", "runs", "seed" (of
Cycles; a setting's own comes first), "size" (width and height, the scene's own without), "settings": [{"engine": "CYCLES" or "GRANITA", "samples",
"shutter" (the scene's own without), "at" (a still at this part of the shutter, without blur), "frame" (a still at this one), "bounces" (light is followed so far; none without), "tamed" (with Blender's own clamps), other
properties of scene.granita}]}.  Frame i of the settings is kept as FOLDER/i.exr; FILE lists for each setting its runs as [wall, processor,
bytes]: seconds of the whole frame, export included, and the most that the process has held until then.
"""

import importlib
import json
import resource
import sys
import time
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests" / "images")]
import engines  # noqa: E402

# Modules whose SCENES are frames 0 to 2, blurred as those of scenes.py.
BUILT = (
    "lit_scenes",
    "lamp_scenes",
    "bounced_scenes",
    "bounced_places",
    "crowd_scenes",
    "limit_scenes",
)


def build(job):
    """(scene, frame at which the shutter opens, frames that it stays open)"""
    if job["module"] == "scenes":
        import scenes

        return scenes.SCENES[job["scene"]](), 1, scenes.SHUTTER
    if job["module"] in BUILT:
        import scenes

        return importlib.import_module(job["module"]).SCENES[job["scene"]](), 1, scenes.SHUTTER
    if job["module"] == "hero_scene":
        import hero_scene
        import scenes

        return hero_scene.hero(), 1, scenes.SHUTTER
    if job["module"] == "demo":
        return build_demo()
    if job["module"] in ("opened_files", "random_stage"):
        return importlib.import_module(job["module"]).build(job["scene"])
    if job["module"] == "walk_scene":
        import walk_scene

        return walk_scene.build(job["scene"], job["variant"]), 1, 0.0
    import moving_files

    return moving_files.build(job["scene"], job["variant"])


def build_demo():
    sys.path.insert(0, str(HERE.parent / "demo"))
    import build_scene

    build_scene.build()
    scene = bpy.context.scene
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    shutter = scene.render.motion_blur_shutter
    return scene, scene.frame_current - shutter / 2, shutter


def build_once(job):
    """As build; the scene of the job's file where that is there."""
    path = job.get("blend")
    if path is None:
        return build(job)
    if not Path(path).exists():
        scene, opens, shutter = build(job)
        scene["opens"], scene["shutter"] = float(opens), float(shutter)
        bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    scene = bpy.context.scene
    return scene, scene["opens"], scene["shutter"]


def main():
    job = json.loads(Path(sys.argv[sys.argv.index("--") + 1]).read_text())
    scene, opens, shutter = build_once(job)
    if "size" in job:
        engines.set_size(scene, *job["size"])
    seconds = [[] for _ in job["settings"]]
    for _ in range(job["runs"]):
        for index, setting in enumerate(job["settings"]):
            setting = dict(setting)
            engine, samples = setting.pop("engine"), setting.pop("samples")
            open_for = setting.pop("shutter", shutter)
            at, bounces = setting.pop("at", None), setting.pop("bounces", 0)
            tamed = setting.pop("tamed", False)
            seed = setting.pop("seed", job.get("seed", 0))
            begins, open_for = (opens, open_for) if at is None else (opens + at * open_for, 0.0)
            begins = setting.pop("frame", begins)
            if engine == "CYCLES":
                engines.set_cycles(scene, samples, seed)
            else:
                engines.set_granita(scene, samples, **setting)
            if bounces:
                engines.set_bounces(scene, bounces, tamed)
            engines.set_motion(scene, engine, begins, open_for)
            bpy.context.view_layer.update()
            processor = time.process_time()
            wall = engines.render(scene, Path(job["folder"]) / f"{index}.exr")
            taken = time.process_time() - processor
            most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
            seconds[index].append([wall, taken, most])
    Path(job["file"]).write_text(json.dumps(seconds))


if __name__ == "__main__":
    main()
