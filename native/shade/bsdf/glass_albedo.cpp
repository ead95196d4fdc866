// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/glass_albedo.h"

#include "math/sampling.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/microfacet.h"
#include "shade/bsdf/refraction.h"
#include "shade/bsdf/unit_cube_table.h"

namespace granita {
namespace {

/// Of light that facets of GGX seen from `cosine` send up or down: what is left of 1 meets other
/// facets.  Visible normals are sampled: each counts as far as its light is not masked.
float integrate(float roughness, float cosine, float ior) {
    constexpr std::uint32_t kPoints = 256;
    const float alpha = std::max(roughness * roughness, 1e-4f), mu = std::max(cosine, 1e-3f);
    const Vec3f wi(std::sqrt(1.0f - mu * mu), 0.0f, mu);
    const float lambda = ggx_lambda(alpha, mu);
    const auto unmasked = [&](float cos_o) {
        return (1.0f + lambda) / (1.0f + lambda + ggx_lambda(alpha, cos_o));
    };
    const SobolPoints points(0);
    double sum = 0.0;
    for (std::uint32_t k = 0; k < kPoints; ++k) {
        const Vec3f half = sample_ggx_visible(wi, alpha, points(k));
        const float half_wi = glm::dot(wi, half);
        const float reflectance = fresnel_dielectric(half_wi, ior);
        const float up = 2.0f * half_wi * half.z - wi.z;
        if (up > 0.0f) sum += reflectance * unmasked(up);
        Vec3f down;
        if (refracted(wi, half, ior, down) && down.z < 0.0f)
            sum += (1.0f - reflectance) * unmasked(-down.z);
    }
    return static_cast<float>(sum / kPoints);
}

struct Albedo {
    explicit Albedo(bool into_denser)
        : directional([into_denser](float x, float y, float z) {
              const float ior = ior_of_axis(z);
              return integrate(x, y, into_denser ? ior : 1.0f / ior);
          }),
          average([this](float x, float, float z) {
              constexpr int kSteps = 16;
              float sum = 0.0f;
              for (int i = 0; i < kSteps; ++i) {
                  const float mu = (static_cast<float>(i) + 0.5f) / kSteps;
                  sum += 2.0f * mu * directional.look_up(x, mu, z) / kSteps;
              }
              return sum;
          }) {}

    UnitCubeTable directional;  ///< over roughness, cosine and index
    UnitCubeTable average;      ///< the cosine-weighted mean: alike along the second axis
};

const Albedo& albedo_of(float ior) {
    static const Albedo kInto(true), kOut(false);
    return ior >= 1.0f ? kInto : kOut;
}

}  // namespace

float glass_directional_albedo(float roughness, float cosine, float ior) {
    return albedo_of(ior).directional.look_up(roughness, cosine, ior_axis(ior));
}

Vec3f glass_compensation(const Vec3f& color, float roughness, float cosine, float ior) {
    const Albedo& albedo = albedo_of(ior);
    const float z = ior_axis(ior);
    const float e = albedo.directional.look_up(roughness, cosine, z);
    const float e_mean = albedo.average.look_up(roughness, 0.0f, z);
    const Vec3f bounced = color * e_mean / (Vec3f(1.0f) - color * (1.0f - e_mean));
    return Vec3f(1.0f) + bounced * ((1.0f - e) / e);
}

}  // namespace granita
