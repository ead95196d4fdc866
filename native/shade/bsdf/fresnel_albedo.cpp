// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/fresnel_albedo.h"

#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/microfacet.h"
#include "shade/bsdf/unit_cube_table.h"

namespace granita {
namespace {

constexpr std::uint32_t kPoints = 512;  ///< an entry

/// `share(cosine)`: of the way from f0 to f90 that a facet is at.
template <class Share>
float integrate(float roughness, float cosine, const Share& share) {
    const float alpha = std::max(roughness * roughness, 1e-4f), mu = std::max(cosine, 1e-3f);
    const Vec3f view(std::sqrt(1.0f - mu * mu), 0.0f, mu);
    const SobolPoints points(0);
    double reflected = 0.0;
    for (std::uint32_t k = 0; k < kPoints; ++k) {
        const Vec3f half = sample_ggx_visible(view, alpha, points(k));
        const float h = glm::dot(view, half);
        if (2.0f * h * half.z > view.z) reflected += share(h);
    }
    return static_cast<float>(reflected / kPoints);
}

float integrate_dielectric(float roughness, float cosine, float ior) {
    const float f0 = f0_from_ior(ior);
    return integrate(roughness, cosine,
                     [&](float h) { return (fresnel_dielectric(h, ior) - f0) / (1.0f - f0); });
}

}  // namespace

float dielectric_share(float roughness, float cosine, float ior) {
    static const UnitCubeTable kTable(
        [](float x, float y, float z) { return integrate_dielectric(x, y, ior_of_axis(z)); });
    return kTable.look_up(roughness, cosine, ior_axis(ior));
}

float schlick_share(float roughness, float cosine) {
    static const UnitCubeTable kTable([](float x, float y, float z) {
        return z == 0.0f ? integrate(x, y, schlick_weight) : 0.0f;
    });
    return kTable.look_up(roughness, cosine, 0.0f);
}

}  // namespace granita
