// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace granita::test {

/// Part of the disc of radius r that lies left of its centre's distance x to the edge.
inline double edge_in_disc(double x, double r) {
    if (x <= -r) return 0;
    if (x >= r) return 1;
    return .5 + (x * std::sqrt(r * r - x * x) + r * r * std::asin(x / r)) / (M_PI * r * r);
}

}  // namespace granita::test
