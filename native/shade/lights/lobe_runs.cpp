// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lobe_runs.h"

#include <algorithm>
#include <numeric>

namespace granita {
namespace {

/// Samples that a point takes of a lobe of the closure.
int samples_of(const LitPoint& point, std::size_t lobe) {
    for (std::size_t k = 0; k < point.samples.size(); ++k)
        if (point.bsdf.index(k) == lobe) return point.samples[k].count;
    return 0;
}

bool all_alike(const std::vector<LitPoint>& points, std::size_t lobe_count) {
    for (std::size_t lobe = 0; lobe < lobe_count; ++lobe) {
        const int first = samples_of(points[0], lobe);
        for (const LitPoint& point : points)
            if (samples_of(point, lobe) != first) return false;
    }
    return true;
}

}  // namespace

void place_lobe_samples(std::vector<LitPoint>& points, std::size_t lobe_count, bool placed) {
    if (points.empty()) return;
    if (placed || all_alike(points, lobe_count)) {
        for (LitPoint& point : points)
            for (LitPoint::LobeSamples& lobe : point.samples)
                lobe.first = point.place * static_cast<std::uint32_t>(lobe.count);
        return;
    }
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&points](std::uint32_t a, std::uint32_t b) {
        return points[a].place < points[b].place;
    });
    std::vector<std::uint32_t> taken(lobe_count, 0);
    for (const std::uint32_t i : order) {
        LitPoint& point = points[i];
        for (std::size_t k = 0; k < point.samples.size(); ++k) {
            std::uint32_t& next = taken[point.bsdf.index(k)];
            point.samples[k].first = next;
            next += static_cast<std::uint32_t>(point.samples[k].count);
        }
    }
}

}  // namespace granita
