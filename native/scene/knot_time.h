// SPDX-License-Identifier: GPL-3.0-or-later
// Times among the equidistant knots of a motion: what moves goes straight between them, transforms
// element by element, as Blender's knots are meant.
#pragma once

#include <cstddef>
#include <vector>

#include "math/vec.h"

namespace granita {

/// Where a time in [0, 1] of the shutter falls among equidistant knots.
struct KnotTime {
    std::size_t knot = 0;
    double fraction = 0.0;  ///< of the segment from `knot` on; 0 exactly at a knot
    bool operator==(const KnotTime&) const = default;
};

/// Time step / steps: exact at knots.
KnotTime knot_time(int step, int steps, int knots);
KnotTime knot_time(double time, int knots);

/// All knots are the same.
bool is_static(const std::vector<Mat4d>& matrices);

Mat4d matrix_at(const std::vector<Mat4d>& matrices, const KnotTime& time);
/// At a time of the shutter; of no knots: the identity.
Mat4d matrix_at(const std::vector<Mat4d>& matrices, double time);

}  // namespace granita
