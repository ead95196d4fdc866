# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of the add-on that need no Blender are imported by their own names: `import export`.

The add-on's top folder itself imports `bpy`.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))
