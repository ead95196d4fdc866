# SPDX-License-Identifier: GPL-3.0-or-later
"""What a report of a fault begins with: versions, processor, OpenGL.

Lines of "name: value".  What the native module says is asked once: its OpenGL takes some tenths of a
second to open.
"""

import os
import platform
from functools import lru_cache

from . import bridge
from .host import this_host


@lru_cache(maxsize=1)
def native_lines():
    """Of the native module; raises bridge.NativeModuleMissing."""
    core = bridge.load()
    system = core.system()
    kind = "every Linux" if system["portable"] else "this system's libraries"
    libraries = ", ".join(f"{name} {version}" for name, version in system["libraries"].items())
    return (
        ("Granita", f"{core.__version__}, for {kind}"),
        ("Compiler", system["compiler"]),
        ("Libraries", libraries),
        ("Vector units", ", ".join(system["vector_units"])),
        ("OpenGL", _opengl(core.opengl())),
    )


def _opengl(found):
    if "problem" in found:
        return f"none ({found['problem']})"
    kind = "software" if found["software"] else "hardware"
    return f"{found['renderer']} ({found['vendor']}), {found['version']}, {kind}"


def host_lines():
    host = this_host()
    return (
        ("System", f"{platform.platform()}, {host.libc or 'no glibc'}"),
        ("Processor", f"{host.processor or host.machine}, {os.cpu_count()} threads"),
        ("Python", platform.python_version()),
    )


def text(blender):
    """All of it; `blender`: what Blender says of itself."""
    try:
        native = native_lines()
    except bridge.NativeModuleMissing as error:
        native = (("Granita", f"native module missing: {error}"),)
    lines = (*native, ("Blender", blender), *host_lines())
    return "".join(f"{name}: {value}\n" for name, value in lines)
