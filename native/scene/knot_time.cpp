// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/knot_time.h"

#include <algorithm>
#include <cmath>

namespace granita {

KnotTime knot_time(int step, int steps, int knots) {
    if (knots == 1 || steps == 0) return {};
    const int at = step * (knots - 1);
    return {static_cast<std::size_t>(at / steps), static_cast<double>(at % steps) / steps};
}

KnotTime knot_time(double time, int knots) {
    const double at = std::clamp(time, 0.0, 1.0) * (knots - 1);
    const double knot = std::floor(at);
    return {static_cast<std::size_t>(knot), at - knot};
}

bool is_static(const std::vector<Mat4d>& matrices) {
    return std::all_of(matrices.begin(), matrices.end(),
                       [&](const Mat4d& m) { return m == matrices.front(); });
}

Mat4d matrix_at(const std::vector<Mat4d>& matrices, const KnotTime& time) {
    if (time.fraction == 0.0) return matrices[time.knot];
    return matrices[time.knot] * (1.0 - time.fraction) + matrices[time.knot + 1] * time.fraction;
}

Mat4d matrix_at(const std::vector<Mat4d>& matrices, double time) {
    if (matrices.empty()) return Mat4d(1.0);
    return matrix_at(matrices, knot_time(time, static_cast<int>(matrices.size())));
}

}  // namespace granita
