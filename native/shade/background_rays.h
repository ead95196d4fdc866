// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "math/vec.h"

namespace granita {

/// Rays of the camera that see the world.
struct BackgroundRays {
    std::vector<Vec3f> directions{};  ///< [n] unit, world axes
    std::vector<Vec2f> rasters{};     ///< [n] pixels of the frame, of parallel rays; else empty
    float spread = 0.0f;              ///< radians that a direction stands for (texture filtering)
};

}  // namespace granita
