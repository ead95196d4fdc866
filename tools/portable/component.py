# SPDX-License-Identifier: GPL-3.0-or-later
"""One library of components.toml, and where it lies in the cache."""

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

COMPONENTS = Path(__file__).with_name("components.toml")


class BuildError(Exception):
    """What cannot be had or built; the text says which and what to do."""


@dataclass
class Component:
    name: str
    version: str
    licence: str
    source: str
    sha256: str
    recipe: str = "cmake"
    title: str = ""
    patches: str = ""
    patches_sha256: str = ""
    needs: list[str] = field(default_factory=list)
    options: list[str] = field(default_factory=list)
    cxxflags: str = ""
    notices: list[str] = field(default_factory=list)
    edits: list[dict] = field(default_factory=list)
    linked: bool = True

    def file(self) -> str:
        """The name of its source in the cache."""
        return (
            self.source.rpartition("/")[2]
            if self.source.startswith("debian:")
            else f"{self.name}.whl"
        )


def read_components() -> list[Component]:
    entries = tomllib.loads(COMPONENTS.read_text())["component"]
    return [Component(**entry) for entry in entries]
