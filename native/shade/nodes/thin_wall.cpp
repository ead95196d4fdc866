// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/thin_wall.h"

#include <algorithm>
#include <cmath>

#include "shade/bsdf/fresnel.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

namespace {

const Vec3f kOne(1.0f);

/// Below it what goes through is not blurred (Cycles).
constexpr float kSharpAlpha2 = 5e-7f;

/// Shares of light that leave a sheet, with all that goes to and fro in it: the sums of two
/// geometric series.
struct Sheet {
    Vec3f reflected{1.0f}, sent{0.0f};
};

/// `once`: reflectance of either face; `color`: what is left straight through.
Sheet sheet_of(const Vec3f& once, const Vec3f& color, float cosine, float ior) {
    Sheet sheet;
    const float sine2 = (1.0f - cosine * cosine) / (ior * ior);
    if (sine2 >= 1.0f) return sheet;
    const float way = 1.0f / std::sqrt(1.0f - sine2);  // Beer's law
    for (int c = 0; c < 3; ++c) {
        const float left = std::pow(std::max(color[c], 0.0f), way), in = 1.0f - once[c];
        const float again = once[c] * left;
        sheet.sent[c] = safe_divide(left * in * in, 1.0f - again * again);
        sheet.reflected[c] = once[c] + sheet.sent[c] * again;
    }
    return sheet;
}

/// The sheet's, along the view.
Vec3f face_reflectance(const Vec3f& f0, float cosine, float ior, const ThinFilm& film) {
    if (film.is_there()) return film_on_dielectric(film, cosine, ior, f0);
    const float straight = f0_from_ior(ior);
    const float share = safe_divide(fresnel_dielectric(cosine, ior) - straight, 1.0f - straight);
    return f0 + (kOne - f0) * saturate(share);
}

/// Two refractions blur as one reflection of another roughness (Kulla and Conty 2017,
/// "Revisiting Physically Based Shading at Imageworks"): `times` alpha, in 5.2 its root.
float blur(float roughness, float ior, bool by_root) {
    const float beside = ior - 0.5f;
    const float times = std::max(3.4f * (ior - 1.0f) * beside * beside / (ior * ior * ior), 0.0f);
    return std::sqrt(saturate(roughness * roughness * (by_root ? std::sqrt(times) : times)));
}

}  // namespace

void add_thin_glass(NodeBuilder& b, SurfaceBuilder& surface, const GlassSource& glass) {
    const auto share = [&](Vec3f Sheet::*which) {
        return b.map<Vec3f>(
            [which, spectrum = glass.film.spectrum](const Vec3f& f0, const Vec3f& color,
                                                    const Vec3f& n, const Vec3f& view, float eta,
                                                    float thickness, float film_ior) {
                const float cosine = std::clamp(glm::dot(n, view), 0.0f, 1.0f);
                const ThinFilm film{thickness, film_ior, spectrum};
                return sheet_of(face_reflectance(f0, cosine, eta, film), color, cosine, eta).*which;
            },
            glass.f0, glass.sent, glass.normal, b.view(), glass.ior, glass.film.thickness,
            glass.film.ior);
    };
    LobeSource reflected;
    reflected.kind = LobeKind::Glossy;
    reflected.multiscatter = reflected.has_color = true;  // whatever the node's distribution
    reflected.f0 = glass.reflected;
    reflected.normal = glass.normal;
    reflected.roughness = glass.roughness;
    reflected.weight = product(b, glass.weight, share(&Sheet::reflected));
    surface.add_lobe(reflected);

    const VectorSource through = product(b, glass.weight, share(&Sheet::sent));
    const FloatSource blurred = b.map<float>(
        [by_root = !b.since(5, 3)](float r, float eta) { return blur(r, eta, by_root); },
        glass.roughness, glass.ior);
    const FloatSource is_sharp =
        b.map<float>([](float r) { return r * r * r * r <= kSharpAlpha2 ? 1.0f : 0.0f; }, blurred);
    // What does not blur is transparency, as in Cycles for all but camera rays: Reyes has that for
    // nothing, and what is behind stays as sharp, and as blurred by motion, as without the pane.
    surface.add_transparency(b, scaled(b, through, is_sharp));
    if (is_sharp.is(1.0f)) return;
    LobeSource sent;
    sent.kind = LobeKind::ThinGlass;
    sent.normal = glass.normal;
    sent.roughness = blurred;
    sent.weight =
        scaled(b, through, b.map<float>([](float sharp) { return 1.0f - sharp; }, is_sharp));
    surface.add_lobe(sent);
}

void add_thin_subsurface(NodeBuilder& b, SurfaceBuilder& surface, LobeSource diffuse,
                         const FloatSource& anisotropy) {
    const VectorSource all = diffuse.weight;
    LobeSource through = diffuse;
    through.kind = LobeKind::Translucent;
    through.has_color = false;
    through.f0 = {};
    through.roughness = FloatSource{-1, 0.0f};
    through.weight =
        scaled(b, all, b.map<float>([](float g) { return saturate(0.5f + 0.5f * g); }, anisotropy));
    diffuse.weight =
        scaled(b, all, b.map<float>([](float g) { return saturate(0.5f - 0.5f * g); }, anisotropy));
    surface.add_lobe(diffuse);
    surface.add_lobe(through);
}

}  // namespace granita
