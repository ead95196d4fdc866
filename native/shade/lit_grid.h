// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "shade/light_source.h"
#include "shade/light_world_looks.h"
#include "shade/reflection.h"

namespace granita {

/// What a grid's points share while they are lit.
struct LitGrid {
    std::vector<Vec3f>& radiance;
    ReflectionParts* parts;  ///< nullptr = not asked for
    WorldLooks blurred, sharp;
    std::vector<Vec2f> lamp_points;         ///< of the lamp and point at hand
    std::vector<LightSample> lamp_samples;  ///< there
    std::uint64_t shadow_rays = 0, occlusion_rays = 0;

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
