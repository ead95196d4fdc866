// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "math/vec.h"

namespace granita {

/// The sky of Preetham, Shirley and Smits ("A Practical Analytic Model for Daylight", 1999), as
/// Cycles scales it.
class Daylight {
  public:
    /// @param to_sun unit.
    /// @param turbidity how hazy: 2 clear, 10 hazy.
    Daylight(const Vec3f& to_sun, float turbidity);

    /// XYZ of a unit direction; below the horizon that of the horizon.
    Vec3f xyz(const Vec3f& direction) const;

  private:
    /// Luminance or a chromaticity over the sky (Perez, Seals and Michalsky 1993).
    struct Distribution {
        std::array<float, 5> c;
        float zenith = 0.0f;
        /// @param cosine of the way to the zenith; `gamma` radians, to the sun.
        float at(float cosine, float gamma) const;
    };

    Vec3f m_to_sun;
    Distribution m_luminance, m_x, m_y;
};

}  // namespace granita
