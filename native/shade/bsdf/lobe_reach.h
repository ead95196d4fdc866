// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "math/vec.h"

namespace granita {

/// Unit directions within an angle of one.
struct DirectionCone {
    Vec3f axis{0.0f};
    float cos = 1.0f, sin = 0.0f;  ///< of the angle

    /// Widens it to hold another direction; the axis stays.
    void add(const Vec3f& direction);
};

/// What a lobe may reflect of light from an angle, as a bound that costs little: a diffuse lobe
/// `scale` times the cosine to the normal; a glossy one `scale` / t^2 (`long_tail`: / t), with
/// t = sin^2 + alpha2 cos^2 of half the angle to the mirrored view.  That half is the least angle
/// between the normal and a half vector: reflecting about both turns by twice the angle between.
struct LobeReach {
    std::size_t index = 0;  ///< in SurfaceClosure::lobes
    bool glossy = false, long_tail = false;
    bool glossy_light = false;  ///< it is lit by what lamps give to glossy lobes
    DirectionCone normal, mirrored;
    float scale = 0.0f, alpha2 = 1.0f;

    /// Bounds the same lobe at another point as well.
    void join(const LobeReach& other);
};

}  // namespace granita
