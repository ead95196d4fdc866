// SPDX-License-Identifier: GPL-3.0-or-later
// Where REGULAR's samples lie: one lattice over the frame, the same in every pixel and every pass.
#pragma once

#include "math/bounds.h"
#include "math/vec.h"

namespace granita {

/// `side` x `side` cells along the pixel's sides (the paper, 9.3.3); or, with one sample more, that
/// lattice rotated by atan(1 / side), so that no two samples of a pixel share a row or a column.
/// Edges along the axes, which the former places to 1 / side of a pixel, are then placed to one
/// in side^2 + 1: what passes add does not ripple with the lattice (docs/decisions/hiding.md).
///
/// Texels are those of a raster target, a sample each; texel coordinates (i, j) of a point (x, y)
/// of the frame are side * (x, y), or (side x + y, side y - x [+ 1/2 where the side is odd]), and a
/// sample lies at its texel's centre.  Whole pixels are whole texels in both.
struct RegularLattice {
    int side = 1;
    bool rotated = false;

    constexpr RegularLattice(int cells_a_side = 1, bool is_rotated = false)
        : side(cells_a_side), rotated(is_rotated) {}

    int cells() const { return side * side + (rotated ? 1 : 0); }
    /// Of sample `cell` of a pixel, relative to the pixel; as SampleTable has it.
    Vec2f place(int cell) const;
    /// Relative to the pixel's first_texel().
    Vec2i texel(int cell) const;
    /// Of a frame pixel; may be negative.
    Vec2i first_texel(Vec2i pixel) const;
    /// The least rectangle that holds the texels of these pixels' samples.
    Rect texels_of(const Rect& pixels) const;
    /// The sample nearest to the pixel's centre; the first of such.
    int center_cell() const;
};

}  // namespace granita
