# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong, where the artist looks first."""

import textwrap

# Characters that fit a properties editor of usual width.
_WIDTH = 48


def draw_problem(layout, text):
    box = layout.box()
    box.alert = True
    for i, line in enumerate(textwrap.wrap(text, _WIDTH)):
        box.label(text=line, icon="ERROR" if i == 0 else "BLANK1")
