// SPDX-License-Identifier: GPL-3.0-or-later
// Volume Absorption, Volume Scatter, Volume Coefficients and Principled Volume: coefficients a
// metre, as Cycles makes them of colours and densities.
#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/nodes/nodes.h"

namespace granita {
namespace {

Vec3f positive(const Vec3f& v) {
    return glm::max(v, Vec3f(0.0f));
}

FloatSource density(NodeBuilder& b, const FloatSource& weight) {
    const auto made = [](float x, float w) { return std::max(x, 0.0f) * w; };
    return b.map<float>(made, b.number("Density", 1.0f), weight);
}

/// Jendersie and d'Eon 2023, "An Approximate Mie Scattering Function for Fog and Cloud Rendering":
/// Henyey and Greenstein's and a part `mixture` of Draine's, of drops of a diameter in micrometres.
struct MieFit {
    float henyey_greenstein, draine, alpha, mixture;

    explicit MieFit(float diameter) {
        const float d = std::clamp(diameter, 1e-3f, 50.0f), l = std::log(d);
        alpha = 250.0f;
        if (d <= 0.1f) {
            henyey_greenstein = 13.8f * d * d;
            draine = 1.1456f * d * std::sin(9.29044f * d);
            mixture = 0.252977f - 312.983f * std::pow(d, 4.3f);
        } else if (d < 1.5f) {
            henyey_greenstein = 0.862f - 0.143f * l * l;
            const float bend = (l - 0.238604f) * (l + 1.00667f) / (0.507522f - 0.15677f * l);
            draine = 0.379685f * std::cos(1.19692f * std::cos(bend) + 1.37932f * l + 0.0625835f) +
                     0.344213f;
            mixture = 0.146209f * std::cos(3.38707f * l + 2.11193f) + 0.316072f + 0.0778917f * l;
        } else if (d < 5.0f) {
            const float ll = std::log(l);
            henyey_greenstein = 0.0604931f * ll + 0.940256f;
            draine = 0.500411f - 0.081287f / (-2.0f * l + std::tan(l) + 1.27551f);
            alpha = 7.30354f * l + 6.31675f;
            mixture = 0.026914f * (l - std::cos(5.68947f * (ll - 0.0292149f))) + 0.376475f;
        } else {
            henyey_greenstein = std::exp(-0.0990567f / (d - 1.67154f));
            draine = std::exp(-2.20679f / (d + 3.91029f) - 0.428934f);
            alpha = std::exp(3.62489f - 8.29288f / (d + 5.52825f));
            mixture = std::exp(-0.599085f / (d - 0.641583f) - 0.665888f);
        }
    }
};

void add_mie(NodeBuilder& b, SurfaceBuilder& volume, const VectorSource& scattering) {
    const FloatSource diameter = b.number("Diameter", 20.0f);
    const auto fitted = [&](float MieFit::*part) {
        return b.map<float>([part](float d) { return MieFit(d).*part; }, diameter);
    };
    const FloatSource mixture = fitted(&MieFit::mixture);
    const FloatSource rest = b.map<float>([](float w) { return 1.0f - w; }, mixture);
    volume.add_phase({PhaseKind::HenyeyGreenstein,
                      scaled(b, scattering, rest),
                      fitted(&MieFit::henyey_greenstein),
                      {-1, 0.0f}});
    volume.add_phase({PhaseKind::Draine, scaled(b, scattering, mixture), fitted(&MieFit::draine),
                      fitted(&MieFit::alpha)});
}

void add_phase(NodeBuilder& b, SurfaceBuilder& volume, const VectorSource& signed_scattering) {
    const VectorSource scattering = b.map<Vec3f>(positive, signed_scattering);
    const std::string kind = b.text("phase", "HENYEY_GREENSTEIN");
    const FloatSource none{-1, 0.0f};
    if (kind == "MIE")
        add_mie(b, volume, scattering);
    else if (kind == "RAYLEIGH")
        volume.add_phase({PhaseKind::Rayleigh, scattering, none, none});
    else if (kind == "DRAINE")
        volume.add_phase(
            {PhaseKind::Draine, scattering, b.number("Anisotropy"), b.number("Alpha", 0.5f)});
    else if (kind == "FOURNIER_FORAND")
        volume.add_phase({PhaseKind::FournierForand, scattering, b.number("IOR", 1.33f),
                          b.number("Backscatter", 0.1f)});
    else
        volume.add_phase({PhaseKind::HenyeyGreenstein, scattering, b.number("Anisotropy"), none});
}

}  // namespace

void build_volume_absorption(NodeBuilder& b, SurfaceBuilder& volume, const FloatSource& weight) {
    const auto absorbed = [](const Vec3f& color) { return positive(Vec3f(1.0f) - color); };
    const VectorSource color = b.map<Vec3f>(absorbed, b.color("Color", Vec3f(0.8f)));
    volume.add_absorption(b, scaled(b, color, density(b, weight)));
}

void build_volume_scatter(NodeBuilder& b, SurfaceBuilder& volume, const FloatSource& weight) {
    add_phase(b, volume, scaled(b, b.color("Color", Vec3f(0.8f)), density(b, weight)));
}

void build_volume_coefficients(NodeBuilder& b, SurfaceBuilder& volume, const FloatSource& weight) {
    const auto coefficients = [&](const char* name) {
        return scaled(b, b.map<Vec3f>(positive, b.vector(name)), weight);
    };
    volume.add_absorption(b, coefficients("Absorption Coefficients"));
    add_phase(b, volume, coefficients("Scatter Coefficients"));
    volume.add_emission_in(SurfaceBuilder::Socket::Volume, b,
                           coefficients("Emission Coefficients"));
}

void build_principled_volume(NodeBuilder& b, SurfaceBuilder& volume, const FloatSource& weight) {
    const FloatSource dense = density(b, weight);
    const VectorSource color = b.color("Color", Vec3f(0.5f));
    add_phase(b, volume, scaled(b, color, dense));
    const auto absorbed = [](const Vec3f& scattered, const Vec3f& tint) {
        return positive(Vec3f(1.0f) - scattered) *
               positive(Vec3f(1.0f) - glm::sqrt(positive(tint)));
    };
    volume.add_absorption(
        b, scaled(b, b.map<Vec3f>(absorbed, color, b.color("Absorption Color")), dense));
    const FloatSource strength = product(b, b.number("Emission Strength"), weight);
    volume.add_emission_in(SurfaceBuilder::Socket::Volume, b,
                           scaled(b, b.color("Emission Color", Vec3f(1.0f)), strength));
    const FloatSource blackbody = b.number("Blackbody Intensity");
    if (blackbody.is(0.0f)) return;
    // Stefan and Boltzmann's law, in millions.
    const auto power = [](float share, float kelvin, float w) {
        constexpr float kSigma = 5.670373e-8f * 1e-6f * kInversePi;
        const float t = std::max(kelvin, 0.0f), t4 = t * t * t * t;
        return share > 0.0f ? w * kSigma * (1.0f - share + share * t4) : 0.0f;
    };
    const FloatSource shed =
        b.map<float>(power, blackbody, b.number("Temperature", 1000.0f), weight);
    const VectorSource tinted =
        product(b, b.color("Blackbody Tint", Vec3f(1.0f)), spectrum_color(b, "Temperature"));
    volume.add_emission_in(SurfaceBuilder::Socket::Volume, b, scaled(b, tinted, shed));
}

}  // namespace granita
