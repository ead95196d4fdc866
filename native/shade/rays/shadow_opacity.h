// SPDX-License-Identifier: GPL-3.0-or-later
// How shadow rays ask materials what they let through.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "geometry/element_values.h"
#include "geometry/shared_geometry.h"
#include "math/vec.h"

namespace granita {

/// Of an instance at a time.
struct ShadowFrame {
    explicit ShadowFrame(const Mat4d& matrix);
    Mat3f world_from_object, object_from_world;  ///< of directions
    Mat3d world_from_normal;                     ///< as modelled, of any length
};

/// A point that a shadow ray meets.
struct ShadowHit {
    std::uint32_t instance = 0;                ///< index in Scene::instances
    std::int32_t material = -1;                ///< index in Scene::materials, slot already resolved
    std::int32_t slot = 0;                     ///< of the material
    const SharedGeometry* geometry = nullptr;  ///< of a mesh
    const BasePatch* patch = nullptr;          ///< one of its patches
    Vec2d uv{0.0};                             ///< on the patch (PatchKind)
    const SharedElements* elements = nullptr;  ///< of curves and points
    ElementPlace place;                        ///< on one of them
    Vec3f p{0.0f};                             ///< world axes, origin at the camera
    Vec3f normal{0.0f};                        ///< unit, of what was met, world axes, as modelled
    Vec3f direction{0.0f};                     ///< unit, of the ray, from shaded point to light
    float distance = 0.0f;                     ///< along the ray, from where it started
    const ShadowFrame* frame = nullptr;        ///< of the instance at the ray's time
};

/// Both or neither are given; called from any thread.
struct ShadowOpacity {
    std::function<bool(std::int32_t material)> is_transparent;
    /// What passes the surface: 0 = opaque, 1 = nothing there.
    std::function<Vec3f(const ShadowHit&)> transparency;
    /// The same of a material where it is one everywhere: places are then not looked up.  May be
    /// missing.
    std::function<std::optional<Vec3f>(std::int32_t material)> constant = nullptr;
};

}  // namespace granita
