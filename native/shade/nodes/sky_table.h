// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "math/vec.h"
#include "shade/nodes/atmosphere.h"

namespace granita {

enum class SkyModel {
    Nishita,             ///< single scattering of Blender 3 and 4, that goes on below the horizon
    SingleScattering,    ///< of Blender 5, tabulated below the horizon too
    MultipleScattering,  ///< of Blender 5
};

/// Scattered sunlight over all directions, tabulated where Blender does.  Rows are denser towards
/// the horizon, columns are of half the sky, which is alike on both sides of the sun.
class SkyTable {
  public:
    SkyTable(SkyModel model, const Atmosphere& air);
    /// XYZ radiance; angles in radians, the azimuth from the sun's.
    Vec3f look_up(float elevation, float azimuth) const;

  private:
    template <class Scattering>
    void fill(const Scattering& scattering);

    SkyModel m_model;
    int m_rows_below;             ///< the horizon
    std::vector<Vec3f> m_texels;  ///< [rows][columns]
};

/// The table of an atmosphere, kept among the last few: frames of one file share it.
/// Any thread.
std::shared_ptr<const SkyTable> sky_table(SkyModel model, const Atmosphere& air);

}  // namespace granita
