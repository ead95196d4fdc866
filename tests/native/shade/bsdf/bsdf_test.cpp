// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes: energy, reciprocity, and sampling against quadrature.
#include "shade/bsdf/bsdf.h"

#include <gtest/gtest.h>

#include "math/sampling.h"
#include "shade/bsdf/bsdf_albedo.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/microfacet.h"
#include "shade/lights/light_scene.h"

namespace granita {
namespace {

ShadingPoints one_point(float cos_view) {
    ShadingPoints points = points_facing_up({Vec3f(0)});
    points.view[0] = {std::sqrt(1 - cos_view * cos_view), 0, cos_view};
    return points;
}

/// Integral of the value over the hemisphere by mid-points in (cos, phi): no sampling involved.
template <class Value>
double hemisphere_integral(Value value, int steps = 600) {
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const float z = (static_cast<float>(i) + 0.5f) / static_cast<float>(steps);
            const float phi = 2 * kPi * (static_cast<float>(j) + 0.5f) / static_cast<float>(steps);
            const float s = std::sqrt(1 - z * z);
            sum += value(Vec3f(s * std::cos(phi), s * std::sin(phi), z));
        }
    return sum * 2 * kPi / (static_cast<double>(steps) * steps);
}

template <class Value>
double sphere_integral(Value value) {
    return hemisphere_integral([&](const Vec3f& wo) { return value(wo) + value(-wo); });
}

double albedo_of(const PointBsdf& bsdf) {
    return hemisphere_integral([&](const Vec3f& wo) {
        const BsdfValue value = bsdf.evaluate(wo);
        return value.diffuse.x + value.glossy.x;
    });
}

TEST(Diffuse, lambert_reflects_its_weight) {
    const ShadingPoints points = one_point(0.6f);
    EXPECT_NEAR(albedo_of(prepare(lambert(points, 0.5f), points)), 0.5, 1e-4);
}

TEST(Diffuse, white_oren_nayar_with_its_colour_loses_nothing) {
    for (const float cos_view : {0.2f, 0.6f, 1.0f})
        for (const float sigma : {0.3f, 1.0f}) {
            const ShadingPoints points = one_point(cos_view);
            Lobe lobe = lambert(points, 1.0f);
            lobe.roughness.assign(1, sigma);
            lobe.f0.assign(1, Vec3f(1.0f));
            EXPECT_NEAR(albedo_of(prepare(lobe, points)), 1.0, 0.01) << cos_view << " " << sigma;
        }
}

TEST(Diffuse, burley_at_normal_incidence) {
    // View and light along the normal: both Schlick terms vanish, Lambert is left.
    const ShadingPoints points = one_point(1.0f);
    Lobe lobe = lambert(points, 1.0f);
    lobe.burley = true;
    lobe.roughness.assign(1, 0.7f);
    EXPECT_NEAR(prepare(lobe, points).evaluate(Vec3f(0, 0, 1)).diffuse.x, kInversePi, 1e-6);
    // Light at 60 degrees: f = (1 - F/2) + RR F with F = (1/2)^5, RR = 2 r cos^2(30 degrees).
    const double f = 1.0 / 32.0, rr = 0.7 * 1.5;
    EXPECT_NEAR(prepare(lobe, points).evaluate(Vec3f(std::sqrt(0.75f), 0, 0.5f)).diffuse.x,
                0.5 * kInversePi * (1 - f / 2 + rr * f), 1e-6);
}

TEST(Glossy, multiscatter_ggx_passes_the_white_furnace) {
    for (const float cos_view : {0.3f, 0.7f, 1.0f})
        for (const float roughness : {0.4f, 0.7f, 1.0f}) {
            const ShadingPoints points = one_point(cos_view);
            Lobe lobe = glossy(points, roughness);
            const double single = albedo_of(prepare(lobe, points));
            EXPECT_NEAR(single, GgxAlbedo::shared().directional(roughness, cos_view), 0.006);
            lobe.multiscatter = true;
            EXPECT_NEAR(albedo_of(prepare(lobe, points)), 1.0, 0.01);
            if (roughness == 1.0f) {
                EXPECT_LT(single, 0.9);  // there was something to make up for
            }
        }
}

TEST(Glossy, coloured_multiscatter_darkens_less_than_linearly) {
    // Kulla and Conty: the energy beyond the first bounce carries the colour more than once.
    const ShadingPoints points = one_point(0.7f);
    Lobe lobe = glossy(points, 1.0f);
    lobe.weight[0] = Vec3f(0.5f);
    lobe.f0.assign(1, Vec3f(0.5f));
    const double single = albedo_of(prepare(lobe, points));
    lobe.multiscatter = true;
    const double multi = albedo_of(prepare(lobe, points));
    EXPECT_GT(multi, single);
    EXPECT_LT(multi, 0.5);
}

TEST(Glossy, what_is_blurred_beside_a_point_does_not_change_it) {
    // Both axes reach the longest that there is: the roughness asked for is not the facets'.
    ShadingPoints points = points_facing_up({Vec3f(0), Vec3f(1, 0, 0)});
    Lobe lobe = glossy(points, 1.0f);
    lobe.multiscatter = true;
    lobe.f0.assign(2, Vec3f(0.5f));
    lobe.tangent.assign(2, Vec3f(1, 0, 0));
    lobe.aspect.assign(2, 0.5f);
    SurfaceClosure closure;
    closure.lobes = {lobe};
    const Vec3f wo = glm::normalize(Vec3f(0.3f, -0.2f, 0.8f));
    const Vec3f alone = total(PointBsdf(closure, points, 1, GgxAlbedo::shared()).evaluate(wo));
    closure.lobes[0].roughen(0, 0.9f);
    EXPECT_EQ(total(PointBsdf(closure, points, 1, GgxAlbedo::shared()).evaluate(wo)), alone);
}

TEST(Glossy, is_reciprocal) {
    for (const Distribution distribution :
         {Distribution::Ggx, Distribution::Beckmann, Distribution::Gtr1})
        for (const bool separable : {false, true}) {
            const Vec3f a = glm::normalize(Vec3f(0.5f, 0.1f, 0.6f));
            const Vec3f b = glm::normalize(Vec3f(-0.3f, 0.4f, 0.9f));
            ShadingPoints points = one_point(1.0f);
            Lobe lobe = glossy(points, 0.6f);
            lobe.distribution = distribution;
            lobe.separable_masking = separable;
            points.view[0] = a;
            const float from_a = prepare(lobe, points).evaluate(b).glossy.x / b.z;
            points.view[0] = b;
            const float from_b = prepare(lobe, points).evaluate(a).glossy.x / a.z;
            EXPECT_GT(from_a, 0.01f);
            EXPECT_NEAR(from_a, from_b, 1e-5f * from_a + 1e-7f);
        }
}

// Burley 2012, appendix B: D integrates to 1 over the projected hemisphere, and falls off as the
// square of the sine, half as steeply as GGX.
TEST(Gtr1, its_density_is_normalised_and_long_tailed) {
    for (const float alpha : {0.1f, 0.5f, 0.999f, 1.0f}) {
        const double integral = hemisphere_integral(
            [&](const Vec3f& h) { return gtr1_density(alpha, 1.0f - h.z * h.z) * h.z; }, 2000);
        EXPECT_NEAR(integral, 1.0, 2e-3) << alpha;
    }
    EXPECT_NEAR(gtr1_density(0.01f, 0.2f) / gtr1_density(0.01f, 0.4f), 2.0f, 1e-3f);
    EXPECT_NEAR(ggx_density(0.01f, 0.2f) / ggx_density(0.01f, 0.4f), 4.0f, 4e-3f);
}

/// Longer along a direction that is no axis of the frame.
Lobe brushed(const ShadingPoints& points, Distribution distribution) {
    Lobe lobe = glossy(points, 0.6f);
    lobe.distribution = distribution;
    lobe.tangent.assign(1, glm::normalize(Vec3f(1.0f, 0.7f, 0.0f)));
    lobe.aspect.assign(1, 0.6f);
    return lobe;
}

Lobe of_kind(const ShadingPoints& points, LobeKind kind, float roughness, float more = 0.0f) {
    Lobe lobe = glossy(points, roughness);
    lobe.kind = kind;
    lobe.more = {{more}};
    return lobe;
}

class EveryLobe : public testing::TestWithParam<int> {
  protected:
    static Lobe make(const ShadingPoints& points, int which) {
        switch (which) {
            case 0:
                return lambert(points, 1.0f);
            case 5:
                return brushed(points, Distribution::Ggx);
            case 6:
                return brushed(points, Distribution::Beckmann);
            case 7:
                return brushed(points, Distribution::AshikhminShirley);
            case 8:
                return of_kind(points, LobeKind::Translucent, 0.0f);
            case 9:
                return of_kind(points, LobeKind::Sheen, 0.5f);
            case 10:
                return of_kind(points, LobeKind::GrazingSheen, 0.0f);
            case 11:
                return of_kind(points, LobeKind::Velvet, 0.7f);
            case 12:
                return of_kind(points, LobeKind::DiffuseToon, 0.5f, 0.2f);
            case 13:
                return of_kind(points, LobeKind::GlossyToon, 0.3f, 0.1f);
            case 14:
                return of_kind(points, LobeKind::Sheen, 1.0f);
            case 15:
                return of_kind(points, LobeKind::ThinGlass, 0.6f);
            default:
                Lobe lobe = glossy(points, which == 1 ? 0.8f : 0.5f);
                if (which == 3) lobe.distribution = Distribution::Beckmann;
                if (which == 4) lobe.distribution = Distribution::Gtr1;
                return lobe;
        }
    }
};

TEST_P(EveryLobe, its_density_integrates_to_the_share_of_samples_that_leave_upwards) {
    const ShadingPoints points = one_point(0.4f);
    const PointBsdf bsdf = prepare(make(points, GetParam()), points);
    const double integral = sphere_integral([&](const Vec3f& wo) { return bsdf.pdf(0, wo); });
    const SobolPoints sequence(5);
    const int count = 1 << 14;
    int valid = 0;
    for (int i = 0; i < count; ++i) {
        Vec3f wo;
        valid += bsdf.sample(0, sequence(static_cast<std::uint32_t>(i)), wo);
    }
    EXPECT_NEAR(integral, static_cast<double>(valid) / count, 0.005);
}

TEST_P(EveryLobe, sampling_estimates_what_quadrature_integrates) {
    // An integrand that is not symmetric, so that a rotated frame would show.
    const auto radiance = [](const Vec3f& wo) { return 1.0f + wo.x + 0.5f * wo.y * wo.y; };
    const ShadingPoints points = one_point(0.4f);
    const PointBsdf bsdf = prepare(make(points, GetParam()), points);
    const auto value = [&](const Vec3f& wo) {
        const BsdfValue f = bsdf.evaluate(wo);
        return total(f).x * radiance(wo);
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
    EXPECT_NEAR(sum / count, expected, 0.006 * expected);
}

INSTANTIATE_TEST_SUITE_P(Lobes, EveryLobe, testing::Range(0, 16));

// Burley 2012, 5.6: alpha / aspect along the tangent, alpha * aspect across; of a view along the
// normal the density of facets alone tells what is reflected.
TEST(Stretched, highlights_are_longer_along_the_tangent) {
    const ShadingPoints points = one_point(1.0f);
    const Lobe lobe = brushed(points, Distribution::Ggx);
    const PointBsdf bsdf = prepare(lobe, points);
    const Vec3f along = lobe.tangent[0], across(-along.y, along.x, 0.0f), up(0.0f, 0.0f, 1.0f);
    const double wide = 0.36 / 0.6, narrow = 0.36 * 0.6;
    const auto half_height = [&](const Vec3f& way, double alpha) {
        // Where D has fallen to a quarter: tan = alpha, and D = 1 / (pi ax ay (2 cos^2)^2).
        const auto c = static_cast<float>(1.0 / std::sqrt(1.0 + alpha * alpha));
        const Vec3f half = c * up + std::sqrt(1.0f - c * c) * way;
        return bsdf.evaluate(2.0f * c * half - up).glossy.x * std::pow(c, 4.0f);
    };
    EXPECT_NEAR(bsdf.evaluate(up).glossy.x, 0.25 / (kPi * wide * narrow), 1e-4);
    // Masking takes its part of what is lit aslant; half vectors are as likely on both.
    const auto unmasked = [&](double alpha) {
        const double angle = 2.0 * std::atan(alpha), t = alpha * std::tan(angle);
        return 1.0 / (1.0 + 0.5 * (std::sqrt(1.0 + t * t) - 1.0));
    };
    const double quarter = 0.25 * 0.25 / (kPi * wide * narrow);
    EXPECT_NEAR(half_height(along, wide), quarter * unmasked(wide), 1e-4);
    EXPECT_NEAR(half_height(across, narrow), quarter * unmasked(narrow), 1e-4);
}

TEST(Stretched, is_reciprocal) {
    const Vec3f a = glm::normalize(Vec3f(0.5f, 0.1f, 0.6f));
    const Vec3f b = glm::normalize(Vec3f(-0.3f, 0.4f, 0.9f));
    for (const Distribution distribution :
         {Distribution::Ggx, Distribution::Beckmann, Distribution::AshikhminShirley}) {
        ShadingPoints points = one_point(1.0f);
        const Lobe lobe = brushed(points, distribution);
        points.view[0] = a;
        const float from_a = prepare(lobe, points).evaluate(b).glossy.x / b.z;
        points.view[0] = b;
        const float from_b = prepare(lobe, points).evaluate(a).glossy.x / a.z;
        EXPECT_GT(from_a, 0.01f);
        EXPECT_NEAR(from_a, from_b, 1e-4f * from_a);
    }
}

TEST(Translucent, is_a_lambert_lobe_of_the_far_side) {
    const ShadingPoints points = one_point(0.7f);
    const PointBsdf bsdf = prepare(of_kind(points, LobeKind::Translucent, 0.0f), points);
    EXPECT_NEAR(bsdf.evaluate(Vec3f(0.6f, 0.0f, -0.8f)).diffuse.x, 0.8f * kInversePi, 1e-6f);
    EXPECT_EQ(total(bsdf.evaluate(Vec3f(0.6f, 0.0f, 0.8f))), Vec3f(0.0f));
    EXPECT_TRUE(bsdf.transmits());
    EXPECT_TRUE(bsdf.can_see(Vec3f(0.0f, 0.0f, -2.0f), 0.5f));
    EXPECT_FALSE(bsdf.can_see(Vec3f(0.0f, 0.0f, 2.0f), 0.5f));
}

// Light that comes through is what a mirror would send to where it goes on to.
TEST(ThinGlass, lets_through_what_its_facets_mirror) {
    for (const float cos_view : {0.3f, 0.8f}) {
        const ShadingPoints points = one_point(cos_view);
        const PointBsdf sheet = prepare(of_kind(points, LobeKind::ThinGlass, 0.5f), points);
        const PointBsdf mirror = prepare(glossy(points, 0.5f), points);
        const float straight = total(sheet.evaluate(-points.view[0])).x;
        const Vec3f view = points.view[0], back(-view.x, -view.y, view.z);
        const float expected = mirror.evaluate(back).glossy.x;
        for (const Vec3f& way : {Vec3f(0.6f, 0.0f, -0.8f), Vec3f(0.0f, 0.8f, -0.6f)}) {
            const float mirrored = mirror.evaluate(Vec3f(way.x, way.y, -way.z)).glossy.x;
            EXPECT_NEAR(total(sheet.evaluate(way)).x / straight, mirrored / expected,
                        1e-3f * mirrored / expected);
        }
        // Nothing is lost.
        EXPECT_NEAR(sphere_integral([&](const Vec3f& wo) { return total(sheet.evaluate(wo)).x; }),
                    1.0, 0.02);
    }
}

// What it reflects of a white furnace is the albedo by which Principled dims what is below.
TEST(Sheen, reflects_what_its_fit_says) {
    for (const float roughness : {0.3f, 0.6f, 1.0f})
        for (const float cos_view : {0.15f, 0.5f, 0.95f}) {
            const ShadingPoints points = one_point(cos_view);
            const PointBsdf bsdf = prepare(of_kind(points, LobeKind::Sheen, roughness), points);
            EXPECT_NEAR(albedo_of(bsdf), bsdf.albedo().diffuse.x, 0.004);
        }
    // Cloth shines where it is grazed.
    const auto albedo = [](float cos_view) {
        const ShadingPoints points = one_point(cos_view);
        return prepare(of_kind(points, LobeKind::Sheen, 1.0f), points).albedo().diffuse.x;
    };
    EXPECT_GT(albedo(0.1f), 1.5f * albedo(0.9f));
    // By smooth normals that turn away from the eye it is seen as where it is grazed, as in Cycles.
    EXPECT_EQ(albedo(-0.4f), albedo(0.0f));
}

TEST(Toon, is_even_within_its_angle_and_fades_beyond) {
    const ShadingPoints points = one_point(0.8f);
    const PointBsdf bsdf = prepare(of_kind(points, LobeKind::DiffuseToon, 0.5f, 0.25f), points);
    // Sampled up to 67.5 degrees: that cone's solid angle is the scale.
    const double full = 0.5 / (kPi * (1.0 - std::cos(67.5 * kPi / 180.0)));
    const auto value_at = [&](double degrees) {
        const auto angle = static_cast<float>(degrees * kPi / 180.0);
        return bsdf.evaluate(Vec3f(std::sin(angle), 0.0f, std::cos(angle))).diffuse.x;
    };
    EXPECT_NEAR(value_at(10.0), full, 1e-5);
    EXPECT_NEAR(value_at(44.0), full, 1e-5);
    EXPECT_NEAR(value_at(56.25), 0.5 * full, 1e-4);
    EXPECT_EQ(value_at(70.0), 0.0f);
}

// Gold at 600 nm: n = .25, k = 3.1 reflect .91 straight on; at grazing angles all.
TEST(Fresnel, conductors_by_their_complex_index) {
    const Vec3f n(0.25f), k(3.1f);
    EXPECT_NEAR(fresnel_conductor(1.0f, n, k).x, (0.5625f + 9.61f) / (1.5625f + 9.61f), 1e-6f);
    EXPECT_NEAR(fresnel_conductor(0.0f, n, k).x, 1.0f, 1e-6f);
    // A dielectric is one without absorption, where the formula is nearly exact: n far above 1.
    EXPECT_NEAR(fresnel_conductor(0.7f, Vec3f(8.0f), Vec3f(0.0f)).x, fresnel_dielectric(0.7f, 8.0f),
                2e-3f);
    const double mean = hemisphere_integral(
        [&](const Vec3f& wo) { return fresnel_conductor(wo.z, n, k).x * wo.z * kInversePi; }, 300);
    EXPECT_NEAR(conductor_mean(n, k).x, mean, 2e-3);
}

TEST(Fresnel, dielectric_at_normal_grazing_and_brewsters_angle) {
    EXPECT_NEAR(fresnel_dielectric(1.0f, 1.5f), 0.04f, 1e-6f);
    EXPECT_NEAR(fresnel_dielectric(0.0f, 1.5f), 1.0f, 1e-6f);
    // At Brewster's angle only s-polarised light returns: ((n^2 - 1) / (n^2 + 1))^2 / 2.
    const float brewster = 1.0f / std::sqrt(1.0f + 1.5f * 1.5f);
    EXPECT_NEAR(fresnel_dielectric(brewster, 1.5f), 0.5f * 0.147929f, 1e-5f);
    EXPECT_EQ(fresnel_dielectric(0.1f, 1.0f / 1.5f), 1.0f);  // total internal reflection
}

TEST(Fresnel, sharp_lobes_mirror_with_their_reflectance) {
    const ShadingPoints points = one_point(0.5f);
    Lobe lobe = glossy(points, 0.0f);
    lobe.fresnel = FresnelKind::Dielectric;
    lobe.ior.assign(1, 1.5f);
    lobe.f0.assign(1, Vec3f(0.04f));
    lobe.f90.assign(1, Vec3f(1.0f));
    const PointBsdf bsdf = prepare(lobe, points);
    ASSERT_TRUE(bsdf.is_sharp(0));
    Vec3f wo, reflectance;
    ASSERT_TRUE(bsdf.deflect(0, wo, reflectance));
    EXPECT_NEAR(wo.x, -points.view[0].x, 1e-6f);
    EXPECT_NEAR(wo.z, 0.5f, 1e-6f);
    // With the natural f0 and f90 the remapping is the identity; 60 degrees on glass: 0.0892.
    EXPECT_NEAR(reflectance.x, 0.089187f, 1e-5f);
}

// Kutz, Hasan and Edmondson 2021: f0 straight on, white at grazing angles, and at cos = 1/7 the
// tint times Schlick's f0 + (1 - f0) (6/7)^5.
TEST(Fresnel, f82_has_its_tint_at_82_degrees) {
    const Vec3f f0(0.9f, 0.5f, 0.1f), tint(0.2f, 0.7f, 1.0f);
    const auto reflectance = [&](float cosine) {
        const ShadingPoints points = one_point(cosine);
        Lobe lobe = glossy(points, 0.0f);
        lobe.fresnel = FresnelKind::F82Tint;
        lobe.f0.assign(1, f0);
        lobe.f90.assign(1, tint);
        Vec3f wo, reflected;
        EXPECT_TRUE(prepare(lobe, points).deflect(0, wo, reflected));
        return reflected;
    };
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(reflectance(1.0f)[c], f0[c], 1e-6f);
        EXPECT_NEAR(reflectance(1e-4f)[c], 1.0f, 2e-3f);
        EXPECT_NEAR(reflectance(1.0f / 7.0f)[c], tint[c] * (f0[c] + (1.0f - f0[c]) * 0.462664f),
                    1e-5f);
    }
}

TEST(Fresnel, f82s_mean_is_that_of_quadrature) {
    const Vec3f f0(0.9f, 0.5f, 0.3f), dip = f82_dip(f0, Vec3f(0.4f, 0.7f, 1.0f));
    for (int c = 0; c < 3; ++c) {
        const double mean = hemisphere_integral(
            [&](const Vec3f& wo) { return fresnel_f82(f0, dip, wo.z)[c] * wo.z * kInversePi; },
            300);
        EXPECT_NEAR(f82_mean(f0, dip)[c], mean, 1e-4);
    }
}

TEST(PointBsdf, what_lies_below_the_horizon_is_not_seen_and_reflects_nothing) {
    const ShadingPoints points = points_facing_up({{0, 0, 0}});
    const PointBsdf diffuse = prepare(lambert(points, 1.0f), points);
    const PointBsdf shiny = prepare(glossy(points, 0.5f), points);
    const SobolPoints sequence(3);
    int hidden = 0;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const Vec3f center = 3.0f * (2.0f * Vec3f(sequence(i), sequence.third(i)) - Vec3f(1.0f));
        const float radius = 0.5f + sequence(i).x;
        EXPECT_EQ(diffuse.can_see(center, radius), shiny.can_see(center, radius));
        if (diffuse.can_see(center, radius)) {
            EXPECT_GT(center.z + radius, -1e-3f);
            continue;
        }
        ++hidden;
        const Vec3f highest = glm::normalize(center + Vec3f(0, 0, radius));
        EXPECT_EQ(diffuse.evaluate(highest).diffuse, Vec3f(0.0f));
        EXPECT_EQ(shiny.evaluate(highest).glossy, Vec3f(0.0f));
    }
    EXPECT_GT(hidden, 200);
}

}  // namespace
}  // namespace granita
