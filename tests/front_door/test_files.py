# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that people read and change have at most five hundred lines."""

import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
READ = {".py", ".cpp", ".h", ".inl", ".comp", ".vert", ".frag", ".glsl", ".sh", ".js", ".cmake", ""}


def test_no_file_is_longer_than_can_be_read_at_once():
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    files = [ROOT / name for name in names.split("\0") if name and Path(name).suffix in READ]
    files = [path for path in files if path.is_file() and path.name != "LICENSE"]
    lines = {str(path): path.read_text(errors="ignore").count("\n") for path in files}
    assert len(lines) > 100
    assert {path: count for path, count in lines.items() if count > 500} == {}
