// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "math/vec.h"
#include "shade/lights/light_lamp.h"

namespace granita {

/// A lamp as the places on rays that it lights go by it.
struct LightAnchor {
    Vec3f center{0.0f};      ///< shading space
    float intensity = 0.0f;  ///< mean of the channels
    float near2 = 0.0f;      ///< square metres: nearer than that it is no brighter
};

/// The strongest of lamps that have a place, but for those that move far.
std::vector<LightAnchor> anchors_of(const std::vector<Lamp>& lamps);

}  // namespace granita
