// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes of hairs: energy, and sampling against quadrature.
#include <gtest/gtest.h>

#include "math/sampling.h"
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/hair_color.h"
#include "shade/lights/light_scene.h"

namespace granita {
namespace {

constexpr float kTilt = 0.05f;

/// A hair along x, seen aslant, its surface turned by `turn` about it from the view.
ShadingPoints hair(float slant, float turn) {
    ShadingPoints points = points_facing_up({Vec3f(0)});
    points.view[0] = {std::sin(slant), 0.0f, std::cos(slant)};
    points.normal[0] = {0.0f, std::sin(turn), std::cos(turn)};
    points.round = true;
    return points;
}

Lobe lobe_of(const ShadingPoints& points, LobeKind kind, float roughness, float radial,
             float cells = 0.0f, float aside = 0.0f) {
    Lobe lobe = glossy(points, roughness);
    lobe.kind = kind;
    lobe.tangent.assign(1, Vec3f(1.0f, 0.0f, 0.0f));
    lobe.more = {{radial}, {kTilt}, {1.0f}, {cells}, {aside}, {0.0f}};
    lobe.ior.assign(1, 1.55f);
    lobe.f0.assign(1, Vec3f(0.0f));
    return lobe;
}

/// Integral over the sphere by mid-points in inclination and azimuth about the hair.
template <class Value>
double sphere_integral(Value value, int steps = 600) {
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < 2 * steps; ++j) {
            const double theta = kPi * ((i + 0.5) / steps - 0.5), phi = kPi * (j + 0.5) / steps;
            const double c = std::cos(theta);
            sum += c * value(Vec3f(std::sin(theta), c * std::cos(phi), c * std::sin(phi)));
        }
    return sum * kPi * kPi / (static_cast<double>(steps) * steps);
}

struct Case {
    LobeKind kind;
    float roughness, radial, slant, turn;
    float cells = 0.0f, aside = 0.0f;
};

Lobe lobe_of(const ShadingPoints& points, const Case& hair) {
    return lobe_of(points, hair.kind, hair.roughness, hair.radial, hair.cells, hair.aside);
}

class EveryHair : public testing::TestWithParam<Case> {};

TEST_P(EveryHair, its_density_integrates_to_the_share_of_samples_that_leave) {
    const ShadingPoints points = hair(GetParam().slant, GetParam().turn);
    const PointBsdf bsdf = prepare(lobe_of(points, GetParam()), points);
    const double integral = sphere_integral([&](const Vec3f& wo) { return bsdf.pdf(0, wo); });
    const SobolPoints sequence(5);
    const int count = 1 << 14;
    int valid = 0;
    for (int i = 0; i < count; ++i) {
        Vec3f wo;
        valid += bsdf.sample(0, sequence(static_cast<std::uint32_t>(i)), wo);
    }
    EXPECT_GT(valid, count / 4);
    EXPECT_NEAR(integral, static_cast<double>(valid) / count, 0.01);
}

TEST_P(EveryHair, sampling_estimates_what_quadrature_integrates) {
    const ShadingPoints points = hair(GetParam().slant, GetParam().turn);
    Lobe lobe = lobe_of(points, GetParam());
    lobe.f0.assign(1, Vec3f(0.3f));
    const PointBsdf bsdf = prepare(lobe, points);
    // An integrand that is not symmetric, so that a rotated frame would show.
    const auto value = [&](const Vec3f& wo) {
        return total(bsdf.evaluate(wo, true)).x * (1.0f + wo.x + 0.5f * wo.y + 0.3f * wo.z * wo.z);
    };
    const double expected = sphere_integral(value);
    const SobolPoints sequence(9);
    const int count = 1 << 14;
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        Vec3f wo;
        if (bsdf.sample(0, sequence(static_cast<std::uint32_t>(i)), wo))
            sum += value(wo) / bsdf.pdf(0, wo);
    }
    EXPECT_NEAR(sum / count, expected, 0.01 * expected);
}

INSTANTIATE_TEST_SUITE_P(
    Hairs, EveryHair,
    testing::Values(Case{LobeKind::HairReflection, 0.3f, 0.6f, 0.4f, 0.0f},
                    Case{LobeKind::HairReflection, 0.1f, 1.0f, -0.7f, 0.6f},
                    Case{LobeKind::HairTransmission, 0.3f, 0.6f, 0.4f, 0.0f},
                    Case{LobeKind::PrincipledHair, 0.3f, 0.3f, 0.4f, 0.0f},
                    Case{LobeKind::PrincipledHair, 0.6f, 0.4f, -0.8f, 0.8f},
                    Case{LobeKind::PrincipledHair, 0.25f, 0.8f, 0.2f, -1.2f},
                    // Of 27 places and 14, which are no multiples of four.
                    Case{LobeKind::PrincipledHair, 0.3f, 0.3f, 0.4f, 0.4f, 1.0f},
                    Case{LobeKind::PrincipledHair, 0.3f, 0.3f, 0.4f, 0.4f, 2.0f, 1.0f}));

