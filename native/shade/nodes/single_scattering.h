// SPDX-License-Identifier: GPL-3.0-or-later
// Sunlight in the air: single scattering by molecules and dust under a layer of ozone (Nishita,
// Sirai, Tadamura and Nakamae 1993, "Display of the Earth Taking into Account Atmospheric
// Scattering"), in 21 wavelengths, with the constants of Blender's Sky Texture.
#pragma once

#include "math/vec.h"
#include "shade/nodes/atmosphere.h"

namespace granita {

class SingleScattering {
  public:
    explicit SingleScattering(const Atmosphere& air) : m_air(air) {}

    /// XYZ radiance from a unit direction, z up, the sun over x; above the horizon.
    Vec3f sky(const Vec3f& direction) const;
    /// XYZ radiance of the sun at an elevation above the horizon, of so wide a disc.
    static Vec3f sun(const Atmosphere& air, float elevation, float angular_diameter);

  private:
    Atmosphere m_air;
};

}  // namespace granita
