// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "math/vec.h"
#include "shade/rays/ray.h"
#include "shade/rays/ray_primitives.h"

namespace granita {

struct PersistentRayShape;

/// A triangle of a mesh, or half of a quad, as rays meet it.
struct RayTriangle {
    std::int32_t slot = 0;  ///< of the material
    RayTarget target;
    std::span<const std::array<Vec3f, 3>> corners;  ///< [knots] object space
};

/// The corners of a primitive at a time, and how many these are.
struct RayCorners {
    std::array<Vec3f, 4> points;
    std::uint32_t count;
};
RayCorners corners_at(const RayPart& part, std::uint32_t primitive, float time);

/// None of curves and points.  `instance`: Embree's number of it.
void for_each_triangle(const PersistentRayShape& of, std::uint32_t instance,
                       const std::function<void(const RayTriangle&)>& visit);

}  // namespace granita
