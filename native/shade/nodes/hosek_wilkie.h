// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "math/vec.h"

namespace granita {

/// The sky of Hosek and Wilkie ("An Analytic Model for Full Spectral Sky-Dome Radiance", 2012), as
/// Cycles scales it.
class HosekWilkieSky {
  public:
    /// @param to_sun unit; a sun below the horizon stands on it.
    /// @param turbidity how hazy: 1 to 10.
    /// @param ground_albedo 0 to 1.
    HosekWilkieSky(const Vec3f& to_sun, float turbidity, float ground_albedo);

    /// XYZ of a unit direction; below the horizon that of the horizon, at its angle to the sun.
    Vec3f xyz(const Vec3f& direction) const;

  private:
    /// One of X, Y and Z over the sky.
    struct Distribution {
        std::array<float, 9> shape{};
        float radiance = 0.0f;
        /// @param cosine of the way to the zenith; `gamma` radians, to the sun.
        float at(float cosine, float gamma) const;
    };

    Vec3f m_to_sun;
    std::array<Distribution, 3> m_xyz;
};

}  // namespace granita
