// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "math/sampling.h"

namespace granita {

/// The cosine lobe that sheen is transformed to: wo -> (a x + b z, a y, z) in the frame whose x
/// leans to the view; and what is reflected of white light from all sides.
struct SheenFit {
    float a, b, albedo;
};

/// Rational functions of the cosine of the view and the roughness, as MaterialX publishes them for
/// the tables of Zeltner, Burley and Chiang (2022), from which Cycles reads: of roughness above .1
/// they are within .03, .015 and .004 (RMS) of these.  Seen from below, by smooth normals, it is as
/// where it is grazed (Cycles).
inline SheenFit sheen_fit(float cosine, float roughness) {
    const float x = std::clamp(cosine, 0.0f, 1.0f), y = std::clamp(roughness, 1e-3f, 1.0f);
    SheenFit fit{};
    fit.a = (2.58126f * x + 0.813703f * y) * y / (1.0f + 0.310327f * x * x + 2.60994f * x * y);
    fit.b = std::sqrt(1.0f - x) * (y - 1.0f) * y * y * y /
            (0.0000254053f + 1.71228f * x - 1.71506f * x * y + 1.34174f * y * y);
    const float width = y * (0.0206607f + 1.58491f * y) / (0.0379424f + y * (1.32227f + y));
    const float mean =
        y * (-0.193854f + y * (-1.14885f + y * (1.7932f - 0.95943f * y * y))) / (0.046391f + y);
    const float rest =
        y * (0.000654023f + (-0.0207818f + 0.119681f * y) * y) / (1.26264f + y * (-1.92021f + y));
    const float t = (x - mean) / width;
    fit.albedo = std::max(std::exp(-0.5f * t * t) / (width * std::sqrt(2.0f * kPi)) + rest, 0.0f);
    return fit;
}

}  // namespace granita
