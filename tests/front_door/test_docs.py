# SPDX-License-Identifier: GPL-3.0-or-later
"""What the documents name is there: files, what is in them, and what they link to."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FILES = subprocess.run(
    ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
    cwd=ROOT,
    check=True,
    capture_output=True,
    text=True,
).stdout.split()
DOCUMENTS = [
    name for name in FILES if name.endswith(".md") and (name.startswith("docs/") or "/" not in name)
]
# `path/of/a_file.cpp`, or `a_file.py:test_of_it`; the end of a name may be left out: `test_of...`.
NAMED = re.compile(r"`([\w./-]+\.(?:cpp|h|inl|py|comp|vert|frag|glsl|sh|toml))(?::([\w:.]+))?`")


def files_called(path):
    return [ROOT / name for name in FILES if name == path or name.endswith("/" + path)]


@pytest.mark.parametrize("document", DOCUMENTS)
def test_files_that_a_document_names_exist_and_hold_what_it_says(document):
    missing = []
    for path, part in NAMED.findall((ROOT / document).read_text(encoding="utf-8")):
        part = part.removesuffix("...").rpartition("::")[2]
        texts = [file.read_text(encoding="utf-8", errors="ignore") for file in files_called(path)]
        if not any(part in text for text in texts):
            missing.append(f"{path}:{part}")
    assert not missing


@pytest.mark.parametrize("document", DOCUMENTS)
def test_links_lead_somewhere(document):
    text = (ROOT / document).read_text(encoding="utf-8")
    targets = re.findall(r"\]\(([^)#\s]+)\)", text)
    here = (ROOT / document).parent
    assert not [t for t in targets if "://" not in t and not (here / t).exists()]


@pytest.mark.parametrize(
    "document", DOCUMENTS + [name for name in FILES if re.fullmatch(r"bench/\w+\.py", name)]
)
def test_benches_that_a_document_names_are_run_by_dev(document):
    text = (ROOT / document).read_text(encoding="utf-8")
    listed = re.search(r"PYTHON_BENCHES=\(([^)]*)\)", (ROOT / "dev").read_text()).group(1).split()
    programs = [Path(name).stem for name in FILES if re.fullmatch(r"bench/\w+\.cpp", name)]
    named = re.findall(r"dev bench ([a-z]\w*)", text)
    assert not set(named) - set(listed + programs)
