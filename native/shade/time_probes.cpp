// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/time_probes.h"

#include <algorithm>
#include <iterator>

namespace granita {
namespace {

/// Micropolygons for each one that is asked, and when: parts of the time that a grid is there for.
/// Not even ones, and not the ends alone: a highlight that sweeps past in the middle looks the same
/// before and after.
constexpr int kStep = 29;
constexpr float kTimes[] = {0.0f, 0.31f, 0.57f, 1.0f};

}  // namespace

std::vector<RefinedPoint> time_probes(const Grid& grid) {
    std::vector<RefinedPoint> points;
    const float open = std::max(grid.lifespan.open, 0.0f);
    const float exposed = std::min(grid.lifespan.close, 1.0f) - open;
    const int count = grid.micropolygon_count();
    for (int m = kStep / 2 % count; m < count; m += kStep) {
        const Grid::Corners c = grid.corners(m);
        const auto at = [](int v) { return static_cast<std::uint32_t>(v); };
        for (const float part : kTimes)
            points.push_back(
                {{at(c.v0), at(c.v1), at(c.v2)}, {0.5f, 0.0f, 0.5f}, open + part * exposed, at(m)});
    }
    return points;
}

bool any_changes(const std::vector<Vec3f>& values, float threshold,
                 float (*difference)(const Vec3f&, const Vec3f&)) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (difference(values[i], values[i - i % std::size(kTimes)]) > threshold) return true;
    return false;
}

}  // namespace granita
