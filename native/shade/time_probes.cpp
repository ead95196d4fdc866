// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/time_probes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace granita {
namespace {

/// Probes of a small grid that tell chance from what all of its samples are wrong by.
constexpr int kFewest = 3;
/// Probes of those that corners see an edge in.
constexpr std::size_t kAtEdges = 4;
/// Parts of the time that a grid is there for.  Not even ones, and not the ends alone: a highlight
/// that sweeps past in the middle looks the same before and after.
constexpr float kTimes[] = {0.0f, 0.31f, 0.57f, 1.0f};
/// Of what is linear between these times.
constexpr float kWeights[] = {0.155f, 0.285f, 0.345f, 0.215f};
/// What all samples of a surface are wrong by is seen sooner than what differs from one to the
/// next: a side that turned by .5 within a shutter that ends at the frame was 3 % too bright.
constexpr float kBias = 0.125f;
/// Beyond which their mean is none of chance: light samples meet what moves at times of their own.
constexpr float kDeviations = 3.0f;
/// From the middle, in shutters.  Nearer, asking costs a fifth of a frame in motion for nothing.
constexpr float kOffMiddle = 0.1f;

}  // namespace

TimeProbes::TimeProbes(const Grid& grid, float frame_time, int step)
    : m_asks_corners(grid.micropolygon_count() > 1 && std::abs(frame_time - 0.5f) > kOffMiddle) {
    const int count = grid.micropolygon_count();
    if (m_asks_corners) step = std::clamp(count / kFewest, 1, step);
    for (int m = step / 2 % count; m < count; m += step) ask(grid, m);
}

TimeProbes::TimeProbes(const Grid& grid, std::span<const LampSight> sights) {
    std::vector<int> edges;
    for (int m = 0; m < grid.micropolygon_count(); ++m) {
        const std::size_t corner = grid.point_at(static_cast<std::size_t>(grid.corners(m).v0));
        const auto is_edge = [corner](const LampSight& sight) { return sight.differs(corner); };
        if (std::ranges::any_of(sights, is_edge)) edges.push_back(m);
    }
    const std::size_t wanted = std::min(edges.size(), kAtEdges);
    for (std::size_t k = 0; k < wanted; ++k)
        ask(grid, edges[(2 * k + 1) * edges.size() / (2 * wanted)]);
}

void TimeProbes::ask(const Grid& grid, int micropolygon) {
    const float open = std::max(grid.lifespan.open, 0.0f);
    const float exposed = std::min(grid.lifespan.close, 1.0f) - open;
    const Grid::Corners c = grid.corners(micropolygon);
    const auto at = [](int v) { return static_cast<std::uint32_t>(v); };
    const auto add = [&](float time) {
        points.push_back(
            {{at(c.v0), at(c.v1), at(c.v2)}, {0.5f, 0.0f, 0.5f}, time, at(micropolygon)});
    };
    for (const float part : kTimes) add(open + part * exposed);
    if (m_asks_corners) add(kAnyTime);
}

bool TimeProbes::any_changes(const std::vector<Vec3f>& values, float threshold,
                             float (*difference)(const Vec3f&, const Vec3f&)) const {
    constexpr std::size_t kCount = std::size(kTimes);
    const std::size_t each = kCount + (m_asks_corners ? 1 : 0);
    Vec3f of_corners(0.0f), sum(0.0f), squares(0.0f);
    for (std::size_t first = 0; first < values.size(); first += each) {
        Vec3f mean(0.0f);
        for (std::size_t k = 0; k < kCount; ++k) {
            if (difference(values[first + k], values[first]) > threshold) return true;
            mean += kWeights[k] * values[first + k];
        }
        if (!m_asks_corners) continue;
        const Vec3f apart = mean - values[first + kCount];
        of_corners += values[first + kCount];
        sum += apart;
        squares += apart * apart;
    }
    const std::size_t count = values.size() / each;
    const auto probes = static_cast<float>(count);
    // One alone tells nothing of chance.
    if (!m_asks_corners || probes < 2.0f) return false;
    const Vec3f spread = probes * squares - sum * sum;
    const Vec3f by_chance = kDeviations * kDeviations / (probes - 1.0f) * spread;
    if (!glm::any(glm::greaterThanEqual(sum * sum, by_chance))) return false;
    return difference((of_corners + sum) / probes, of_corners / probes) > kBias * threshold;
}

}  // namespace granita
