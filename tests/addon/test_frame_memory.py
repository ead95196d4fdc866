# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory that a frame may take, on systems made of files."""

import numpy as np
import pytest

from addon.frame_memory import largest_geometry, memory_limit

GIB = 1 << 30
UNLIMITED_V1 = str((1 << 63) - 4096)
V2 = "30 29 0:26 / /sys/fs/cgroup rw,nosuid - cgroup2 cgroup2 rw,nsdelegate"
V1 = "36 29 0:32 / /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory"
OTHER = "35 29 0:31 / /sys/fs/cgroup/cpu rw - cgroup cgroup rw,cpu"


@pytest.fixture
def system(tmp_path):
    """system(groups, mounts, {path: text}) -> root of a machine of 8 GiB without swap."""

    def make(groups, mounts, files=()):
        texts = {"proc/meminfo": f"MemTotal: {8 << 20} kB\nMemFree: 1 kB\nHugePages_Total: 0\n"}
        texts |= {"proc/self/cgroup": groups}
        texts |= {"proc/self/mountinfo": "".join(f"{mount}\n" for mount in mounts)}
        for path, text in (texts | dict(files)).items():
            (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / path).write_text(text)
        return tmp_path

    return make


def test_what_was_asked_for_holds_whatever_the_system_has(system):
    found = memory_limit(100_000, system("0::/\n", [V2]))
    assert (found.mebibytes, found.origin) == (100_000, "")


def test_without_a_control_group_it_is_a_share_of_the_machines(system):
    found = memory_limit(root=system("0::/\n", [V2], {"sys/fs/cgroup/memory.max": "max\n"}))
    assert found.mebibytes == 7372  # .9 of 8192
    assert "this machine has" in found.origin


@pytest.mark.parametrize(
    "groups, mounts, files",
    [
        ("0::/job/task\n", [V2], {"job/task/memory.max": 2 * GIB}),
        # An outer group's holds, too: a Slurm job's steps have no limit of their own.
        ("0::/job/task\n", [V2], {"job/task/memory.max": "max", "job/memory.max": 2 * GIB}),
        ("0::/job/task\n", [V2], {"job/task/memory.max": 4 * GIB, "job/memory.max": 2 * GIB}),
        # A container that sees its own group alone, with its path and without.
        ("0::/\n", [V2], {"memory.max": 2 * GIB}),
        ("0::/docker/1\n", [V2.replace(" / ", " /docker/1 ")], {"memory.max": 2 * GIB}),
        ("0::/../1\n", [V2], {"memory.max": 2 * GIB}),
        (
            "5:cpu:/other\n4:memory:/job\n0::/\n",
            [OTHER, V1],
            {"memory/job/memory.limit_in_bytes": 2 * GIB, "cpu/other/memory.max": GIB},
        ),
        (
            "4:cpu,memory:/job\n",
            [V1.replace("rw,memory", "rw,cpu,memory")],
            {
                "memory/memory.limit_in_bytes": UNLIMITED_V1,
                "memory/job/memory.limit_in_bytes": 2 * GIB,
            },
        ),
    ],
)
def test_a_control_groups_limit_holds_where_it_is_less(system, groups, mounts, files):
    files = {f"sys/fs/cgroup/{path}": f"{text}\n" for path, text in files.items()}
    found = memory_limit(root=system(groups, mounts, files))
    assert found.mebibytes == 1843  # .9 of 2048
    assert "the control group may hold" in found.origin


@pytest.mark.parametrize(
    "mount, files, mebibytes",
    [
        (V2, {"memory.max": "max"}, 9 * 1024),
        (V2, {"memory.max": 2 * GIB, "memory.swap.max": "max"}, 4 * 1024),
        (V2, {"memory.max": 2 * GIB, "memory.swap.max": GIB}, 3 * 1024),
        (V2, {"memory.max": 2 * GIB, "memory.swap.max": 0}, 2 * 1024),
        (V1, {"memory/memory.limit_in_bytes": 2 * GIB}, 4 * 1024),
        (
            V1,
            {
                "memory/memory.limit_in_bytes": 2 * GIB,
                "memory/memory.memsw.limit_in_bytes": 3 * GIB,
            },
            3 * 1024,
        ),
    ],
)
def test_swap_counts_as_far_as_a_group_may_have_it(system, mount, files, mebibytes):
    files = {f"sys/fs/cgroup/{path}": f"{text}\n" for path, text in files.items()}
    files["proc/meminfo"] = f"MemTotal: {7 << 20} kB\nSwapTotal: {2 << 20} kB\n"
    found = memory_limit(root=system("4:memory:/\n0::/\n", [mount], files))
    assert found.mebibytes == int(0.9 * mebibytes)


def test_a_mount_of_any_name_is_passed_by(system):
    odd = ["31 30 0:27 / /tmp rw - tmpfs  rw", "32 30 0:28 / /media/a\u2028b rw - ext4 /dev/a rw"]
    root = system("0::/\n", [*odd, V2], {"sys/fs/cgroup/memory.max": f"{2 * GIB}\n"})
    info = root / "proc/self/mountinfo"
    info.write_bytes(b"33 30 0:29 / /media/caf\xe9 rw - ext4 /dev/b rw\n" + info.read_bytes())
    assert memory_limit(root=root).mebibytes == 1843


def test_a_control_groups_limit_above_the_machines_does_not_count(system):
    files = {"sys/fs/cgroup/memory/job/memory.limit_in_bytes": UNLIMITED_V1}
    found = memory_limit(root=system("4:memory:/job\n", [V1], files))
    assert found.mebibytes == 7372


def test_a_system_that_tells_nothing_has_no_limit(tmp_path):
    assert memory_limit(root=tmp_path) is None


def test_the_largest_geometry_is_named_with_its_size():
    def geometry(name, points, **more):
        return {"name": name, "points": np.zeros((1, points, 3), np.float32), **more}

    mesh = geometry("mesh 'Hills'", 1200, face_sizes=np.full(1100, 4, np.int32))
    assert largest_geometry([]) == ""
    assert largest_geometry([geometry("hair 'Fur'", 900), mesh]) == (
        "the largest is mesh 'Hills', 1,100 faces"
    )
    assert largest_geometry([mesh, geometry("hair 'Fur'", 2500)]) == (
        "the largest is hair 'Fur', 2,500 points"
    )
