// SPDX-License-Identifier: GPL-3.0-or-later
// From what artists say of a translucent body, its colour and how far light goes in it, to the
// medium that looks so (Chiang, Kutz and Burley 2016, "Practical and Controllable Subsurface
// Scattering for Production Path Tracing").
#pragma once

#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "math/vec.h"

namespace granita {

/// Single-scattering albedo of a half-space, with the same index as what is around it, that sends
/// back `albedo` of diffuse light; `g`: mean cosine of its phase function.  Van de Hulst's fit to
/// the spherical albedo (1980, "Multiple Light Scattering", good to .002) solved for its root of
/// (1 - w) / (1 - g w), as Kulla and Conty (2017) and d'Eon (2022, section 53) do.
inline float single_scattering_albedo(float albedo, float g) {
    const float a = std::clamp(albedo, 0.0f, 1.0f), b = 1.139f + 1.17f * a;
    // .139 s^2 - b s + (1 - a) = 0, without cancellation.
    const float s = 2.0f * (1.0f - a) / (b + std::sqrt(b * b - 0.556f * (1.0f - a)));
    return std::clamp((1.0f - s * s) / (1.0f - g * s * s), 0.0f, 1.0f);
}

/// Reduced mean free path, as a share of the diffuse one, of a half-space of `ior` that sends back
/// `albedo`: s with R(s) = albedo, by the diffuse reflectance of Jensen, Marschner, Levoy and
/// Hanrahan 2001 ("A Practical Model for Subsurface Light Transport", section 2.4).
inline float mean_free_share(float albedo, float ior) {
    const float f_dr = (-1.440f / ior + 0.710f) / ior + 0.668f + 0.0636f * ior;
    const float a = (1.0f + f_dr) / (1.0f - f_dr);
    const auto reflectance = [a](float s) {
        return 0.5f * (1.0f - s * s / 3.0f) * (1.0f + std::exp(-4.0f / 3.0f * a * s)) *
               std::exp(-s);
    };
    float low = 0.0f, high = std::sqrt(3.0f);
    for (int step = 0; step < 24; ++step) {
        const float middle = 0.5f * (low + high);
        (reflectance(middle) > albedo ? low : high) = middle;
    }
    return std::max(0.5f * (low + high), 1e-3f);
}

/// What Blender calls a radius is the reach of older profiles.
constexpr float kMeanFreeShareOfReach = 0.25f * kInversePi;

/// By channel.
struct ScatteringMedium {
    Vec3f extinction{1.0f};  ///< 1 / metres
    Vec3f albedo{0.0f};      ///< of one scattering
    float g = 0.0f;          ///< mean cosine of the phase function

    /// `path`: reduced mean free, metres.
    ScatteringMedium(const Vec3f& surface_albedo, const Vec3f& path, float mean_cosine)
        : extinction(1.0f / (glm::max(path, Vec3f(1e-12f)) * (1.0f - mean_cosine))),
          g(mean_cosine) {
        for (int c = 0; c < 3; ++c) albedo[c] = single_scattering_albedo(surface_albedo[c], g);
    }
    /// One without a preferred direction in which light comes as far after many scatterings
    /// (similarity: Wyman, Patterson and Wilson 1989).
    ScatteringMedium isotropic() const {
        ScatteringMedium like = *this;
        like.extinction *= 1.0f - albedo * g;
        like.albedo *= (1.0f - g) / (1.0f - albedo * g);
        like.g = 0.0f;
        return like;
    }
};

}  // namespace granita
