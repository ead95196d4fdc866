// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "geometry/corner_values.h"
#include "math/normalize_or.h"

namespace granita {

/// Shading normals of a polygon's patch whose mesh changes its shape, object space.
struct MovingNormals {
    std::vector<std::array<Vec3d, 4>> at;  ///< [NormalTimes::count()] of the corners, unit or zero

    /// Appends those of a place.
    void add(const CornerWeights& weights, std::vector<Vec3f>& to) const {
        for (const std::array<Vec3d, 4>& corners : at)
            to.emplace_back(normalize_or(blend(corners, weights.w), Vec3d(0.0)));
    }
};

}  // namespace granita
