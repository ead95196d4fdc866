// SPDX-License-Identifier: GPL-3.0-or-later
// What a ray knows of where it meets a surface.
#pragma once

#include <cstdint>

#include "geometry/element_values.h"
#include "geometry/shared_geometry.h"
#include "math/vec.h"
#include "shade/rays/ray.h"

namespace granita {

/// Of an instance at a time.
struct RayFrame {
    explicit RayFrame(const Mat4d& matrix);
    Mat3f world_from_object, object_from_world;  ///< of directions
    Mat3d world_from_normal;                     ///< as modelled, of any length
};

/// A point that a ray meets.
struct RayHit {
    std::uint32_t instance = 0;                ///< index in Scene::instances
    std::int32_t material = -1;                ///< index in Scene::materials, slot already resolved
    std::int32_t slot = 0;                     ///< of the material
    const SharedGeometry* geometry = nullptr;  ///< of a mesh
    const BasePatch* patch = nullptr;          ///< one of its patches
    Vec2d uv{0.0};                             ///< on the patch (PatchKind); of ribbons u, and how
                                               ///< far out, [-1, 1]
    const SharedElements* elements = nullptr;  ///< of curves and points
    ElementPlace place;                        ///< on one of them
    Vec3f p{0.0f};                             ///< world axes, origin at the camera
    Vec3f normal{0.0f};                        ///< unit, of what was met, world axes, as modelled
    Vec3f direction{0.0f};                     ///< unit, of the ray
    float distance = 0.0f;                     ///< along the ray, from where it started
    const RayFrame* frame = nullptr;           ///< of the instance at the ray's time
    RayTarget target;                          ///< what was met
};

}  // namespace granita
