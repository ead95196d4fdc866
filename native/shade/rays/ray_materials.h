// SPDX-License-Identifier: GPL-3.0-or-later
// What materials do to light, as rays ask them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>

#include "math/vec.h"
#include "scene/scene.h"
#include "shade/rays/ray_hit.h"

namespace granita {

/// Called from any thread; any may be missing, of the first two both.
struct RayMaterials {
    std::function<bool(std::int32_t material)> is_transparent;
    /// What passes the surface: 0 = opaque, 1 = nothing there.
    std::function<Vec3f(const RayHit&)> transparency;
    /// The same of a material where it is one everywhere: places are then not looked up.
    std::function<std::optional<Vec3f>(std::int32_t material)> constant = nullptr;
    /// What it sends to all sides and from everywhere, so that its meshes are lamps; 0: they are
    /// none.
    std::function<Vec3f(std::int32_t material)> emitted = nullptr;
    /// Whether light is scattered below its surfaces, which rays then meet from inside.
    std::function<bool(std::int32_t material)> is_scattering = nullptr;

    bool scatters(const Instance& instance) const {
        return is_scattering && std::ranges::any_of(instance.materials, is_scattering);
    }
    /// Whether meshes of the instance are lamps, and what rays leave the lamps light.
    bool shines(const Instance& instance) const {
        if (!emitted || !instance.is_seen_by_surfaces()) return false;
        return std::ranges::any_of(instance.materials, [this](std::int32_t material) {
            return emitted(material) != Vec3f(0.0f);
        });
    }
};

}  // namespace granita
