// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/dielectric_albedo.h"

#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/bsdf/bsdf_albedo.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/unit_cube_table.h"

namespace granita {

namespace {

constexpr int kSide = 16;  // kSide^2 quadrature points an entry

float smith_lambda(float cosine, float alpha) {
    const float c2 = cosine * cosine;
    return 0.5f * (std::sqrt(1.0f + alpha * alpha * (1.0f - c2) / c2) - 1.0f);
}

/// A visible microfacet normal for the unit square (Heitz 2018, "Sampling the GGX distribution of
/// visible normals").
Vec3f visible_normal(const Vec3f& view, float alpha, float u0, float u1) {
    const Vec3f stretched = glm::normalize(Vec3f(alpha * view.x, alpha * view.y, view.z));
    const float across = stretched.x * stretched.x + stretched.y * stretched.y;
    const Vec3f t1 = across > 0.0f ? Vec3f(-stretched.y, stretched.x, 0.0f) / std::sqrt(across)
                                   : Vec3f(1.0f, 0.0f, 0.0f);
    const Vec3f t2 = glm::cross(stretched, t1);
    const float r = std::sqrt(u0), phi = 2.0f * kPi * u1;
    const float a = r * std::cos(phi), s = 0.5f * (1.0f + stretched.z);
    const float b = (1.0f - s) * std::sqrt(1.0f - a * a) + s * r * std::sin(phi);
    const Vec3f n = a * t1 + b * t2 + std::sqrt(std::max(0.0f, 1.0f - a * a - b * b)) * stretched;
    return glm::normalize(Vec3f(alpha * n.x, alpha * n.y, std::max(n.z, 1e-6f)));
}

float integrate(float roughness, float cosine, float ior) {
    const float alpha = std::max(roughness * roughness, 1e-4f), mu = std::max(cosine, 1e-3f);
    const Vec3f view(std::sqrt(1.0f - mu * mu), 0.0f, mu);
    const float f0 = f0_from_ior(ior), lambda = smith_lambda(mu, alpha);
    double total = 0.0, reflected = 0.0;
    for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide; ++i) {
            const Vec3f half = visible_normal(view, alpha, (i + 0.5f) / kSide, (j + 0.5f) / kSide);
            const float h = glm::dot(view, half);
            const Vec3f light = 2.0f * h * half - view;
            if (light.z <= 0.0f) continue;
            const float masking = (1.0f + lambda) / (1.0f + lambda + smith_lambda(light.z, alpha));
            total += masking;
            reflected += masking * (fresnel_dielectric(h, ior) - f0) / (1.0f - f0);
        }
    }
    return total > 0.0 ? static_cast<float>(reflected / total) : 0.0f;
}

/// Light that is reflected between microfacets meets Fresnel at each bounce (Kulla and Conty 2017):
/// what is left, relative to a lobe that loses nothing.
Vec3f multiscatter_darkening(const Vec3f& fresnel, float roughness, float cosine) {
    const GgxAlbedo& albedo = GgxAlbedo::shared();
    const float directional = albedo.directional(roughness, std::clamp(cosine, 0.0f, 1.0f));
    const float average = albedo.average(roughness);
    const float missing = (1.0f - directional) / directional;
    const Vec3f one(1.0f);
    const Vec3f bounced = fresnel * average / (one - fresnel * (1.0f - average));
    return (one + bounced * missing) / (1.0f + missing);
}

}  // namespace

float ior_from_f0(float f0) {
    const float root = std::sqrt(std::clamp(f0, 0.0f, 0.99f));
    return (1.0f + root) / (1.0f - root);
}

float dielectric_mean_albedo(float ior) {
    constexpr int kSteps = 16;
    const float f0 = f0_from_ior(ior);
    float sum = 0.0f, weights = 0.0f;
    for (int i = 0; i < kSteps; ++i) {
        const float cosine = (static_cast<float>(i) + 0.5f) / kSteps;
        sum += cosine * (fresnel_dielectric(cosine, ior) - f0) / (1.0f - f0);
        weights += cosine;
    }
    return sum / weights;
}

float dielectric_albedo(float roughness, float cosine, float ior) {
    static const UnitCubeTable kTable(
        [](float x, float y, float z) { return integrate(x, y, ior_of_axis(z)); });
    return kTable.look_up(roughness, cosine, ior_axis(ior));
}

Vec3f layer_albedo(const Vec3f& f0, float ior, float roughness, float cosine, bool multiscatter,
                   const ThinFilm& film) {
    const auto mixed = [&](float grazing) { return f0 * (1.0f - grazing) + Vec3f(grazing); };
    const Vec3f albedo = film.is_there() ? film_on_dielectric(film, cosine, ior, f0)
                                         : mixed(dielectric_albedo(roughness, cosine, ior));
    if (!multiscatter) return albedo;
    return albedo * multiscatter_darkening(mixed(dielectric_mean_albedo(ior)), roughness, cosine);
}

}  // namespace granita
