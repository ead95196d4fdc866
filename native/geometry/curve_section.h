// SPDX-License-Identifier: GPL-3.0-or-later
// What a curve is like at one place and time of the shutter.
#pragma once

#include "geometry/element_values.h"

namespace granita {

/// Object space.
struct CurveSection {
    Vec3d along{0.0};  ///< change over a segment; zero where all its points are one
    double radius = 0.0;
};

/// `time` in [0, 1] of the shutter, among the geometry's knots.
CurveSection curve_section(const SharedElements& elements, const ElementPlace& place, double time);

}  // namespace granita
