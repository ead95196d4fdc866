// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/vec.h"

namespace granita {

/// What a lobe of rough glass, reflected and refracted light together, is multiplied by to lose
/// nothing between its facets, and to take `color` at each bounce there (Kulla and Conty 2017).
/// Cosine of the view in [0, 1]; `ior` of the far side relative to the viewer's.  From tables that
/// are made at first use, in a tenth of a second.
Vec3f glass_compensation(const Vec3f& color, float roughness, float cosine, float ior);
/// What leaves white glass after one bounce; the same tables.
float glass_directional_albedo(float roughness, float cosine, float ior);

}  // namespace granita
