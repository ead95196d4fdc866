# SPDX-License-Identifier: GPL-3.0-or-later
from export.report import Report, lines


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
