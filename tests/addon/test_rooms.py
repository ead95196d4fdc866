# SPDX-License-Identifier: GPL-3.0-or-later
"""The rooms of `addon/export`: none knows those above it."""

import ast
from pathlib import Path

import pytest

EXPORT = Path(__file__).resolve().parents[2] / "addon" / "export"
ROOMS = ("base", "shading", "geometry", "scene", "motion")


def test_every_file_is_in_a_room():
    assert sorted(p.name for p in EXPORT.iterdir() if p.suffix == ".py") == ["__init__.py"]
    folders = {p.name for p in EXPORT.iterdir() if p.is_dir() and p.name != "__pycache__"}
    assert folders == set(ROOMS)


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_imports_from_itself_and_from_those_below(room):
    allowed = ROOMS[: ROOMS.index(room) + 1]
    for file in (EXPORT / room).glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level:
                other = room if node.level == 1 else (node.module or "").split(".")[0]
                assert node.level <= 2 and other in allowed, f"{file.name}: {ast.unparse(node)}"
