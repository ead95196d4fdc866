# SPDX-License-Identifier: GPL-3.0-or-later
"""The matrix of docs/hard_cases.md: a row a case, a column an executor, from the reports of a test run.

    python3 tests/hard_case_matrix.py build/reports/native-*.xml build/reports/closed_form.xml

A cell is `error / tolerance` of the assertion that came nearest to its tolerance in the case's tests for the executor
(conftest.py, native/measured.h), or `held` where they ask for equality or count.  Replaces the table in the document;
fails where a case has a test that did not pass or is not there.
"""

import argparse
import fnmatch
import re
import sys
import xml.etree.ElementTree as tree
from pathlib import Path

from case_table import measured

DOCUMENT = Path(__file__).resolve().parent.parent / "docs" / "hard_cases.md"
BEGIN, END = "<!-- matrix: tests/hard_case_matrix.py -->\n", "<!-- end of matrix -->\n"
COLUMNS = ["R", "S", "C", "Gp", "Gs"]
SHARED = [
    "R",
    "S",
    "C",
]  # what these executors have in common: the film, what comes before the hider
EXECUTORS = {"reference": "R", "simd": "S", "compute": "C"}


def columns_of(suite, name):
    """Which executors a test is about."""
    text = f"{suite} {name}".lower()
    for executor, column in EXECUTORS.items():
        if re.search(rf"[\[/-]{executor}\b", text):
            return [column]
    module = suite.rpartition(".")[2]
    if module == "test_raster_samples" or "RasterSampling" in suite or text.endswith("/raster"):
        return ["Gs"]
    if module.startswith(("test_raster", "Raster")) or "/Raster" in suite or "raster" in text:
        return ["Gp"]
    return SHARED


def read(paths):
    """{full name: test case}; names are `Suite.Test/parameter` and `module.test[parameter]`."""
    return {
        f"{case.get('classname').rpartition('.')[2]}.{case.get('name')}": case
        for path in paths
        for case in tree.parse(path).iter("testcase")
    }


def pairs_of(case):
    """Native tests name their tolerances; pytest's are told from other comparisons by their size."""
    return measured(case) if "test_" in case.get("classname") else measured(case, float("inf"))


def row(patterns, cases):
    """{column: cell}, and what is wrong."""
    held, wrong = {}, []
    for pattern in patterns:
        found = [
            name for name in cases if any(fnmatch.fnmatch(name, p) for p in spellings(pattern))
        ]
        if not found:
            wrong.append(f"no test {pattern}")
        for name in found:
            case = cases[name]
            if case.find("failure") is not None or case.find("error") is not None:
                wrong.append(f"{name} failed")
            for column in columns_of(case.get("classname"), case.get("name")):
                held.setdefault(column, []).extend(pairs_of(case))
    cells = {}
    for column, pairs in held.items():
        error, limit = max(pairs, key=lambda pair: pair[0] / pair[1], default=(0, 0))
        cells[column] = f"{error:.2g} / {limit:.2g}" if pairs else "held"
    return cells, wrong


def spellings(pattern):
    """Of a test with or without parameters, and with or without the name of its instantiation."""
    escaped = pattern.replace("[", "[[]")
    yield from (escaped, escaped + "[[]*", escaped + "/*", "*/" + escaped, "*/" + escaped + "/*")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("reports", nargs="+", type=Path)
    cases = read(parser.parse_args().reports)
    text = DOCUMENT.read_text()
    before, _, rest = text.partition(BEGIN)
    table, _, after = rest.partition(END)
    lines = ["| case | what | " + " | ".join(COLUMNS) + " | tests |", "|---" * 8 + "|"]
    problems = []
    for line in table.splitlines()[2:]:
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        made, wrong = row(re.findall(r"`([^`]+)`", cells[-1]), cases)
        problems += [f"{cells[0]}: {problem}" for problem in wrong]
        values = [made.get(column, "") for column in COLUMNS]
        lines.append("| " + " | ".join([cells[0], cells[1], *values, cells[-1]]) + " |")
    DOCUMENT.write_text(before + BEGIN + "\n".join(lines) + "\n" + END + after)
    sys.exit("\n".join(problems) or None)


if __name__ == "__main__":
    main()
