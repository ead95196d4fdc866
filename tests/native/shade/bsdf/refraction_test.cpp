// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes that transmit: Snell's law, energy, reciprocity, and sampling against quadrature.
#include <gtest/gtest.h>

#include "math/sampling.h"
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/bsdf_albedo.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/glass_albedo.h"
#include "shade/lights/light_scene.h"

namespace granita {
namespace {

constexpr float kGlass = 1.5f;

ShadingPoints seen_from(const Vec3f& view) {
    ShadingPoints points = points_facing_up({Vec3f(0)});
    points.view[0] = view;
    return points;
}

Vec3f at_cosine(float cosine) {
    return {std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
}

Lobe refraction(const ShadingPoints& points, float roughness, float ior) {
    Lobe lobe = glossy(points, roughness);
    lobe.kind = LobeKind::Refraction;
    lobe.ior.assign(1, ior);
    return lobe;
}

Lobe with_fresnel(Lobe lobe, float ior) {
    lobe.fresnel = FresnelKind::Dielectric;
    lobe.ior.assign(1, ior);
    lobe.f0.assign(1, Vec3f(f0_from_ior(ior)));
    lobe.f90.assign(1, Vec3f(1.0f));
    return lobe;
}

/// Whether light from wo can be refracted to the view by a facet that faces up.
bool some_facet_refracts(const Vec3f& view, const Vec3f& wo, float ior) {
    const Vec3f half = (ior > 1.0f ? -1.0f : 1.0f) * (ior * wo + view);
    return half.z > 0.0f && glm::dot(half, view) > 0.0f && glm::dot(half, wo) < 0.0f;
}

/// Integral over the sphere by mid-points in both angles: no sampling involved.
template <class Value>
double sphere_integral(Value value, int steps = 700) {
    double sum = 0.0;
    for (int i = 0; i < 2 * steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double theta = kPi * (i + 0.5) / (2 * steps), phi = 2.0 * kPi * (j + 0.5) / steps;
            const double s = std::sin(theta);
            sum += s * value(Vec3f(s * std::cos(phi), s * std::sin(phi), std::cos(theta)));
        }
    return sum * kPi * kPi / (static_cast<double>(steps) * steps);
}

// Seen from within at 50 degrees, beyond the 42 of total reflection: the view's own angle lets
// nothing pass, tilted facets do.  Cycles takes a way out of the glass as often as they let it
// pass.
TEST(RoughRefraction, is_as_likely_as_its_facets_let_pass_beyond_total_reflection) {
    const Vec3f wi = at_cosine(0.643f);
    const ShadingPoints points = seen_from(wi);
    constexpr float kIor = 1.0f / kGlass;
    SurfaceClosure closure = closure_of(with_fresnel(glossy(points, 0.5f), kIor));
    closure.lobes.push_back(with_fresnel(refraction(points, 0.5f, kIor), kIor));
    const PointBsdf bsdf(closure, points, 0, GgxAlbedo::shared());
    ASSERT_EQ(bsdf.importance(1), 0.0f);
    int passing = 0;
    for (const Vec3f& wo :
         {Vec3f(-0.9f, 0, -0.4f), Vec3f(-0.6f, 0.2f, -0.7f), Vec3f(-0.99f, 0.1f, -0.1f)}) {
        const Vec3f out = glm::normalize(wo);
        if (!some_facet_refracts(wi, out, kIor)) continue;
        ++passing;
        // Fresnel's equations at the facet, of both polarisations.
        const Vec3f half = glm::normalize(kIor * out + wi);
        const double c = std::abs(glm::dot(half, wi)), t = std::abs(glm::dot(half, out));
        const double s = (c - kIor * t) / (c + kIor * t), p = (t - kIor * c) / (t + kIor * c);
        const double passed = 1.0 - 0.5 * (s * s + p * p);
        EXPECT_NEAR(bsdf.chance(1, out), bsdf.pdf(1, out) * passed, 1e-4 * bsdf.pdf(1, out));
        EXPECT_GT(bsdf.chance(1, out), 0.0f);
    }
    EXPECT_GE(passing, 2);
}

// The same without Fresnel, beside a mirror nine times as dark: Cycles takes the refraction in nine
// of ten, wherever it goes.
TEST(RoughRefraction, is_as_likely_as_its_weight_without_fresnel) {
    const Vec3f wi = at_cosine(0.643f);
    const ShadingPoints points = seen_from(wi);
    SurfaceClosure closure = closure_of(refraction(points, 0.5f, 1.0f / kGlass));
    closure.lobes[0].weight.assign(1, Vec3f(0.9f));
    closure.lobes.push_back(glossy(points, 0.5f));
    closure.lobes[1].weight.assign(1, Vec3f(0.1f));
    const PointBsdf bsdf(closure, points, 0, GgxAlbedo::shared());
    const Vec3f out = glm::normalize(Vec3f(-0.6f, 0.2f, -0.7f));
    ASSERT_GT(bsdf.pdf(0, out), 0.0f);
    EXPECT_NEAR(bsdf.chance(0, out), 0.9f * bsdf.pdf(0, out), 1e-5f * bsdf.pdf(0, out));
}

// No sample goes where no facet refracts: beside a lobe that lets a hundred times as much through,
// as much of the density is left there, which is what chance would take, and all where there is
// none.
TEST(RoughRefraction, where_nothing_refracts_has_the_density_of_its_part) {
    const Vec3f wi = at_cosine(0.6f);
    const ShadingPoints points = seen_from(wi);
    constexpr float kIor = 1.0f / kGlass;
    const PointBsdf alone = prepare(refraction(points, 0.7f, kIor), points);
    SurfaceClosure closure = closure_of(refraction(points, 0.7f, kIor));
    closure.lobes[0].weight.assign(1, Vec3f(0.01f));
    Lobe& translucent = closure.lobes.emplace_back(glossy(points, 1.0f));
    translucent.kind = LobeKind::Translucent;
    const PointBsdf bsdf(closure, points, 0, GgxAlbedo::shared());
    int here = 0, nowhere = 0;
    for (float x = -0.95f; x < 1.0f; x += 0.1f) {
        const Vec3f out(x, 0.1f, -std::sqrt(0.99f - x * x));
        if (alone.pdf(0, out) < 1e-3f) continue;
        const bool refracts = some_facet_refracts(wi, out, kIor);
        (refracts ? here : nowhere) += 1;
        EXPECT_NEAR(bsdf.pdf(0, out), alone.pdf(0, out) * (refracts ? 1.0f : 0.01f),
                    1e-4f * alone.pdf(0, out))
            << x;
    }
    EXPECT_GT(here, 2);
    EXPECT_GT(nowhere, 2);
}

// A stick in water: 60 degrees in air is asin(sin 60 / 1.5) in glass, 35.264 degrees.
TEST(SharpRefraction, obeys_snell_and_passes_what_is_not_reflected) {
    const ShadingPoints points = seen_from(at_cosine(0.5f));
    const PointBsdf bsdf = prepare(with_fresnel(refraction(points, 0.0f, kGlass), kGlass), points);
    ASSERT_TRUE(bsdf.is_sharp(0));
    Vec3f wo, share;
    ASSERT_TRUE(bsdf.deflect(0, wo, share));
    EXPECT_NEAR(wo.x, -std::sqrt(0.75f) / kGlass, 1e-6f);
    EXPECT_LT(wo.z, 0.0f);
    EXPECT_NEAR(share.x, 1.0f - 0.089187f, 1e-5f);  // 60 degrees on glass reflect 0.0892
    EXPECT_TRUE(bsdf.transmits(0));
    EXPECT_EQ(bsdf.ior(0), kGlass);
}

TEST(SharpRefraction, nothing_leaves_past_the_critical_angle) {
    const ShadingPoints points = seen_from(at_cosine(0.7f));  // beyond asin(1 / 1.5)
    Vec3f wo, share;
    EXPECT_FALSE(prepare(refraction(points, 0.0f, 1.0f / kGlass), points).deflect(0, wo, share));
}

TEST(SharpRefraction, an_index_of_one_bends_nothing) {
    const ShadingPoints points = seen_from(at_cosine(0.3f));
    const PointBsdf bsdf = prepare(refraction(points, 0.6f, 1.0f), points);
    Vec3f wo, share;
    ASSERT_TRUE(bsdf.is_sharp(0));
    ASSERT_TRUE(bsdf.deflect(0, wo, share));
    EXPECT_NEAR(glm::distance(wo, -points.view[0]), 0.0f, 1e-6f);
    EXPECT_EQ(share, Vec3f(1.0f));
}

// Radiance over the squared index is what does not change with the direction of light.
TEST(RoughRefraction, is_reciprocal_up_to_the_squared_index) {
    const Vec3f above = glm::normalize(Vec3f(0.4f, 0.1f, 0.7f));
    const Vec3f below = glm::normalize(Vec3f(-0.1f, 0.2f, -0.9f));
    for (const Distribution distribution : {Distribution::Ggx, Distribution::Beckmann}) {
        ShadingPoints points = seen_from(above);
        Lobe into = refraction(points, 0.6f, kGlass);
        into.distribution = distribution;
        const float in = prepare(into, points).evaluate(below).transmission.x / -below.z;
        points = seen_from(below);
        points.normal[0] = points.geometric_normal[0] = Vec3f(0, 0, -1);
        Lobe out_of = refraction(points, 0.6f, 1.0f / kGlass);
        out_of.distribution = distribution;
        const float out = prepare(out_of, points).evaluate(above).transmission.x / above.z;
        EXPECT_GT(out, 0.003f);
        EXPECT_NEAR(in, kGlass * kGlass * out, 1e-4f * in);
    }
}

struct Case {
    Distribution distribution;
    float ior, roughness, cos_view;
};

class RoughRefractions : public testing::TestWithParam<Case> {
  protected:
    RoughRefractions() : points(seen_from(at_cosine(GetParam().cos_view))) {
        Lobe lobe = refraction(points, GetParam().roughness, GetParam().ior);
        lobe.distribution = GetParam().distribution;
        closure = closure_of(with_fresnel(lobe, GetParam().ior));
    }
    PointBsdf bsdf() const { return PointBsdf(closure, points, 0, GgxAlbedo::shared()); }
    bool can_refract(const Vec3f& wo) const {
        return some_facet_refracts(points.view[0], wo, GetParam().ior);
    }

    ShadingPoints points;
    SurfaceClosure closure;
};

// 2^14 points of a net: at most .004 of the share, where independent ones had a deviation of .004.
TEST_P(RoughRefractions, its_density_integrates_to_the_share_of_samples_that_leave) {
    const PointBsdf glass = bsdf();
    const double integral =
        sphere_integral([&](const Vec3f& wo) { return can_refract(wo) ? glass.pdf(0, wo) : 0.0f; });
    const SobolPoints sequence(5);
    const int count = 1 << 14;
    int valid = 0;
    for (int i = 0; i < count; ++i) {
        Vec3f wo;
        if (!glass.sample(0, sequence(static_cast<std::uint32_t>(i)), wo)) continue;
        EXPECT_LT(wo.z, 0.0f);
        ++valid;
    }
    EXPECT_GT(valid, count / 8);
    EXPECT_NEAR(integral, static_cast<double>(valid) / count, 0.006);
}

TEST_P(RoughRefractions, its_density_is_nowhere_negative) {
    const PointBsdf glass = bsdf();
    double least = 0.0;
    sphere_integral([&](const Vec3f& wo) {
        const float density = glass.pdf(0, wo);
        least = std::min<double>(least, density);
        return density;
    });
    EXPECT_EQ(least, 0.0);
}

TEST_P(RoughRefractions, sampling_estimates_what_quadrature_integrates) {
    // An integrand that is not symmetric, so that a rotated frame would show.
    const PointBsdf glass = bsdf();
    const auto value = [&](const Vec3f& wo) {
        return can_refract(wo)
                   ? glass.evaluate(wo).transmission.x * (1.0f + wo.x + 0.5f * wo.y * wo.y)
                   : 0.0f;
    };
    const double expected = sphere_integral(value);
    const SobolPoints sequence(9);
    const int count = 1 << 14;
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        Vec3f wo;
        if (glass.sample(0, sequence(static_cast<std::uint32_t>(i)), wo))
            sum += value(wo) / glass.pdf(0, wo);
    }
    EXPECT_GT(expected, 0.02);
    EXPECT_NEAR(sum / count, expected, 0.008 * expected);
}

INSTANTIATE_TEST_SUITE_P(Lobes, RoughRefractions,
                         testing::Values(Case{Distribution::Ggx, kGlass, 0.4f, 0.8f},
                                         Case{Distribution::Ggx, kGlass, 0.9f, 0.3f},
                                         Case{Distribution::Ggx, 1.0f / kGlass, 0.6f, 0.9f},
                                         Case{Distribution::Ggx, 1.0f / kGlass, 0.7f, 0.5f},
                                         Case{Distribution::Beckmann, kGlass, 0.5f, 0.6f},
                                         Case{Distribution::Beckmann, 1.0f / kGlass, 0.5f, 0.8f}));

// White glass reflects or transmits all, up to what is lost between facets, which is made up for.
// What Cycles adds where no facet refracts is beyond that.
TEST(Glass, white_glass_in_a_white_furnace_vanishes) {
    for (const float ior : {kGlass, 1.0f / kGlass, 2.4f})
        for (const float cos_view : {0.4f, 1.0f})
            for (const float roughness : {0.5f, 1.0f}) {
                const ShadingPoints points = seen_from(at_cosine(cos_view));
                SurfaceClosure closure;
                closure.lobes = {with_fresnel(glossy(points, roughness), ior),
                                 with_fresnel(refraction(points, roughness, ior), ior)};
                const PointBsdf glass(closure, points, 0, GgxAlbedo::shared());
                const double single = sphere_integral(
                    [&](const Vec3f& wo) {
                        return wo.z > 0.0f || some_facet_refracts(points.view[0], wo, ior)
                                   ? total(glass.evaluate(wo)).x
                                   : 0.0f;
                    },
                    500);
                const float lost = glass_compensation(Vec3f(1.0f), roughness, cos_view, ior).x;
                EXPECT_NEAR(single * lost, 1.0, 0.012)
                    << ior << " " << cos_view << " " << roughness;
                if (roughness == 1.0f) {
                    EXPECT_LT(single, 0.95);  // there was something to make up for
                }
            }
}

TEST(Glass, bounces_between_facets_take_on_the_colour) {
    const Vec3f made_up = glass_compensation(Vec3f(1.0f, 0.5f, 0.0f), 1.0f, 0.5f, kGlass);
    EXPECT_GT(made_up.x, made_up.y);
    EXPECT_GT(made_up.y, 1.0f);
    EXPECT_EQ(made_up.z, 1.0f);
}

TEST(Glass, what_lies_below_is_seen_and_what_lies_above_is_not) {
    const ShadingPoints points = seen_from(at_cosine(0.8f));
    const PointBsdf glass = prepare(refraction(points, 0.5f, kGlass), points);
    EXPECT_TRUE(glass.can_see(Vec3f(0, 0, -3), 1.0f));
    EXPECT_TRUE(glass.can_see(Vec3f(0, 0, 0.9f), 1.0f));
    EXPECT_FALSE(glass.can_see(Vec3f(0, 0, 3), 1.0f));
    EXPECT_EQ(total(glass.evaluate(Vec3f(0, 0, 1))), Vec3f(0.0f));
    EXPECT_EQ(glass.pdf(0, Vec3f(0, 0, 1)), 0.0f);
    EXPECT_TRUE(glass.transmits());
    EXPECT_FALSE(prepare(glossy(points, 0.5f), points).transmits());
}

// The choice among many lamps goes by a bound: what the lobe sends on, nowhere more than that.
TEST(Glass, its_reach_bounds_what_it_lets_through) {
    for (const float ior : {kGlass, 1.0f / kGlass, 1.1f})
        for (const float roughness : {0.2f, 0.5f, 0.9f}) {
            const ShadingPoints points = seen_from(at_cosine(0.85f));
            const PointBsdf glass = prepare(refraction(points, roughness, ior), points);
            std::vector<LobeReach> reaches;
            glass.reaches(reaches);
            ASSERT_EQ(reaches.size(), 1u);
            const LobeReach& reach = reaches[0];
            double most = 0.0;
            const double over = sphere_integral(
                [&](const Vec3f& wo) {
                    const float cosine =
                        reach.mirrored.cos < 0.0f ? 1.0f : glm::dot(wo, reach.mirrored.axis);
                    const float sin2 = 0.5f * std::max(0.0f, 1.0f - cosine);
                    const float t = sin2 + reach.alpha2 * (1.0f - sin2);
                    const float bound =
                        glm::dot(wo, reach.normal.axis) > 0.0f ? reach.scale / (t * t) : 0.0f;
                    const float value = glass.evaluate(wo).transmission.x;
                    most = std::max(most, static_cast<double>(value / (bound + 1e-6f)));
                    return value > bound + 1e-6f ? static_cast<double>(value) : 0.0;
                },
                200);
            EXPECT_LT(over, 0.01) << ior << " " << roughness << " " << most;
        }
}

}  // namespace
}  // namespace granita
