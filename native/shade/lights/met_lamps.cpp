// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/met_lamps.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace granita {
namespace {

void add(const LampSet& set, LitGrid& grid, const MetLamp& met) {
    const BsdfValue arriving = met.weight * met.sample.radiance;
    if (total(arriving) == Vec3f(0.0f)) return;
    const Vec3f seen = set.shadow(grid, *met.point, met.place, *met.lamp, met.sample);
    grid.add(met.point->index, total(arriving) * seen, met.sign);
    grid.add_lamp(met.point->index, arriving, seen);
}

}  // namespace

void add_met(const LampSet& set, LitGrid& grid, const MetLamp& met) {
    if (met.lamp->pattern())
        grid.met_lamps.push_back(met);
    else
        add(set, grid, met);
}

/// Light arrives at each point in the order of its samples, whatever else was met.
void deliver_met(const LampSet& set, LitGrid& grid) {
    std::vector<MetLamp>& later = grid.met_lamps;
    std::vector<std::uint32_t> order(later.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto pattern = [&](std::uint32_t i) { return later[i].lamp->pattern(); };
    std::ranges::stable_sort(order, std::less<>(), pattern);
    std::vector<PatternSample> samples;
    for (std::size_t begin = 0, end; begin < order.size(); begin = end) {
        samples.clear();
        for (end = begin; end < order.size() && pattern(order[end]) == pattern(order[begin]);
             ++end) {
            MetLamp& met = later[order[end]];
            samples.push_back(met.lamp->patterned(met.place.time, met.place.p, met.sample));
        }
        pattern(order[begin])->color(samples);
    }
    for (const MetLamp& met : later) add(set, grid, met);
    later.clear();
}

}  // namespace granita
