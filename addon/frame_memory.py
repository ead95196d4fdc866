# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory that a frame may take, and what of the scene is largest where that does not suffice.

Nothing here needs Blender.
"""

from dataclasses import dataclass
from math import inf
from pathlib import Path

# Of what the kernel gives before it kills: the rest is for what a process takes between two looks,
# its files' pages and the kernel's own.
SHARE = 0.9


@dataclass
class MemoryLimit:
    mebibytes: int
    origin: str  # in words for an artist; "" where it was asked for


def memory_limit(asked=None, root="/"):
    """The MemoryLimit of a frame, or None where the system does not tell.

    Args:
        asked: MiB, by the command line; None: a share of what the machine has, or of what the process's control
            group (cgroups(7), of either version) or one around it may hold where that is less.  Swap counts: swapped
            out, a frame is slow and not lost.
        root: folder that has `proc` and `sys`.
    """
    if asked is not None:
        return MemoryLimit(asked, "")
    root = Path(root)
    memory, swap = _machine_bytes(root)
    found = [("this machine has", memory + swap)]
    found += [("the control group may hold", size) for size in _group_bytes(root, swap)]
    owner, size = min(found, key=lambda pair: pair[1])
    if size == inf:
        return None
    origin = f"the limit is {SHARE:.0%} of what {owner}, --granita-memory sets another"
    return MemoryLimit(max(1, int(size * SHARE) >> 20), origin)


def largest_geometry(geometries):
    """In words, that of a snapshot's geometries which has most points; "" where there is none."""
    if not geometries:
        return ""
    largest = max(geometries, key=lambda geometry: geometry["points"].size)
    return f"the largest is {largest['name']}, {_count(largest)}"


def largest_mesh(depsgraph):
    """The same of a depsgraph's meshes, before there is a snapshot."""
    meshes = [item for item in depsgraph.objects if item.type == "MESH"]
    if not meshes:
        return ""
    largest = max(meshes, key=lambda item: len(item.data.polygons))
    return f"the largest is object '{largest.name}', {len(largest.data.polygons):,} faces"


def _count(geometry):
    if geometry.get("face_sizes") is not None:
        return f"{len(geometry['face_sizes']):,} faces"
    return f"{geometry['points'].shape[-2]:,} points"


def _machine_bytes(root):
    """(memory, swap)"""
    words = [line.split() for line in _lines(root / "proc/meminfo")]
    sizes = {line[0]: int(line[1]) << 10 for line in words if len(line) == 3}
    return sizes.get("MemTotal:", inf), sizes.get("SwapTotal:", 0)


def _group_bytes(root, swap):
    """Limits, innermost first, with what a group may have of the machine's `swap`."""
    for folder in _group_folders(root):
        yield _size(folder / "memory.max") + min(swap, _size(folder / "memory.swap.max"))
        both = _size(folder / "memory.memsw.limit_in_bytes")
        yield min(both, _size(folder / "memory.limit_in_bytes") + swap)


def _size(path):
    """Infinite where there is no such file, or "max" in it; more than any machine has where version 1 has none."""
    return next((int(line) for line in _lines(path) if line.isdigit()), inf)


def _group_folders(root):
    """Of the control groups that hold this process, as far out as they are seen from here."""
    groups = {}
    for line in _lines(root / "proc/self/cgroup"):
        _, controllers, path = line.split(":", 2)
        groups.update((controller, Path(path)) for controller in controllers.split(","))
    for line in _lines(root / "proc/self/mountinfo"):
        mount, _, system = line.partition(" - ")
        kind, *_, options = system.split(" ")
        if kind == "cgroup2":
            group = groups.get("")
        elif kind == "cgroup" and "memory" in options.split(","):
            group = groups.get("memory")
        else:
            continue
        top, place = mount.split(" ")[3:5]
        # A container may see its own group alone, under a path that it does not know.
        known = group is not None and group.is_relative_to(top)
        inner = group.relative_to(top) if known else Path()
        for around in (inner, *inner.parents):
            yield root / place.lstrip("/") / around


def _lines(path):
    """Names of mounts may hold any byte but the end of a line."""
    try:
        return path.read_bytes().decode("utf-8", "surrogateescape").split("\n")[:-1]
    except OSError:
        return []
