# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps what each test measured against which limit, for the tables of docs (case_table.py).

Every `assert error <= limit` of two numbers becomes a property "held" of its test in `--junitxml` reports.
Takes a share of the cases of each test (`--cases K/N`), but all of those marked as a sample.
"""

import ast
import operator
import re
import zlib

import pytest

# Helpers that assert for their tests.
pytest.register_assert_rewrite("film_parts", "cycles_coverage", "snapshots")

ARITHMETIC = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}


def number(text):
    """The value of numbers and arithmetic, as pytest writes them; None where there is anything else."""

    def value(node):
        if isinstance(node, ast.Expression):
            return value(node.body)
        if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
            return float(node.value)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            return -value(node.operand)
        if isinstance(node, ast.BinOp) and type(node.op) in ARITHMETIC:
            return ARITHMETIC[type(node.op)](value(node.left), value(node.right))
        raise ValueError

    try:
        return value(ast.parse(re.sub(r"np\.float\d+\(([^()]*)\)", r"\1", text), mode="eval"))
    except (SyntaxError, ValueError, ZeroDivisionError):
        return None


def pytest_assertion_pass(item, lineno, orig, expl):
    sides = re.fullmatch(r"(.+?) <=? (.+)", expl.split("\n")[0])
    error, limit = (number(side) for side in sides.groups()) if sides else (None, None)
    if error is not None and limit is not None and limit > 0:
        item.user_properties.append(("held", f"{error:.3g} {limit:.3g}"))


def pytest_addoption(parser):
    parser.addoption(
        "--cases",
        metavar="K/N",
        help="of each test the first case and those whose name's checksum is K modulo N",
    )


def pytest_collection_modifyitems(config, items):
    share = config.getoption("--cases")
    if share is None:
        return
    rest, parts = map(int, share.split("/"))
    seen, kept, left_out = set(), [], []
    for item in items:
        test = item.parent.nodeid, item.originalname
        # By names, not by places: cases are often products of parameters, whose every fourth would have one of them alike.
        is_kept = test not in seen or zlib.crc32(item.name.encode()) % parts == rest
        is_kept |= item.get_closest_marker("sample") is not None
        (kept if is_kept else left_out).append(item)
        seen.add(test)
    config.hook.pytest_deselected(items=left_out)
    items[:] = kept
