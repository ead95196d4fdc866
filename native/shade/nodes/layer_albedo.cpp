// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/layer_albedo.h"

#include <algorithm>
#include <cmath>

#include "shade/bsdf/bsdf_albedo.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/fresnel_albedo.h"

namespace granita {

namespace {

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

/// The cosine-weighted mean of the smooth surface's over all directions.
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

}  // namespace

Vec3f layer_albedo(const Vec3f& f0, float ior, float roughness, float cosine, bool multiscatter,
                   const ThinFilm& film) {
    const auto mixed = [&](float grazing) { return f0 * (1.0f - grazing) + Vec3f(grazing); };
    const Vec3f albedo = film.is_there() ? film_on_dielectric(film, cosine, ior, f0)
                                         : mixed(dielectric_share(roughness, cosine, ior));
    if (!multiscatter) return albedo;
    return albedo * multiscatter_darkening(mixed(dielectric_mean_albedo(ior)), roughness, cosine);
}

}  // namespace granita