// Chiang et al. 2016: whatever meets a hair that absorbs nothing leaves it.
TEST(PrincipledHair, a_clear_hair_in_a_white_furnace_vanishes) {
    for (const float roughness : {0.3f, 0.7f})
        for (const float turn : {0.0f, 0.7f, -1.3f}) {
            const ShadingPoints points = hair(0.5f, turn);
            const PointBsdf bsdf =
                prepare(lobe_of(points, LobeKind::PrincipledHair, roughness, 0.4f), points);
            const double albedo =
                sphere_integral([&](const Vec3f& wo) { return bsdf.evaluate(wo).glossy.x; });
            EXPECT_NEAR(albedo, 1.0, 0.01) << roughness << " " << turn;
            EXPECT_TRUE(bsdf.can_see(Vec3f(0, 0, -5), 0.1f));
        }
}

// A ribbon that is as narrow as a pixel is one cell wide, of which each side is a point's.
TEST(PrincipledHair, what_a_point_stands_for_is_the_mean_over_its_part_of_the_width) {
    const auto at_place = [](float h) {
        const ShadingPoints points = hair(0.3f, std::asin(h));
        Lobe lobe = lobe_of(points, LobeKind::PrincipledHair, 0.3f, 0.3f);
        lobe.f0.assign(1, Vec3f(0.4f));
        return prepare(lobe, points);
    };
    for (const float cells : {1.0f, 2.0f}) {
        const ShadingPoints points = hair(0.3f, 0.4f);
        Lobe lobe = lobe_of(points, LobeKind::PrincipledHair, 0.3f, 0.3f);
        lobe.f0.assign(1, Vec3f(0.4f));
        lobe.more[3] = {cells};
        lobe.more[4] = {1.0f};  // the last of its points
        const PointBsdf whole = prepare(lobe, points);
        for (const float phi : {-2.0f, -0.7f, 0.1f, 1.2f, 2.9f}) {
            const Vec3f wo = glm::normalize(Vec3f(-0.2f, std::sin(phi), std::cos(phi)));
            double sum = 0.0;
            const int steps = 400;
            for (int i = 0; i < steps; ++i) {
                const float from = 1.0f - 1.0f / cells;
                const float h = from + (1.0f - from) * (static_cast<float>(i) + 0.5f) / steps;
                sum += at_place(h).evaluate(wo).glossy.x;
            }
            const double expected = sum / steps;
            // Places 2 scales of the density apart: as much as an aliased sum is off.
            EXPECT_NEAR(whole.evaluate(wo).glossy.x, expected, 0.03 * expected + 0.002)
                << cells << " " << phi;
        }
    }
}

// A smooth tube mirrors light about its own surface, and lets light through on the other side.
TEST(PrincipledHair, it_mirrors_about_the_surface_that_is_seen) {
    const float turn = 0.5f;
    const ShadingPoints points = hair(0.0f, turn);
    Lobe lobe = lobe_of(points, LobeKind::PrincipledHair, 0.15f, 0.1f);
    lobe.more[1] = {0.0f};
    lobe.f0.assign(1, Vec3f(100.0f));  // nothing gets through
    const PointBsdf bsdf = prepare(lobe, points);
    float most = 0.0f, at = 0.0f;
    for (int i = -314; i < 314; ++i) {
        const float phi = 0.01f * static_cast<float>(i);
        const float value = bsdf.evaluate(Vec3f(0.0f, std::sin(phi), std::cos(phi))).glossy.x;
        if (value > most) {
            most = value;
            at = phi;
        }
    }
    EXPECT_NEAR(at, 2.0f * turn, 0.02f);
}

// The colour that the artist asks for is what many such hairs have: its inverse.
TEST(PrincipledHair, absorption_of_a_colour_gives_that_colour) {
    const Vec3f color(0.6f, 0.3f, 0.1f);
    const Vec3f sigma = hair_absorption(color, 0.3f);
    const Vec3f back = glm::exp(-glm::sqrt(sigma) * hair_absorption_scale(0.3f));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(back[c], color[c], 1e-5f);
    EXPECT_EQ(melanin_absorption(0.0f, 0.0f), Vec3f(0.0f));
}

}  // namespace
}  // namespace granita
