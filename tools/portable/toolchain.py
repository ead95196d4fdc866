# SPDX-License-Identifier: GPL-3.0-or-later
"""zig's clang as a cross compiler for an older glibc: wrappers, and a CMake toolchain file.

The wrappers are named clang and clang++ so that ccache and CMake know what they are.  `+evex512`:
zig names every absent feature as off, and Highway 1.0.3's AVX-512 functions then fail to compile; it enables no
instruction by itself.  `-slow_unaligned_mem_32`: the processors that x86-64-v2 is named after read 32 bytes faster in
halves, and so would all AVX2 functions, which they never run.  zig spells processors with underscores and knows no
`-march=x86-64-v2`; of -O3 it makes -O2, and it keeps frame pointers unless it is told not to.
"""

import shlex
from pathlib import Path

TARGET = "x86_64-linux-gnu.2.28"
PROCESSOR = "x86_64_v2+evex512-slow_unaligned_mem_32"

# One pass over the arguments: what zig does not understand is put right.
WRAPPER = """#!/bin/bash
export ZIG_GLOBAL_CACHE_DIR={cache} ZIG_LOCAL_CACHE_DIR={cache}
arguments=()
for argument in "$@"; do
    case $argument in
        -march=x86-64-v2) ;;
        -O3) arguments+=(-O3 -Xclang -O3 -fomit-frame-pointer) ;;
        -march=*) arguments+=("${{argument//-/_}}"); arguments[-1]=-${{arguments[-1]#_}} ;;
        *) arguments+=("$argument") ;;
    esac
done
exec {zig} {program} -target {target} -mcpu={processor} "${{arguments[@]}}"
"""
TOOL = """#!/bin/bash
export ZIG_GLOBAL_CACHE_DIR={cache} ZIG_LOCAL_CACHE_DIR={cache}
exec {zig} {program} "$@"
"""
CMAKE = """set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER {bin}/clang)
set(CMAKE_CXX_COMPILER {bin}/clang++)
set(CMAKE_AR {bin}/ar CACHE FILEPATH "")
set(CMAKE_RANLIB {bin}/ranlib CACHE FILEPATH "")
set(CMAKE_FIND_ROOT_PATH {prefixes})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_C_VISIBILITY_PRESET hidden)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
"""


def description() -> str:
    """Changes when what the wrappers do changes: part of each library's stamp."""
    return f"{TARGET} {PROCESSOR} {WRAPPER}"


class Toolchain:
    def __init__(self, zig: Path, folder: Path):
        """`folder` gets the wrappers and zig's cache."""
        self.bin = folder / "bin"
        self.bin.mkdir(parents=True, exist_ok=True)
        cache = shlex.quote(str(folder / "zig-cache"))
        fields = {
            "zig": shlex.quote(str(zig)),
            "cache": cache,
            "target": TARGET,
            "processor": PROCESSOR,
        }
        for name, program in (("clang", "cc"), ("clang++", "c++")):
            self._write(name, WRAPPER.format(program=program, **fields))
        for name in ("ar", "ranlib"):
            self._write(name, TOOL.format(program=name, **fields))

    def _write(self, name: str, text: str) -> None:
        """Untouched where it says so already: its date is part of ccache's key."""
        path = self.bin / name
        if not path.is_file() or path.read_text() != text:
            path.write_text(text)
            path.chmod(0o755)

    def cmake_file(self, path: Path, prefixes: list[Path], **settings: str) -> Path:
        """`path`, telling where libraries are found and what else is set."""
        text = CMAKE.format(bin=self.bin, prefixes=" ".join(f'"{prefix}"' for prefix in prefixes))
        text += "".join(f'set({name} "{value}")\n' for name, value in settings.items())
        if not path.is_file() or path.read_text() != text:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return path

    def environment(self) -> dict[str, str]:
        tools = {"CC": "clang", "CXX": "clang++", "AR": "ar", "RANLIB": "ranlib"}
        return {name: str(self.bin / tool) for name, tool in tools.items()}
