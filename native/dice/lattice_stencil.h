// SPDX-License-Identifier: GPL-3.0-or-later
// The lattice of a small polygon as a table: what its sides' levels alone decide, be the face what
// it may.  A vertex is a sum of the corners, inside and on the border alike: along a straight edge
// the two corners' weights are multiples of a quarter, and the sum has the bits that the edge's
// owner finds.
#pragma once

#include <cstdint>
#include <vector>

#include "dice/parametric_positions.h"
#include "geometry/corner_values.h"

namespace granita {

struct LatticeStencil : ParametricPositions {
    /// Levels of a side's tree that there are tables for.
    static constexpr int kMostLevels = 2;
    static constexpr int kMostVertices = ((1 << kMostLevels) + 1) * ((1 << kMostLevels) + 1);

    std::vector<CornerWeights> weights;  ///< [vertices]

    int micropolygon_count() const { return n_u * n_v; }

    /// `levels` [4]: of the side that leaves each corner, 0 to kMostLevels; [3] for a triangle.
    /// Numbers begin at 0 and stand for of(number) everywhere.
    static std::uint32_t number(PatchKind kind, const int* levels);
    static const LatticeStencil& of(std::uint32_t number);
};

/// The side of a triangle, by the levels of its three, that becomes the bottom of a lattice:
/// opposite to it the patch narrows to a point.
int triangle_base(const int* levels);
/// Corners of the lattice of a triangle with this base.
void triangle_corners(int base, Vec2d* corner_uv);

}  // namespace granita
