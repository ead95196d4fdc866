# SPDX-License-Identifier: GPL-3.0-or-later
import pytest
from export.base.report import Report, escaped, lines


def test_messages_of_one_kind_are_one_line():
    report = Report()
    for name in "ABCDE":
        report(f"mesh '{name}'", "is empty")
    report("light 'Sun'", "is dark")
    assert lines(report.entries()) == [
        "mesh 'A', mesh 'B', mesh 'C' and 2 more: is empty",
        "light 'Sun': is dark",
    ]


def test_what_was_met_more_than_once_says_how_often():
    assert lines([("mesh 'A'", "is empty", 3)]) == ["mesh 'A': is empty (3 times)"]
    assert lines([("mesh 'A'", "is empty", 3), ("mesh 'B'", "is empty", 1)]) == [
        "mesh 'A', mesh 'B': is empty (4 times)"
    ]
    assert lines([]) == []


@pytest.mark.parametrize(
    "text, shown",
    [
        ("\x1b[31mred\x07", r"\x1b[31mred\x07"),
        ("two\nlines\r\t\x7f\x9b", r"two\nlines\r\t\x7f\x9b"),
        ("\u2028\u202eturned\u2066", r"\u2028\u202eturned\u2066"),
        ("caf\udce9.png", r"caf\udce9.png"),
        (
            "Würfel 立方体 \U0001f468\u200d\U0001f469 \\n",
            "Würfel 立方体 \U0001f468\u200d\U0001f469 \\n",
        ),
    ],
)
def test_control_characters_are_shown_escaped(text, shown):
    assert escaped(text) == shown
    assert lines([(text, text, 1)]) == [f"{shown}: {shown}"]
