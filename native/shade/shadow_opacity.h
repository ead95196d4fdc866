// SPDX-License-Identifier: GPL-3.0-or-later
// How shadow rays ask materials what they let through.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "math/vec.h"

namespace granita {

/// A point that a shadow ray meets, in terms of the geometry's own data.
struct ShadowHit {
    std::uint32_t instance = 0;  ///< index in Scene::instances
    std::int32_t material = -1;  ///< index in Scene::materials, slot already resolved
    std::uint32_t face = 0;      ///< of the geometry
    /// Corners of the face (indices of GeometryData::corner_verts) and their weights, which sum
    /// to 1: an attribute at the hit is the weighted sum over them.
    struct Corner {
        std::uint32_t corner;
        float weight;
    };
    std::vector<Corner> corners;
    Vec3f p{0.0f};          ///< world axes, origin at the camera
    Vec3f normal{0.0f};     ///< unit, of the triangle, world axes, as modelled
    Vec3f direction{0.0f};  ///< unit, of the ray, from the shaded point to the light

    void add(std::uint32_t corner, float weight) { corners.push_back({corner, weight}); }
};

/// Both or neither are given; called from any thread.
struct ShadowOpacity {
    std::function<bool(std::int32_t material)> is_transparent;
    /// What passes the surface: 0 = opaque, 1 = nothing there.
    std::function<Vec3f(const ShadowHit&)> transparency;
};

}  // namespace granita
