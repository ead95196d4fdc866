// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>

#include "math/vec.h"
#include "shade/rays/ray_type.h"

namespace granita {

/// A triangle, or quad, that rays meet, by Embree's numbers.
struct RayTarget {
    std::uint32_t instance = ~0u, geometry = ~0u, primitive = ~0u;
    bool operator==(const RayTarget&) const = default;
};

/// A way of light, in shading space.  What is no number, or 1e18 metres away, meets nothing.
struct Ray {
    Vec3f start, direction;  ///< direction is unit
    float distance;          ///< metres; may be infinite
    float time = 0.5f;       ///< of the shutter, [0, 1]
    int blocker_set = -1;    ///< of the light: others than Instance::blocks names let it pass
    RayType type = RayType::Shadow;
    /// Where it goes to: a face that shines, which casts no shadow on itself.
    RayTarget target = {};

    /// Embree leaves other rays undefined, and as Debian builds it ends the process at them.
    bool is_traceable() const {
        constexpr float kFarthest = 1e18f;
        for (int axis = 0; axis < 3; ++axis)
            if (!(std::abs(start[axis]) < kFarthest && std::abs(direction[axis]) < kFarthest))
                return false;
        return distance >= 0.0f && time >= 0.0f && time <= 1.0f;
    }
};

}  // namespace granita
