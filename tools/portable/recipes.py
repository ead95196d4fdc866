# SPDX-License-Identifier: GPL-3.0-or-later
"""How each library is built; the name of a function is the `recipe` of components.toml.

Every recipe gets a Job and installs below `job.prefix` what the others and the module need of it.
"""

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from component import BuildError, Component
from toolchain import Toolchain

FLAGS = "-O3 -fPIC -fvisibility=hidden"
JOBS = 2
# Recipes that unpack and copy.
UNCOMPILED = ("zig", "glm", "pybind11", "python_headers")


@dataclass
class Job:
    component: Component
    source: Path
    build: Path
    prefix: Path
    needs: list[Path]  # prefixes
    toolchain: Toolchain | None
    log: Path

    def run(self, *command: object, cwd: Path | None = None, **environment: str) -> None:
        with self.log.open("a") as log:
            log.write(f"$ {' '.join(map(str, command))}\n")
            log.flush()
            done = subprocess.run(
                [str(word) for word in command],
                cwd=cwd or self.build,
                env=os.environ
                | (self.toolchain.environment() if self.toolchain else {})
                | environment,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
            )
        if done.returncode:
            tail = "\n".join(self.log.read_text(errors="replace").splitlines()[-30:])
            raise BuildError(f"{tail}\n{self.component.name} does not build; all of it: {self.log}")

    def paths(self) -> str:
        """Keeps the folders of this machine out of what is built: builds in two places are equal."""
        maps = (
            (self.prefix.parent, "portable"),
            (self.source, self.component.name),
            (self.build, "build"),
        )
        return " ".join(f"-ffile-prefix-map={place}={name}" for place, name in maps)

    def archive(self, name: str, sources: list[Path], *flags: object) -> None:
        """A static library out of a few C or C++ files."""
        objects = []
        for source in sources:
            compiler = self.toolchain.bin / ("clang" if source.suffix == ".c" else "clang++")
            objects.append(self.build / (source.stem + ".o"))
            self.run(
                compiler,
                *FLAGS.split(),
                *self.paths().split(),
                *flags,
                "-c",
                source,
                "-o",
                objects[-1],
            )
        (self.prefix / "lib").mkdir(exist_ok=True)
        self.run(self.toolchain.bin / "ar", "rcsD", self.prefix / "lib" / name, *objects)


def strip_libraries(job: Job) -> None:
    """zig adds lines of debugging to all that it compiles: eight ninths of 844 MB.  Names of functions stay."""
    for archive in sorted(job.prefix.glob("lib/*.a")):
        job.run("objcopy", "--strip-debug", "--enable-deterministic-archives", archive)


def zig(job: Job) -> None:
    (job.source / "ziglang").rename(job.prefix / "ziglang")
    (job.prefix / "ziglang/zig").chmod(0o755)


def cmake(job: Job) -> None:
    toolchain = job.toolchain.cmake_file(job.build / "toolchain.cmake", [*job.needs, job.prefix])
    flags = f"{job.paths()} {job.component.cxxflags}"
    job.run(
        *("cmake", "-S", job.source, "-B", job.build, "-G", "Ninja"),
        *(
            f"-DCMAKE_TOOLCHAIN_FILE={toolchain}",
            "-DCMAKE_BUILD_TYPE=Release",
            "-DBUILD_SHARED_LIBS=OFF",
        ),
        *(f"-DCMAKE_INSTALL_PREFIX={job.prefix}", f"-DCMAKE_INSTALL_LIBDIR={job.prefix}/lib"),
        *(f"-DCMAKE_C_FLAGS={flags}", f"-DCMAKE_CXX_FLAGS={flags}"),
        *(f"-D{option}" for option in job.component.options),
    )
    job.run("ninja", "-j", JOBS, "install")


def zlib(job: Job) -> None:
    job.run(
        *("./configure", "--static", f"--prefix={job.prefix}"),
        cwd=job.source,
        CFLAGS=f"{FLAGS} {job.paths()}",
    )
    job.run("make", "-j", JOBS, "install", cwd=job.source)


def boost_thread(job: Job) -> None:
    """OpenImageIO's reader-writer locks are Boost's; all else that it takes of Boost is headers."""
    for include in sorted(job.source.glob("libs/**/include")):
        if (include / "boost").is_dir():
            shutil.copytree(include / "boost", job.prefix / "include/boost", dirs_exist_ok=True)
    files = [job.source / "libs/thread/src/pthread" / name for name in ("thread.cpp", "once.cpp")]
    removed = "-D_LIBCPP_ENABLE_CXX17_REMOVED_UNARY_BINARY_FUNCTION"
    job.archive("libboost_thread.a", files, "-std=c++17", removed, f"-I{job.prefix}/include")


def epoxy(job: Job) -> None:
    """The few steps of its Meson file, for EGL without X."""
    for name in ("gl", "egl"):
        job.run(
            *(sys.executable, job.source / "src/gen_dispatch.py", "--source", "--header"),
            *(f"--outputdir={job.build}", job.source / f"registry/{name}.xml"),
        )
    include = job.prefix / "include"
    (include / "epoxy").mkdir(parents=True)
    for header in [job.source / f"include/epoxy/{name}.h" for name in ("common", "gl", "egl")]:
        shutil.copy(header, include / "epoxy")
    for header in job.build.glob("*_generated.h"):
        shutil.copy(header, include / "epoxy")
    # Khronos' headers are the same everywhere; Debian's libegl-dev has them.
    for folder in ("EGL", "KHR"):
        shutil.copytree(Path("/usr/include") / folder, include / folder)
    (job.build / "config.h").write_text(
        "#define ENABLE_EGL 1\n#define ENABLE_GLX 0\n#define ENABLE_X11 0\n#define HAVE_KHRPLATFORM_H\n"
        "#define EPOXY_PUBLIC extern\n"
    )
    sources = [job.source / f"src/dispatch_{name}.c" for name in ("common", "egl")]
    sources += [job.build / f"{name}_generated_dispatch.c" for name in ("gl", "egl")]
    flags = (
        f"-I{job.build}",
        f"-I{include}",
        f"-I{job.source}/src",
        "-fno-strict-aliasing",
        "-DEGL_NO_X11",
    )
    job.archive("libepoxy.a", sources, *flags)


def glm(job: Job) -> None:
    shutil.copytree(job.source / "glm", job.prefix / "include/glm")


def pybind11(job: Job) -> None:
    shutil.copytree(job.source / "pybind11/include", job.prefix / "include")


def python_headers(job: Job) -> None:
    """Nothing of Python is compiled: the host brings it.  Its headers ask pyconfig.h for sizes and
    a few switches, which are the same in every ordinary build for x86-64 Linux: this machine's."""
    shutil.copytree(job.source / "Include", job.prefix / "include")
    shutil.copy("/usr/include/x86_64-linux-gnu/python3.11/pyconfig.h", job.prefix / "include")
