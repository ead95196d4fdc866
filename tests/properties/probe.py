# SPDX-License-Identifier: GPL-3.0-or-later
"""A probe: a small scene in which the properties of some datablocks can be seen."""

from dataclasses import dataclass, field
from typing import Callable


@dataclass
class Probe:
    """A scene, and what of it is walked."""

    name: str
    build: Callable  # (empty scene) -> {root's name: struct}
    walked: tuple = ()  # roots whose properties are flipped, or parts of them ("scene.cycles_curves")
    deeds: dict = field(
        default_factory=dict
    )  # {name: function(roots)}: changes that are no properties
    left_out: frozenset = frozenset()  # names of properties that are not flipped here
    sockets: frozenset = None  # places of the inputs of what is walked: these alone are flipped
    node: bool = False  # it is about one shader node: what is said of that node holds for all of it
