// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/leaving_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace granita {

Vec3f inwards(const ShadingPoints& points, std::size_t i) {
    if (!points.edges) return Vec3f(0.0f);
    const std::size_t column = i % points.columns, row = i / points.columns;
    const auto towards = [](std::size_t at, std::size_t last) {
        return (at == 0 ? kInwards : 0.0f) - (at == last ? kInwards : 0.0f);
    };
    return towards(column, points.columns - 1) * points.dp_du[i] +
           towards(row, points.count / points.columns - 1) * points.dp_dv[i];
}

float width_of(const ShadingPoints& points, std::size_t i) {
    return std::max(glm::length(points.dp_du[i]), glm::length(points.dp_dv[i]));
}

void leave(const LampSet& set, LitGrid& grid, const LitPoint& point, const Ray& ray,
           const BsdfValue& value, const WayChance& chance, std::uint32_t place,
           const WorldAhead& world) {
    const Vec3f weight = total(value);
    if (weight == Vec3f(0.0f) || !is_finite(weight)) return;
    // A sample's part of the hemisphere, for rays that diffuse lobes send; else what a point of the
    // picture is seen in: bumps and textures in mirrors are as fine as those beside them.
    const float distance = glm::length(point.at_frame.p);
    const bool widens = grid.depth == 0 && !set.parallel_view && distance > 0.0f;
    const float seen = widens ? point.width / distance : 0.0f;
    const float spread = is_diffuse(ray.type)
                             ? std::sqrt(2.0f * kPi / static_cast<float>(point.sample_count))
                             : seen;
    // Each grid has a part of the sequences to itself, as samples that are shaded alone have.
    const auto first = grid.placed ? 0u : static_cast<std::uint32_t>(grid.seed) << 14;
    const Vec3f whole = glm::max(weight, Vec3f(std::numeric_limits<float>::min()));
    const int samples = is_sharp(ray.type) && !set.varies ? point.sample_count : 1;
    grid.leaving->rays.push_back(
        {ray, weight, value.diffuse / whole, value.transmission / whole, chance.share, chance.pdf,
         static_cast<std::uint32_t>(point.index), first + place, samples,
         std::min(1.0f, largest(weight)) * static_cast<float>(point.sample_count), point.width,
         spread, grid.receives, world});
}

}  // namespace granita
