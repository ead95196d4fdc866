// SPDX-License-Identifier: GPL-3.0-or-later
// Sunlight in the air: single scattering by molecules and dust under a layer of ozone (Nishita,
// Sirai, Tadamura and Nakamae 1993, "Display of the Earth Taking into Account Atmospheric
// Scattering"), in 21 wavelengths, with the constants of Blender's Sky Texture.
#pragma once

#include <memory>
#include <vector>

#include "math/vec.h"

namespace granita {

/// Seen from a place above the ground.  Angles in radians, lengths in metres; densities are
/// relative to those of clear air.
struct Atmosphere {
    float sun_elevation = 0.0f;  ///< -pi / 2 to pi / 2
    float altitude = 0.0f;
    float air = 1.0f, dust = 1.0f, ozone = 1.0f;

    bool operator==(const Atmosphere&) const = default;

    /// XYZ radiance from a unit direction, z up, the sun over x; above the horizon.
    Vec3f sky(const Vec3f& direction) const;
    /// XYZ radiance of the sun at an elevation above the horizon, of so wide a disc.
    Vec3f sun(float elevation, float angular_diameter) const;
};

/// The sky over all directions, tabulated.
class SkyTable {
  public:
    explicit SkyTable(const Atmosphere& atmosphere);
    /// XYZ radiance; `elevation` above the horizon, radians; `azimuth` from the sun's, radians.
    Vec3f look_up(float elevation, float azimuth) const;

  private:
    std::vector<Vec3f> m_texels;  ///< [rows][columns]: half the sky, which is alike on both sides
};

/// The table of an atmosphere, kept among the last few: frames of one file share it.
/// Any thread.
std::shared_ptr<const SkyTable> sky_table(const Atmosphere& atmosphere);

}  // namespace granita
