# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual's page of what is not read, and the table that it is made from."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "docs" / "manual"), str(ROOT / "tests" / "properties")]
import exceptions  # noqa: E402
import not_read  # noqa: E402


def test_the_page_is_what_the_table_makes():
    assert not_read.PAGE.read_text() == not_read.page(
        exceptions.read_parts()
    ), "run python3 docs/manual/not_read.py"


def test_every_entry_says_what_and_why():
    for entry in exceptions.entries(exceptions.read_parts()):
        assert entry["keys"] and len(entry["what"]) > 3 and len(entry["reason"]) > 10, entry


def test_patterns_mean_brackets_and_question_marks_literally():
    table = [{"what": "x", "keys": ["ShaderNodeMix[Factor_*]"], "reason": "r"}]
    found = {"identifier": "a: b", "key": "ShaderNodeMix[Factor_Float]", "verdict": "silent"}
    assert exceptions.listed(found, table)
    assert not exceptions.listed({**found, "key": "ShaderNodeMixF"}, table)
    assert not exceptions.listed({**found, "verdict": "fails"}, table)


def test_settings_of_passes_that_are_read_have_no_excuse():
    table = exceptions.entries(exceptions.read_parts())
    for name in ("denoising_store_passes", "use_pass_volume_direct", "use_pass_volume_indirect"):
        key = f"CyclesRenderLayerSettings.{name}"
        flip = {"identifier": f"x: view_layer.cycles.{name}", "key": key, "verdict": "silent"}
        assert exceptions.listed(flip, table) is None, name
