# SPDX-License-Identifier: GPL-3.0-or-later
"""Python processes of their own, for what might end one."""

import ast
import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def printed(*arguments, more_environment=None):
    """What Python prints that is run with `arguments`; it must end well, within five minutes."""
    run = subprocess.run(
        [sys.executable, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
        env={**os.environ, **(more_environment or {})},
    )
    assert run.returncode == 0, f"{run.stdout[-200:]}{run.stderr[-2000:]}"
    return run.stdout


def last_printed(*arguments, **more):
    """The value of the last line."""
    return ast.literal_eval(printed(*arguments, **more).strip().split("\n")[-1])
