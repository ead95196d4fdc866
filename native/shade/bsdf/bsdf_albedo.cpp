// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/bsdf_albedo.h"

#include "shade/bsdf/microfacet.h"

namespace granita {
namespace {

/// With visible normals sampled, the mean of G2 / G1 is the albedo.  512 points of a scrambled net:
/// error below 1e-3, less than the tables' own interpolation error at grazing angles.
float integrate_albedo(float roughness, float cos_wi) {
    constexpr std::uint32_t kPoints = 512;
    const float alpha = roughness * roughness;
    if (alpha < 1e-4f) return 1.0f;
    const float cos_i = std::max(cos_wi, 1e-4f);  // the limit at 0 is finite, the formulas are not
    const Vec3f wi(std::sqrt(1.0f - cos_i * cos_i), 0.0f, cos_i);
    const float lambda_i = ggx_lambda(alpha, cos_i);
    const SobolPoints points(0);
    double sum = 0.0;
    for (std::uint32_t k = 0; k < kPoints; ++k) {
        const Vec3f h = sample_ggx_visible(wi, alpha, points(k));
        const float cos_o = 2.0f * glm::dot(wi, h) * h.z - wi.z;
        if (cos_o <= 0.0f) continue;
        sum += (1.0f + lambda_i) / (1.0f + lambda_i + ggx_lambda(alpha, cos_o));
    }
    return static_cast<float>(sum / kPoints);
}

struct Interpolation {
    int index;
    float fraction;
};

Interpolation locate(float x, int size) {
    const float t = std::clamp(x, 0.0f, 1.0f) * static_cast<float>(size - 1);
    const int index = std::min(static_cast<int>(t), size - 2);
    return {index, t - static_cast<float>(index)};
}

}  // namespace

const GgxAlbedo& GgxAlbedo::shared() {
    static const GgxAlbedo tables;
    return tables;
}

GgxAlbedo::GgxAlbedo() {
    for (int r = 0; r < kSize; ++r) {
        const float roughness = static_cast<float>(r) / (kSize - 1);
        for (int c = 0; c < kSize; ++c)
            m_directional[r][c] = integrate_albedo(roughness, static_cast<float>(c) / (kSize - 1));
        double sum =
            0.0;  // 2 mu E(mu): trapezoids are exact for the piecewise-linear table's scale
        for (int c = 0; c < kSize; ++c) {
            const double mu = static_cast<double>(c) / (kSize - 1);
            sum += (c == kSize - 1 ? 0.5 : 1.0) * 2.0 * mu * m_directional[r][c];
        }
        m_average[r] = static_cast<float>(sum / (kSize - 1));
    }
}

float GgxAlbedo::directional(float roughness, float cos_wi) const {
    const Interpolation r = locate(roughness, kSize), c = locate(cos_wi, kSize);
    const auto row = [&](int k) {
        const auto& values = m_directional[static_cast<std::size_t>(k)];
        return values[c.index] + c.fraction * (values[c.index + 1] - values[c.index]);
    };
    const float low = row(r.index);
    return low + r.fraction * (row(r.index + 1) - low);
}

float GgxAlbedo::average(float roughness) const {
    const Interpolation r = locate(roughness, kSize);
    return m_average[r.index] + r.fraction * (m_average[r.index + 1] - m_average[r.index]);
}

}  // namespace granita
