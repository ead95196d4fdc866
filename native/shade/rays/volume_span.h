// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace granita {

/// A part of a ray that lies inside of an instance, metres along the ray.
struct VolumeSpan {
    std::uint32_t instance;  ///< in Scene::instances
    std::int32_t material;   ///< in Scene::materials
    float begin, end;        ///< not beyond the ray's own
};

}  // namespace granita
