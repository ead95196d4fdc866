// SPDX-License-Identifier: GPL-3.0-or-later
// Sunlight scattered many times, over a grey ground (Garcia Linan 2024, "A fast spectral sky"):
// light that was scattered once is marched along the view, all further scattering is a fit to path
// traced skies, in four wavelengths which a matrix takes to XYZ.  Distances in kilometres.
#pragma once

#include <vector>

#include "math/vec.h"
#include "shade/nodes/atmosphere.h"

namespace granita {

class MultipleScattering {
  public:
    explicit MultipleScattering(const Atmosphere& air);

    /// XYZ radiance from a unit direction, z up, the sun over x; below the horizon of the air
    /// before the ground.
    Vec3f sky(const Vec3f& direction) const;
    /// XYZ radiance of the sun at an elevation, of so wide a disc.
    static Vec3f sun(const Atmosphere& air, float elevation, float angular_diameter);

  private:
    /// Transmittance of the way out of the air.  `cosine` of it to the zenith.
    Vec4f look_up(float cosine, float height) const;
    /// All light but the sun's own that arrives, of a sun of irradiance 1, over 4 pi.
    Vec4f surroundings(float cosine, float height) const;

    Atmosphere m_air;
    std::vector<Vec4f> m_table;  ///< [height][cosine] transmittance
};

}  // namespace granita
