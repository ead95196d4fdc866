# SPDX-License-Identifier: GPL-3.0-or-later
"""Photometric files for tests: the same luminaire, uneven around and from below upwards, in every layout."""

import numpy as np

# (type, angles around, angles up); types 1, 2, 3 are C, B and A of IES LM-63.
LAYOUTS = {
    "all around": (1, np.arange(0.0, 361.0, 30.0), np.arange(0.0, 181.0, 15.0)),
    "half around": (1, np.arange(0.0, 181.0, 45.0), np.arange(0.0, 91.0, 10.0)),
    "a quarter": (1, np.arange(0.0, 91.0, 22.5), np.array([0.0, 20.0, 50.0, 90.0, 120.0, 180.0])),
    "even around": (1, np.array([0.0]), np.arange(0.0, 181.0, 20.0)),
    "from 90": (1, np.arange(90.0, 271.0, 30.0), np.arange(0.0, 181.0, 30.0)),
    "without its end": (1, np.arange(0.0, 360.0, 40.0), np.arange(30.0, 151.0, 10.0)),
    "type B": (2, np.arange(0.0, 91.0, 15.0), np.arange(-90.0, 91.0, 15.0)),
    "half of type B": (2, np.arange(-90.0, 91.0, 30.0), np.arange(0.0, 91.0, 30.0)),
    "type A": (3, np.arange(-90.0, 91.0, 30.0), np.arange(-90.0, 91.0, 20.0)),
    "half of type A": (3, np.arange(0.0, 91.0, 30.0), np.arange(-60.0, 61.0, 20.0)),
}


def ies_file(layout, tilt="NONE"):
    """Its text."""
    kind, around, up = LAYOUTS[layout]
    a, u = np.meshgrid(np.radians(around), np.radians(up), indexing="ij")
    candela = 400.0 * (1.2 + np.cos(2.0 * u + 0.5) * (1.0 + 0.4 * np.sin(3.0 * a + 0.3)))
    included = "\n1\n2\n0 90\n1.0 0.8" if tilt == "INCLUDE" else ""
    rows = "\n".join(" ".join(f"{x:.4f}" for x in row) for row in candela)
    return (
        f"IESNA:LM-63-2002\n[TEST] none\nTILT={tilt}{included}\n"
        f"1 1000 1.5 {len(up)} {len(around)} {kind} 2 0 0 0\n0.9 1.1 60\n"
        f"{' '.join(map(str, up))}\n{', '.join(map(str, around))}\n{rows}\n"
    )
