// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "math/bounds.h"
#include "math/sampling.h"
#include "math/vec.h"

namespace granita {

/// Where lamps are, where their light goes and how much it can be: of one lamp over the shutter, or
/// of many.  At a point the irradiance is no more than the intensity / (d^2 + near2), d the
/// distance to the box, times the cosine of the angle by which the way there leaves the cone about
/// the axis, and none from `fall` past the cone on (Conty Estevez and Kulla 2018, 4.1).
struct LightBound {
    Bounds3f box;
    Vec3f axis{0.0f, 0.0f, -1.0f};
    float cone = -1.0f;  ///< radians; negative: nothing
    float fall = 0.0f;
    float near2 = 0.0f;                   ///< square metres
    float diffuse = 0.0f, glossy = 0.0f;  ///< intensity as such lobes see it, mean of the channels
    std::uint64_t sets = 0;               ///< of Instance::receives; all: lights everything
    bool is_face = false;                 ///< one of many of a mesh

    /// The box and the cone that hold both.
    void join(const LightBound& other);
    /// Both together.
    void add(const LightBound& other);
    /// One or the other: a lamp at another time.
    void add_time(const LightBound& other);
    /// What splits of a tree are judged by: surface times solid angle times power.
    float cost() const;
};

}  // namespace granita
