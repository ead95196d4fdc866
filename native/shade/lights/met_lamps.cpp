// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/met_lamps.h"

#include "base/sorted_runs.h"

namespace granita {
namespace {

void add(LitGrid& grid, const MetLamp& met) {
    const BsdfValue arriving = met.weight * met.sample.radiance;
    if (total(arriving) == Vec3f(0.0f)) return;
    grid.add_met(met.point->index, total(arriving) * met.through, met.sign, met.whole);
    grid.add_lamp(met.point->index, arriving, met.through);
}

}  // namespace

/// Of a mesh that shines a ray meets faces behind each other: nodes are asked of those that it
/// reaches.  Passes tell of the others too.
void add_met(const LampSet& set, LitGrid& grid, MetLamp met) {
    const bool waits = met.lamp->pattern() != nullptr;
    if (!waits && met.sample.radiance == Vec3f(0.0f)) return;
    met.through = set.passed(grid, *met.point, met.place, *met.lamp, met.sample, met.ray);
    if (!waits)
        add(grid, met);
    else if (grid.parts || met.through != Vec3f(0.0f))
        grid.met_lamps.push_back(met);
}

/// Light arrives at each point in the order of its samples, whatever else was met.
void deliver_met(LitGrid& grid) {
    std::vector<MetLamp>& later = grid.met_lamps;
    const auto pattern = [&](std::uint32_t i) { return later[i].lamp->pattern(); };
    std::vector<std::uint32_t> order;
    std::vector<PatternSample> samples;
    for_sorted_runs(order, later.size(), pattern, [&](std::span<const std::uint32_t> run) {
        samples.clear();
        for (const std::uint32_t i : run) {
            MetLamp& met = later[i];
            samples.push_back(met.lamp->patterned(met.place.time, met.place.p, met.sample));
        }
        pattern(run[0])->color(samples);
    });
    for (const MetLamp& met : later) add(grid, met);
    later.clear();
}

}  // namespace granita
