# SPDX-License-Identifier: GPL-3.0-or-later
"""The stages of `native`, the rooms of `shade` and `hider`, the one file that calls the system:
what each may include."""

import re
from pathlib import Path

import pytest

NATIVE = Path(__file__).resolve().parents[2] / "native"
STAGES = "base math scene geometry dice shade gl hider film render python".split()
SHADE = "rays bsdf lights textures programs nodes volumes bounces subsurface".split()
# What a room of `hider` knows beside itself and the files above the rooms.
HIDER = {
    "samples": set(),
    "simd": {"samples"},
    "resolve": {"samples", "simd"},
    "compute": {"samples", "simd", "resolve"},
    "raster": {"samples"},
}
# The one file that calls the system, and what of POSIX the others neither include nor call.
SYSTEM = Path("base/system_posix.cpp")
POSIX_HEADERS = (
    r"(?:unistd|fcntl|dlfcn|execinfo|pthread|poll|signal|sched|dirent|malloc|sys/\w+)\.h"
)
POSIX_CALLS = (
    r"(?<![\w.>:])(?:::)?(?:madvise|mmap|munmap|sysconf|malloc_trim|clock_gettime|mkostemp|mkstemp|unlink"
    r"|pread|pwrite|dlopen|dlsym|dladdr|sigaction|sigaltstack|sigemptyset|backtrace\w*|pthread_\w+"
    r"|fork|isatty|getpid|getrusage|setenv)\(|(?<![\w>])::(?:open|close|read|write|raise|poll)\("
)


def sources(folder):
    return [file for file in sorted(folder.rglob("*")) if file.suffix in {".cpp", ".h", ".inl"}]


def posix_of(text):
    """The headers and calls of POSIX in a source, without what stands in comments."""
    text = re.sub(r"//.*", "", text)
    return re.findall(rf"#include <({POSIX_HEADERS})>", text) + re.findall(POSIX_CALLS, text)


def includes(folder):
    """(file, what it includes) as paths below `native`."""
    for file in sources(folder):
        for path in re.findall(r'^#include "(.+)"', file.read_text(encoding="utf-8"), re.M):
            yield file.relative_to(NATIVE), Path(path)


def folders(path):
    return {p.name for p in path.iterdir() if p.is_dir()}


def test_every_folder_is_a_stage_or_a_room():
    assert folders(NATIVE) == set(STAGES)
    assert folders(NATIVE / "shade") == set(SHADE)
    assert folders(NATIVE / "hider") == set(HIDER)


@pytest.mark.parametrize("stage", STAGES)
def test_a_stage_includes_itself_and_what_is_before_it(stage):
    later = STAGES[STAGES.index(stage) + 1 :]
    found = list(includes(NATIVE / stage))
    assert found
    assert [(file, path) for file, path in found if path.parts[0] in later] == []


@pytest.mark.parametrize("room", SHADE)
def test_a_room_of_shading_includes_itself_and_what_is_below_it(room):
    """What lies in `shade` itself is above all rooms."""
    allowed = SHADE[: SHADE.index(room) + 1]
    above = [
        (file, path)
        for file, path in includes(NATIVE / "shade" / room)
        if path.parts[0] == "shade" and path.parts[1] not in allowed
    ]
    assert above == []


@pytest.mark.parametrize("room", HIDER)
def test_a_room_of_the_hider_includes_what_it_may_know(room):
    allowed = HIDER[room] | {room}
    others = [
        (file, path)
        for file, path in includes(NATIVE / "hider" / room)
        if path.parts[0] == "hider" and len(path.parts) > 2 and path.parts[1] not in allowed
    ]
    assert others == []


def test_one_file_alone_includes_and_calls_posix():
    found = {
        f.relative_to(NATIVE): posix_of(f.read_text(encoding="utf-8")) for f in sources(NATIVE)
    }
    assert {"dlfcn.h", "sys/mman.h", "madvise(", "sigaction("} <= set(found.pop(SYSTEM))
    assert {file: posix for file, posix in found.items() if posix} == {}


@pytest.mark.parametrize(
    "line", ["int file = ::open(path);", "if (dlopen(name)) return;", "#include <sys/wait.h>"]
)
def test_a_line_of_posix_is_found(line):
    assert len(posix_of(line)) == 1


@pytest.mark.parametrize(
    "line", ["bool TileSpill::open() {", "m_file.read(offset);", "// dlopen(3)", "gl::close();"]
)
def test_a_line_of_granitas_own_is_not_taken_for_posix(line):
    assert posix_of(line) == []
