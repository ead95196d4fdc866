// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/shutter_warp.h"

#include <algorithm>
#include <cmath>

namespace granita {
namespace {

/// Where in a trapezoid of unit width and sides a, b (areas add to `area` from the left) the area
/// is reached: the root of a x + (b - a) x^2 / 2 = area, in the form that does not cancel.
double trapezoid_place(double a, double b, double area) {
    const double root = std::sqrt(std::max(0.0, a * a + 2.0 * (b - a) * area));
    return a + root > 0.0 ? std::clamp(2.0 * area / (a + root), 0.0, 1.0) : 0.0;
}

}  // namespace

ShutterWarp::ShutterWarp(const std::vector<float>& opening) {
    if (opening.size() < 2) return;
    const std::size_t spans = opening.size() - 1;
    std::vector<double> height(opening.size()), sum(opening.size(), 0.0);
    for (std::size_t i = 0; i < opening.size(); ++i)
        height[i] = opening[i] > 0.0f ? static_cast<double>(opening[i]) : 0.0;
    for (std::size_t i = 0; i < spans; ++i) sum[i + 1] = sum[i] + 0.5 * (height[i] + height[i + 1]);
    if (!(sum.back() > 0.0) || !std::isfinite(sum.back())) return;

    m_time.resize(kCells + 1);
    std::size_t span = 0;
    for (int cell = 0; cell <= kCells; ++cell) {
        const double target = sum.back() * cell / kCells;
        while (span + 1 < spans && sum[span + 1] <= target) ++span;
        const double place = trapezoid_place(height[span], height[span + 1], target - sum[span]);
        m_time[cell] =
            static_cast<float>((static_cast<double>(span) + place) / static_cast<double>(spans));
    }
}

float ShutterWarp::uniform(float time) const {
    if (m_time.empty()) return time;
    const auto after = std::upper_bound(m_time.begin(), m_time.end(), time);
    if (after == m_time.begin()) return 0.0f;
    if (after == m_time.end()) return 1.0f;
    const float before = *(after - 1);
    const auto cell = static_cast<float>(after - m_time.begin() - 1);
    return (cell + (time - before) / (*after - before)) / kCells;
}

}  // namespace granita
