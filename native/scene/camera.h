// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "math/projection.h"
#include "scene/lens_knots.h"

namespace granita {

/// The camera over the shutter.  Knots are equidistant in t in [0, 1].
struct Camera {
    std::string name;
    std::vector<Mat4d>
        world_from_camera;  ///< [K], camera space as in projection.h (z forward), no scale
    /// The frame before and the one after, for the pass Vector; empty = as at the frame.
    std::vector<Mat4d> adjacent;
    Projection projection;
    LensKnots lens;               ///< where the projection's lens moves
    int blades = 0;               ///< 0..2 = round
    float blade_rotation = 0.0f;  ///< radians
    bool operator==(const Camera&) const = default;
};

}  // namespace granita
