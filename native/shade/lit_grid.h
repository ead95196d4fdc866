// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "shade/light_source.h"
#include "shade/light_world_looks.h"
#include "shade/lit_point.h"
#include "shade/reflection.h"

namespace granita {

/// What a grid's points share while they are lit.
struct LitGrid {
    std::vector<Vec3f>& radiance;
    ReflectionParts* parts;  ///< nullptr = not asked for
    WorldLooks blurred, sharp;
    std::vector<Vec2f> lamp_points;         ///< of the lamp and point at hand
    std::vector<LightSample> lamp_samples;  ///< there
    std::uint64_t seed = 0;
    std::vector<SobolPoints> sequences = {};  ///< [dimensions] as far as they were asked for
    std::uint64_t shadow_rays = 0, occlusion_rays = 0;

    /// A point's `count` samples of a sequence that the grid shares.  Each takes as many as it
    /// uses: if all left out the ends of equal runs, all would miss the same strata.
    SobolPoints sequence(const LitPoint& point, std::size_t dimension, int count) {
        while (sequences.size() <= dimension)
            sequences.emplace_back(seed + 0x9e3779b97f4a7c15ULL * (sequences.size() + 1));
        return sequences[dimension].from(point.place * static_cast<std::uint32_t>(count));
    }
    /// Light of a lamp: `value` reflected without shadow.
    void add_lamp(std::size_t point, const BsdfValue& value, const Vec3f& shadow) {
        if (!parts) return;
        parts->diffuse[point] += value.diffuse * shadow;
        parts->glossy[point] += value.glossy * shadow;
        parts->arriving[point] += total(value) * shadow;
        parts->unblocked[point] += total(value);
    }
    /// Asks the world later; `weight` is 0 where nothing can be seen of it.
    void look(WorldLooks& looks, std::size_t point, const Vec3f& direction,
              const BsdfValue& weight) {
        if (total(weight) == Vec3f(0.0f)) return;
        looks.add(point, direction, total(weight));
        if (parts) looks.parts.push_back(weight);
    }
    void add_world(std::size_t point, const BsdfValue& value) {
        if (!parts) return;
        parts->diffuse[point] += value.diffuse;
        parts->glossy[point] += value.glossy;
    }
};

}  // namespace granita
