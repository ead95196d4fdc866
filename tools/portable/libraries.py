# SPDX-License-Identifier: GPL-3.0-or-later
"""Build every library of the portable module into the cache, each in a folder of its own.

libraries.py CACHE [NAME...]       prints one line a library, last the path of the toolchain file
libraries.py --are-built CACHE     by its exit code

A folder's name holds a digest of all that went into it (pin, options, recipe, toolchain, what it
needs), so trees with other pins share the cache, and a finished folder is never written again.  Interrupted, it
goes on with the library it was at.
"""

import ast
import fcntl
import hashlib
import inspect
import json
import os
import shutil
import sys
import time
from dataclasses import asdict
from pathlib import Path
from textwrap import dedent

import recipes
import toolchain
from component import BuildError, Component, read_components
from sources import prepare

# Written last: a folder without it is unfinished.
DONE = ".done"
NICENESS = 15
# What says where a source comes from and what is told of it changes nothing in what is built.
UNBUILT = ("licence", "title", "notices", "linked", "source", "patches")


def _meaning(function) -> str:
    """Of its text what Python reads."""
    return ast.dump(ast.parse(dedent(inspect.getsource(function))))


class Libraries:
    def __init__(self, cache: Path):
        self.cache = cache / "portable"
        self.components = {component.name: component for component in read_components()}

    def digest(self, component: Component) -> str:
        entry = {key: value for key, value in asdict(component).items() if key not in UNBUILT}
        recipe = _meaning(getattr(recipes, component.recipe))
        parts = [json.dumps(entry, sort_keys=True), recipe, toolchain.description()]
        if component.recipe not in recipes.UNCOMPILED:
            parts += [_meaning(recipes.Job.paths), _meaning(recipes.strip_libraries)]
        parts += [self.digest(self.components[name]) for name in component.needs]
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:12]

    def prefix(self, component: Component) -> Path:
        return self.cache / f"{component.name}-{self.digest(component)}"

    def toolchain(self) -> toolchain.Toolchain:
        zig = self.prefix(self.components["ziglang"])
        return toolchain.Toolchain(zig / "ziglang/zig", self.cache / f"toolchain-{zig.name[-12:]}")

    def is_built(self, component: Component) -> bool:
        return (self.prefix(component) / DONE).is_file()

    def build(self, component: Component) -> None:
        prefix = self.prefix(component)
        work = self.cache / "work" / component.name
        for folder in (prefix, work):
            shutil.rmtree(folder, ignore_errors=True)
        (work / "build").mkdir(parents=True)
        (work / "source").mkdir()
        prefix.mkdir(parents=True)
        logs = self.cache / "logs"
        logs.mkdir(exist_ok=True)
        log = logs / f"{component.name}.log"
        log.write_text("")
        prepare(component, self.cache / "downloads", work / "source")
        # First: a recipe may move its source away.
        for notice in component.notices:
            target = prefix / "notices" / Path(notice).name
            target.parent.mkdir(exist_ok=True)
            shutil.copy(work / "source" / notice, target)
        job = recipes.Job(
            component=component,
            source=work / "source",
            build=work / "build",
            prefix=prefix,
            needs=[self.prefix(self.components[name]) for name in component.needs],
            toolchain=None if component.recipe == "zig" else self.toolchain(),
            log=log,
        )
        getattr(recipes, component.recipe)(job)
        recipes.strip_libraries(job)
        (prefix / DONE).write_text("")
        shutil.rmtree(work)

    def build_all(self, names: list[str]) -> None:
        self.cache.mkdir(parents=True, exist_ok=True)
        with (self.cache / ".lock").open("w") as lock:
            # Two runs at once would write the same folders.
            fcntl.flock(lock, fcntl.LOCK_EX)
            wanted = [c for c in self.components.values() if not names or c.name in names]
            for number, component in enumerate(wanted, 1):
                if self.is_built(component):
                    continue
                began = time.monotonic()
                line = f"[{number}/{len(wanted)}] {component.name} {component.version}"
                print(f"{line} ...", file=sys.stderr, flush=True)
                self.build(component)
                print(f"{line}: {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)

    def cmake_file(self) -> Path:
        """The toolchain file that finds all of them."""
        components = self.components.values()
        # Headers of several Pythons side by side: each has a folder of its own, found by name.
        pythons = [c for c in components if c.recipe == "python_headers"]
        prefixes = [self.prefix(c) for c in components if c not in pythons]
        tags = [f"c{c.name.replace('.', '')}={self.prefix(c)}/include" for c in pythons]
        digest = hashlib.sha256(" ".join([*map(str, prefixes), *tags]).encode()).hexdigest()[:12]
        path = self.cache / f"granita-{digest}.cmake"
        return self.toolchain().cmake_file(
            path,
            prefixes,
            GRANITA_PORTABLE="ON",
            GRANITA_PORTABLE_CACHE=str(self.cache),
            GRANITA_PYTHONS=";".join(tags),
        )


def main() -> None:
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    if sys.argv[1] == "--are-built":
        libraries = Libraries(Path(sys.argv[2]))
        sys.exit(not all(map(libraries.is_built, libraries.components.values())))
    libraries = Libraries(Path(sys.argv[1]))
    # Half an hour of two processors: whoever works on this machine goes first.
    os.nice(max(NICENESS - os.nice(0), 0))
    try:
        libraries.build_all(sys.argv[2:])
    except BuildError as error:
        sys.exit(f"The portable module cannot be built: {error}")
    print(libraries.cmake_file())


if __name__ == "__main__":
    main()
