// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "math/vec.h"
#include "shade/rays/ray.h"

namespace granita {

struct KeptRayShape;

/// A triangle of a mesh, or half of a quad, as rays meet it.
struct RayTriangle {
    std::int32_t slot = 0;  ///< of the material
    RayTarget target;
    std::span<const std::array<Vec3f, 3>> corners;  ///< [knots] object space
};

/// None of curves and points.  `instance`: Embree's number of it.
void for_each_triangle(const KeptRayShape& of, std::uint32_t instance,
                       const std::function<void(const RayTriangle&)>& visit);

}  // namespace granita
