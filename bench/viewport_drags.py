# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a drag under Rendered shading is Granita's own: seconds from an edit to its first picture and to the settled
one, in a view that no window draws (viewport.py times a window's).

    ./dev bench viewport_drags [SCENE ...]
"""

import sys

import frames
from measure import save

SCENES = ("lit", "moving", "spheres", "feathers")
EDITS = (
    "shutter",
    "f-stop",
    "focus",
    "lamp strength",
    "lamp color",
    "lamp moved",
    "material color",
    "object moved",
)


def main(names):
    job = {"scenes": names or SCENES, "edits": EDITS, "runs": 9}
    rows = frames.ask("time_viewport.py", job, None)
    print(
        "| scene | edit | first picture | processor | divisor | settled |\n|---|---|---|---|---|---|"
    )
    for row in rows:
        times = f"{row['first']:.3f} | {row['processor']:.3f} | {row['divisor']}"
        print(f"| {row['scene']} | {row['edit']} | {times} | {row['settled']:.2f} |")
    save("viewport_drags", rows)


if __name__ == "__main__":
    main(sys.argv[1:])
