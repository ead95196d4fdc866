# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the demo scene, render it with Granita, say where the picture is and where the time went.

render.py OUT      writes OUT/demo.blend, OUT/demo.png and OUT/demo.json (`./dev demo`)
"""

import json
import re
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "addon"))
from export.base.report import lines  # noqa: E402  the add-on's part that needs no Blender

STATUS = re.compile(r"\bSample (\d+)/(\d+)")


def blender(arguments: list[str]) -> list[str]:
    return ["blender", "-b", "--factory-startup", "--addons", "granita", *arguments]


def build_scene(file: Path) -> None:
    """Make the .blend, quietly unless it fails."""
    script = ["--python-exit-code", "1", "--python", str(HERE / "build_scene.py")]
    done = subprocess.run(
        blender([*script, "--", str(file)]),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode:
        sys.exit(f"{done.stdout}\nthe demo scene could not be built")


def show_progress(done: int, total: int, width: int = 40) -> None:
    """A bar that redraws itself on a terminal, and nothing but a few lines elsewhere."""
    filled = width * done // max(total, 1)
    bar = f"[{'#' * filled}{'.' * (width - filled)}] {done}/{total} buckets"
    if sys.stdout.isatty():
        print("\r" + bar, end="", flush=True)
    else:
        print(bar, flush=True)


def render(file: Path, picture: Path, statistics: Path) -> None:
    """Render the one frame of the file; Blender's own words are shown only if it fails."""
    statistics.unlink(missing_ok=True)
    frame = picture.with_name(picture.stem + "_####")
    command = blender([str(file), "-E", "GRANITA", "-o", str(frame), "-F", "PNG", "-f", "12"])
    command += ["--", "--granita-stats", str(statistics)]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace"
    )
    lines = []
    for line in process.stdout:
        lines.append(line)
        if status := STATUS.search(line):
            show_progress(int(status[1]), int(status[2]))
    written = picture.with_name(f"{picture.stem}_0012.png")
    if process.wait() or not written.exists():
        sys.exit("".join(lines[-40:]) + "\nthe demo did not render")
    if sys.stdout.isatty():
        print()
    written.replace(picture)


def report(statistics: Path, picture: Path, build_seconds: float) -> None:
    frame = json.loads(statistics.read_text().splitlines()[-1])
    print(f"\n{picture}\n")
    print(
        f"{frame['width']} x {frame['height']}, {frame['samples']} samples a pixel, {frame['device']}"
    )
    seconds = {"scene built": build_seconds, **frame["seconds"]}
    for name, value in seconds.items():
        print(f"  {name:<24}{value:8.2f} s")
    stages = {
        name.removeprefix("seconds_"): value
        for name, value in frame["statistics"].items()
        if name.startswith("seconds_")
    }
    if stages:
        print("of the render, summed over threads")
        for name, value in sorted(stages.items(), key=lambda stage: -stage[1]):
            print(f"  {name:<24}{value:8.2f} s")
    for line in lines([(w["datablock"], w["message"], w["count"]) for w in frame["warnings"]]):
        print(f"note: {line}")


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    out = Path(sys.argv[1]).resolve()
    scene, picture, statistics = (out / f"demo.{ending}" for ending in ("blend", "png", "json"))
    begin = time.monotonic()
    print("Building the scene", flush=True)
    build_scene(scene)
    build_seconds = time.monotonic() - begin
    render(scene, picture, statistics)
    report(statistics, picture, build_seconds)


main()
