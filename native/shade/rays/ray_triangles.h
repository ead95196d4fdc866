// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "math/vec.h"

namespace granita {

struct KeptRayShape;

/// A triangle of a mesh, or half of a quad, as rays meet it.
struct RayTriangle {
    std::int32_t slot = 0;                          ///< of the material
    std::span<const std::array<Vec3f, 3>> corners;  ///< [knots] object space
};

/// None of curves and points.
void for_each_triangle(const KeptRayShape& of,
                       const std::function<void(const RayTriangle&)>& visit);

}  // namespace granita
