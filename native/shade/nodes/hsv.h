// SPDX-License-Identifier: GPL-3.0-or-later
// Hue, saturation and value (or lightness), [0,1] each, as Blender computes them (Smith 1978).
#pragma once

#include "math/vec.h"

namespace granita {

Vec3f hsv_from_rgb(const Vec3f& rgb);
Vec3f rgb_from_hsv(const Vec3f& hsv);
Vec3f hsl_from_rgb(const Vec3f& rgb);
Vec3f rgb_from_hsl(const Vec3f& hsl);

}  // namespace granita
