# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the manual's page of what is not read from its table: not_read.py [FILE]."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests" / "properties"))
import exceptions  # noqa: E402

PAGE = HERE / "not_read.md"
_HEAD = """# What Granita does not read

Granita reads Blender's own settings and those of Cycles that say how a scene looks. What it does not read, or reads
in its own way, stands here; anything else that it cannot render as asked it names in a warning when it renders.
"""


def page(parts):
    """The page's text."""
    lines = [_HEAD]
    for part in parts:
        rows = [entry for entry in part["entry"] if entry.get("manual", True)]
        if not rows:
            continue
        lines += [f"## {part['title']}", "", "| setting | what happens |", "|---|---|"]
        lines += [f"| {entry['what']} | {entry['reason']} |" for entry in rows]
        lines.append("")
    return "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE
    target.write_text(page(exceptions.read_parts()))
