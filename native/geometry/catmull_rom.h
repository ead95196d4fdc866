// SPDX-License-Identifier: GPL-3.0-or-later
// Catmull-Rom curves: through every point, with half the chord of its neighbours for a tangent
// (Catmull and Rom 1974).  At its ends a curve repeats its first and last point, as Cycles does.
#pragma once

#include <array>

namespace granita {

/// Weights of the points before, at, after and beyond the start of a segment at t in [0, 1].
struct CatmullRom {
    explicit CatmullRom(double t)
        : w{0.5 * t * (t * (2.0 - t) - 1.0), 0.5 * t * t * (3.0 * t - 5.0) + 1.0,
            0.5 * t * (t * (4.0 - 3.0 * t) + 1.0), 0.5 * t * t * (t - 1.0)},
          d{0.5 * (t * (4.0 - 3.0 * t) - 1.0), 0.5 * t * (9.0 * t - 10.0),
            0.5 * (t * (8.0 - 9.0 * t) + 1.0), 0.5 * t * (3.0 * t - 2.0)} {}

    template <class T, class At>
    static T sum(const std::array<double, 4>& weights, At at) {
        return at(0) * weights[0] + at(1) * weights[1] + at(2) * weights[2] + at(3) * weights[3];
    }

    std::array<double, 4> w;  ///< of the value
    std::array<double, 4> d;  ///< of the derivative by t
};

}  // namespace granita
