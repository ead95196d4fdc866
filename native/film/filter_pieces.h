// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "film/filter.h"

namespace granita {

/// A pixel filter as polynomials of the fifth degree over the twelfths of its radius: all filters'
/// knots lie on sixths, so every piece is smooth and the polynomials are within 1e-6 of the
/// filter's peak (filter_test.cpp).  Sixteen pieces fit the table look-ups of a vector register,
/// which cost a quarter of gathers from a long table.
struct FilterPieces {
    static constexpr int kPieces = 12, kTable = 16, kDegree = 5;

    explicit FilterPieces(const PixelFilter& filter);

    /// Of power k of the place from the piece's middle, in pieces; those from kPieces on are 0.
    float coefficient[kDegree + 1][kTable] = {};
    float pieces_a_pixel;
    bool is_box;
    float radius, height;  ///< of a BOX, which is compared and not fitted: it holds its left end
};

}  // namespace granita
