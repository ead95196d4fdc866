# SPDX-License-Identifier: GPL-3.0-or-later
"""A control group (cgroups(7), of either version) inside the one that this process is in, with a limit of memory."""

import os
import subprocess
import time
from pathlib import Path

ROOT = Path("/sys/fs/cgroup")
# Of each version: the limit, and where "oom_kill" is counted.
NAMES = {
    1: ("memory.limit_in_bytes", "memory.oom_control"),
    2: ("memory.max", "memory.events"),
}
# In the group from the first, its own shell included.
ENTER = 'echo $$ >"$0/cgroup.procs" && exec "$@"'


class MemoryGroup:
    """Between `with` and its end.  Raises OSError where this process may not make one."""

    def __init__(self, limit):
        """`limit`: bytes, of which none are swapped."""
        self.version, parent = _own_group()
        self.folder = parent / f"granita_test_{os.getpid()}"
        self.limit = limit

    def __enter__(self):
        self.folder.mkdir()
        try:
            self._file(0).write_text(str(self.limit))
            if self.version == 2 and (swap := self.folder / "memory.swap.max").exists():
                swap.write_text("0")
        except OSError:
            self.folder.rmdir()
            raise
        return self

    def __exit__(self, *_):
        for _ in range(50):  # the kernel is a moment behind the end of its last process
            try:
                return self.folder.rmdir()
            except OSError:
                time.sleep(0.1)

    def run(self, command, **options):
        """subprocess.run() in the group."""
        return subprocess.run(["sh", "-c", ENTER, self.folder, *command], **options)

    def kills(self):
        """Processes that the kernel has killed for want of memory."""
        lines = self._file(1).read_text().splitlines()
        return sum(int(line.split()[1]) for line in lines if line.startswith("oom_kill "))

    def _file(self, which):
        return self.folder / NAMES[self.version][which]


def _own_group():
    """(version, folder) of the hierarchy that limits memory."""
    groups = dict(
        line.split(":", 2)[1:] for line in Path("/proc/self/cgroup").read_text().splitlines()
    )
    for controllers, path in groups.items():
        if "memory" in controllers.split(","):
            return 1, ROOT / "memory" / path.lstrip("/")
    return 2, ROOT / groups[""].lstrip("/")
