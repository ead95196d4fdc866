// SPDX-License-Identifier: GPL-3.0-or-later
// A patch, or a part of one, as a lattice of micropolygons: regular inside; along each side the
// vertices that the side's edge has, each lattice vertex of the border moved onto the nearest of
// them (Fisher et al. 2009 stitch there; moving needs no other shape of micropolygon).
#pragma once

#include "dice/grid.h"
#include "dice/opened_mesh.h"

namespace granita {

struct Lattice {
    const Vec2d* corner_uv;  ///< [4]
    const PatchEdge* sides;  ///< [4] bottom, right, top, left
    int n_u, n_v;            ///< powers of two, at least what the sides need
};

/// Fills what a grid of the lattice holds, but for its identity, its bounds and what the frame does
/// with them; `grid` may hold another's.  Its material is the patch's.  Memory is kept from call to
/// call in the thread.
void dice_lattice(const OpenedMesh& mesh, const BasePatch& patch, const Lattice& lattice,
                  Grid& grid);

}  // namespace granita
