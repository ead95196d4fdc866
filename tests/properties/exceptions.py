# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of what Granita does not read, or reads otherwise: docs/manual/not_read.toml.

[[part]]
title = "Heading of the manual"
[[part.entry]]
what = "what the artist knows it by"
keys = ["CyclesLightSettings.is_*"]   # patterns of Flip.key; of Flip.identifier where they hold a colon
reason = "why, and what happens instead"
verdicts = ["silent"]                 # what is allowed; these are left out: all but `fails`
manual = false                        # an entry for the test alone; left out: it is in the manual
"""

import fnmatch
import tomllib
from pathlib import Path

TABLE = Path(__file__).resolve().parents[2] / "docs" / "manual" / "not_read.toml"
_ALLOWED = ("silent", "differs", "own")


def read_parts(path=TABLE):
    """[{"title": str, "entry": [{"what": ..., "keys": ..., "reason": ...}]}]."""
    with open(path, "rb") as file:
        return tomllib.load(file)["part"]


def entries(parts):
    return [entry for part in parts for entry in part["entry"]]


def listed(record, table):
    """The entry that allows a verdict, or None.

    Args:
        record: of `Verdict.record`.
        table: of `entries`.
    """
    for entry in table:
        if record["verdict"] not in entry.get("verdicts", _ALLOWED):
            continue
        if _matches(record, entry["keys"]):
            return entry
    return None


def _matches(record, patterns):
    return any(
        fnmatch.fnmatchcase(record["identifier" if ":" in pattern else "key"], _literal(pattern))
        for pattern in patterns
    )


def _literal(pattern):
    """Only the star is special: identifiers hold brackets."""
    return pattern.replace("[", "[[]").replace("?", "[?]")
