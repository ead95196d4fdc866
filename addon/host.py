# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the machine that Blender runs on can load the native module at all.

Asked before the import: on a processor without its instructions the module would end Blender
instead of raising an error.  Nothing here needs Blender.
"""

import os
import platform
import sys
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

# x86-64-v2 beyond what every 64-bit processor has, as /proc/cpuinfo calls it.
INSTRUCTIONS = frozenset({"cx16", "lahf_lm", "popcnt", "sse4_1", "sse4_2", "ssse3"})
OLDEST_GLIBC = (2, 28)


@dataclass
class Host:
    system: str = "Linux"
    machine: str = "x86_64"
    libc: str = "glibc 2.28"  # "" where there is none of that name
    processor: str = ""
    instructions: frozenset = field(default_factory=lambda: INSTRUCTIONS)  # empty: not known


@lru_cache(maxsize=1)
def this_host():
    processor, instructions = _processor()
    return Host(platform.system(), platform.machine(), _libc(), processor, instructions)


def problem(host):
    """Why no module of Granita's can run there, in words for an artist; "" where one can."""
    if host.system != "Linux":
        return f"Granita renders on Linux alone so far; this is {host.system or 'another system'}"
    if host.machine not in ("x86_64", "AMD64"):
        return f"Granita renders on x86-64 processors alone so far; this one is {host.machine}"
    name, _, version = host.libc.partition(" ")
    if name != "glibc":
        return "Granita needs a Linux with the GNU C library (glibc); this one has another"
    if _numbers(version) < OLDEST_GLIBC:
        return f"Granita needs glibc 2.28 or newer; this system has {version}"
    missing = INSTRUCTIONS - host.instructions if host.instructions else ()
    if missing:
        return (
            f"Granita needs a processor with SSE4.2 and POPCNT (made since about 2009); "
            f"{host.processor or 'this one'} has no {', '.join(sorted(missing))}"
        )
    return ""


def _numbers(version):
    digits = [part for part in version.split(".") if part.isdigit()]
    return tuple(map(int, digits)) or (0,)


def _libc():
    try:
        return os.confstr("CS_GNU_LIBC_VERSION") or ""
    except (AttributeError, OSError, ValueError):  # Windows, musl
        return ""


def _processor():
    """(name, instructions), both empty where the kernel does not say."""
    if sys.platform != "linux":
        return "", frozenset()
    try:
        text = Path("/proc/cpuinfo").read_text(errors="replace")
    except OSError:
        return "", frozenset()
    values = {}
    for line in text.partition("\n\n")[0].splitlines():
        key, _, value = line.partition(":")
        values[key.strip()] = value.strip()
    return values.get("model name", ""), frozenset(values.get("flags", "").split())
