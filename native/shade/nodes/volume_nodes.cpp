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

void add_phase(NodeBuilder& b, SurfaceBuilder& volume, const VectorSource& scattering) {
    PhaseSource phase;
    const std::string kind = b.text("phase", "HENYEY_GREENSTEIN");
    if (kind == "RAYLEIGH") phase.kind = PhaseKind::Rayleigh;
    if (kind == "FOURNIER_FORAND" || kind == "DRAINE" || kind == "MIE")
        b.warn("its phase function is rendered as Henyey-Greenstein's");
    phase.scattering = b.map<Vec3f>(positive, scattering);
    phase.anisotropy = b.number("Anisotropy");
    volume.add_phase(phase);
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
    volume.add_emission(b, coefficients("Emission Coefficients"));
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
    volume.add_emission(b, scaled(b, b.color("Emission Color", Vec3f(1.0f)), strength));
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
    volume.add_emission(b, scaled(b, tinted, shed));
}

}  // namespace granita
