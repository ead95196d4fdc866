// SPDX-License-Identifier: GPL-3.0-or-later
// The transforms of an instance as rays can have them: in shading space, in single precision, never
// without an inverse.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "math/vec.h"

namespace granita {

struct RayTransforms {
    /// Shading space from the object's, at equal steps of the shutter; one where it stands still.
    std::vector<Mat4d> knots;
    /// The same, 3 x 4, column by column.
    std::vector<std::array<float, 12>> columns;
    float scale = 1.0f;  ///< largest stretch at any knot, at least 1
    float distance =
        0.0f;  ///< of the object's origin at any knot from that of shading space, metres
};

/// None where the instance has no volume at any time, so that no ray could find its shadow, or
/// where its numbers are too large.  `origin`: of shading space, in the world.
std::optional<RayTransforms> ray_transforms(const std::vector<Mat4d>& world_from_object,
                                            const Vec3d& origin);

}  // namespace granita
