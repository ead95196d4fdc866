# SPDX-License-Identifier: GPL-3.0-or-later
"""What the walk leaves out: unwalked.toml, which has the reasons."""

import functools
import tomllib
from pathlib import Path

# [{"of": str, "reason": str, "names": [str]}]
GROUPS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text())["group"]


@functools.cache
def names(*kinds):
    """frozenset of the names of these kinds, as `of` has them."""
    found = [group for group in GROUPS if group["of"] in kinds]
    assert {group["of"] for group in found} == set(kinds), kinds
    return frozenset(name for group in found for name in group["names"])
