# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests measured, as Markdown: a row a test, a column a report.

    python3 tests/case_table.py test_motion test_lights_motion -- 3.4=build/reports/blender-3.4.xml ...

Takes the modules whose names begin so.  A cell is `error / tolerance, seconds` of the assertion that came nearest to its
limit (conftest.py), or `held` where a test asserts equality; limits above .1 are no tolerances.  A test's picture or
export is in its seconds, Blender's start is not.
"""

import argparse
import re
import xml.etree.ElementTree as tree

LARGEST_TOLERANCE = 0.1


def measured(case, largest=LARGEST_TOLERANCE):
    """(error, limit) of a test's assertions."""
    pairs = [
        tuple(map(float, item.get("value").split()))
        for item in case.iter("property")
        if item.get("name") == "held"
    ]
    return [pair for pair in pairs if pair[1] <= largest]


def cell(case):
    if case.find("skipped") is not None:
        return "not there"
    if case.find("failure") is not None or case.find("error") is not None:
        return "FAILED"
    pairs = measured(case)
    seconds = f"{float(case.get('time')):.2f} s"
    if not pairs:
        return f"held, {seconds}"
    error, limit = max(pairs, key=lambda pair: pair[0] / pair[1])
    return f"{error:.2g} / {limit:.2g}, {seconds}"


def title(name):
    """`test_a_thing[with-this]` -> `a thing: with-this`"""
    words, _, values = re.sub(r"^test_", "", name).partition("[")
    values = values.rstrip("]")
    return words.replace("_", " ") + (f": {values.replace('_', ' ')}" if values else "")


def rows(report, prefixes):
    """{module: {test: cell}}"""
    made = {}
    for case in tree.parse(report).iter("testcase"):
        module = case.get("classname").rpartition(".")[2]
        if module.startswith(tuple(prefixes)):
            made.setdefault(module, {})[case.get("name")] = cell(case)
    return made


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("modules", nargs="+", help="module prefixes, then HOST=REPORT.xml")
    names = parser.parse_args().modules
    reports = dict(name.split("=", 1) for name in names if "=" in name)
    prefixes = [name for name in names if "=" not in name]
    columns = {host: rows(report, prefixes) for host, report in reports.items()}
    first = next(iter(columns.values()))
    for module, cases in first.items():
        print(f"\n## `{module}.py`\n")
        print(f"| case | {' | '.join(columns)} |")
        print("|---" * (len(columns) + 1) + "|")
        for name in cases:
            cells = [column.get(module, {}).get(name, "not there") for column in columns.values()]
            print(f"| {title(name)} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
