// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lamp_samples.h"

#include <algorithm>
#include <numeric>

namespace granita {
namespace {

/// Of lamps by chance: those that one point has chosen hardly ever share one.
constexpr std::size_t kDimensions = 32;

std::vector<LampTurn> by_lamp(std::size_t lamp_count, const std::vector<LampTurn>& turns) {
    std::vector<std::uint32_t> begin(lamp_count + 1, 0);
    for (const LampTurn& turn : turns) ++begin[turn.lamp + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<LampTurn> sorted(turns.size());
    for (const LampTurn& turn : turns) sorted[begin[turn.lamp]++] = turn;
    return sorted;
}

}  // namespace

void sample_lamp(const LampSet& set, LitGrid& grid, const LitPoint& point, const LampTurn& turn,
                 std::size_t dimension, ShadowQueue& shadows) {
    const Lamp& lamp = set.lamps[turn.lamp];
    const int wanted = set.samples_of(point, lamp);
    const int count = std::min(wanted, turn.rate.samples);
    // One sample of many tells all where nothing varies along its ray; one of one is any time's.
    const bool timed = set.changes(lamp) && (wanted > 1 || point.sample_count == 1);
    const SobolPoints sequence = grid.sequence(point, dimension, count);
    const auto add = [&](const LitPlace& place, const LightSample& sample, int s) {
        if (!(sample.pdf > 0.0f)) return;
        const BsdfValue bsdf = lamp.apply(point.bsdf.evaluate(sample.direction), grid.in_medium);
        const Vec3f value = total(bsdf) * sample.radiance;
        if (value == Vec3f(0.0f)) return;
        float density = static_cast<float>(count) * sample.pdf * turn.rate.mean;
        if (!lamp.is_hard() && lamp.meets_lobes())
            density += point.meeting_density(sample.direction);
        const BsdfValue parts = bsdf * (sample.radiance / density);
        const float sign = turn.sign != 0.0f ? turn.sign : LitGrid::sign(s, count);
        if (set.rays && lamp.casts_shadow())
            shadows.send(point.index, value / density, parts, sign,
                         set.ray_to(point, place, lamp, sample));
        else
            shadows.send(point.index, value / density, parts, sign);
    };
    grid.lamp_points.clear();
    for (int s = 0; s < count; ++s)
        grid.lamp_points.push_back(sequence(static_cast<std::uint32_t>(s)));
    grid.lamp_samples.resize(grid.lamp_points.size());
    if (!timed) {
        const LitPlace& place = point.at_frame;
        if (!lamp.exists(place.time)) return;
        lamp.sample_all(place.time, place.p, grid.lamp_points, grid.lamp_samples);
        for (int s = 0; s < count; ++s)
            add(place, grid.lamp_samples[static_cast<std::size_t>(s)], s);
        return;
    }
    for (std::size_t s = 0; s < grid.lamp_points.size(); ++s) {
        const LitPlace place = set.place_at(point, sequence.third(static_cast<std::uint32_t>(s)));
        if (!lamp.exists(place.time)) continue;
        lamp.sample(place.time, place.p, grid.lamp_points[s], grid.lamp_samples[s]);
        add(place, grid.lamp_samples[s], static_cast<int>(s));
    }
}

void light_by_all(const LampSet& set, LitGrid& grid, const std::vector<LitPoint>& points,
                  std::size_t first, const Progress& progress) {
    ShadowQueue shadows(set.rays.get(), grid);
    const std::size_t count = set.tree ? set.everywhere : set.lamps.size();
    for (std::size_t l = 0; l < count; ++l) {
        if (!set.lamps[l].lights(grid.receives)) continue;
        for (const LitPoint& point : points) {
            progress.check();
            const LampTurn turn{0, static_cast<std::uint32_t>(l), {1.0f, point.sample_count}};
            sample_lamp(set, grid, point, turn, first + l, shadows);
        }
        shadows.deliver();
    }
}

void light_by_chosen(const LampSet& set, LitGrid& grid, const std::vector<LitPoint>& points,
                     const std::vector<LampTurn>& turns, std::size_t first,
                     const Progress& progress) {
    ShadowQueue shadows(set.rays.get(), grid);
    for (const LampTurn& turn : by_lamp(set.lamps.size(), turns)) {
        progress.check();
        if (!set.lamps[turn.lamp].lights(grid.receives)) continue;
        sample_lamp(set, grid, points[turn.point], turn, first + turn.lamp % kDimensions, shadows);
    }
    shadows.deliver();
}

}  // namespace granita
