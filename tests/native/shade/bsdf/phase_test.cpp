// SPDX-License-Identifier: GPL-3.0-or-later
// Phase functions: densities over the sphere, sampled as they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/bsdf/lobe_shape.h"

namespace granita {
namespace {

struct Case {
    PhaseKind kind;
    Vec2f form;
};

class EveryPhase : public testing::TestWithParam<Case> {
  protected:
    /// Seen along -z: light goes on along +z.
    std::unique_ptr<const LobeShape> phase() const {
        const Vec3f view(0.0f, 0.0f, -1.0f);
        return make_phase({view, view, view, 1.0f}, GetParam().kind, GetParam().form);
    }
    /// 2 pi times the integral over the cosine down to `least` of density times `value`; by the
    /// cube of the sine of half the angle, as densities have peaks ahead.
    template <class Value>
    double integral(double least, Value value) const {
        const auto at = phase();
        const double last = std::cbrt(std::sqrt(0.5 * (1.0 - least)));
        const int steps = 200000;
        double sum = 0.0;
        for (int i = 0; i < steps; ++i) {
            const double x = last * (i + 0.5) / steps, s = x * x * x;
            const double cosine = 1.0 - 2.0 * s * s;
            const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
            const Vec3f wo(static_cast<float>(sine), 0.0f, static_cast<float>(cosine));
            // |d cosine| = 4 s ds, ds = 3 x^2 dx
            sum += at->pdf(wo) * value(cosine) * 12.0 * s * x * x;
        }
        return 2.0 * kPi * sum * last / steps;
    }
};

TEST_P(EveryPhase, its_density_integrates_to_one) {
    EXPECT_NEAR(integral(-1.0, [](double) { return 1.0; }), 1.0, 0.002);
}

TEST_P(EveryPhase, samples_are_as_dense_as_the_density) {
    const auto at = phase();
    const SobolPoints sequence(3);
    const int count = 1 << 14;
    for (const double least : {0.99, 0.9, 0.5, 0.0, -0.5, -0.9}) {
        int within = 0;
        for (int i = 0; i < count; ++i) {
            Vec3f wo;
            ASSERT_TRUE(at->sample(sequence(static_cast<std::uint32_t>(i)), wo));
            EXPECT_NEAR(glm::length(wo), 1.0f, 1e-4f);
            within += wo.z > static_cast<float>(least);
        }
        // Sobol's: off by a few of the samples.
        EXPECT_NEAR(static_cast<double>(within) / count,
                    integral(least, [](double) { return 1.0; }), 0.003)
            << least;
    }
}

INSTANTIATE_TEST_SUITE_P(kinds, EveryPhase,
                         testing::Values(Case{PhaseKind::HenyeyGreenstein, {0.0f, 0.0f}},
                                         Case{PhaseKind::HenyeyGreenstein, {0.8f, 0.0f}},
                                         Case{PhaseKind::HenyeyGreenstein, {-0.4f, 0.0f}},
                                         Case{PhaseKind::Rayleigh, {0.0f, 0.0f}},
                                         Case{PhaseKind::Draine, {0.0f, 1.0f}},
                                         Case{PhaseKind::Draine, {0.6f, 0.5f}},
                                         Case{PhaseKind::Draine, {-0.3f, 20.0f}},
                                         Case{PhaseKind::Draine, {0.6f, 250.0f}},
                                         Case{PhaseKind::FournierForand, {1.33f, 0.1f}},
                                         Case{PhaseKind::FournierForand, {1.1f, 0.02f}},
                                         Case{PhaseKind::FournierForand, {1.8f, 0.4f}}));

TEST(phase, draine_without_alpha_is_henyey_and_greensteins_and_of_1_without_g_rayleighs) {
    const Vec3f view(0.0f, 0.0f, -1.0f);
    const LobeView seen{view, view, view, 1.0f};
    const auto same = [&](PhaseKind kind, const Vec2f& form, const Vec2f& draine) {
        const auto one = make_phase(seen, kind, form);
        const auto other = make_phase(seen, PhaseKind::Draine, draine);
        for (float z = -1.0f; z <= 1.0f; z += 0.1f) {
            const Vec3f wo(std::sqrt(std::max(0.0f, 1.0f - z * z)), 0.0f, z);
            EXPECT_NEAR(one->pdf(wo), other->pdf(wo), 0.01f * one->pdf(wo)) << z;
        }
    };
    same(PhaseKind::HenyeyGreenstein, {0.5f, 0.0f}, {0.5f, 0.0f});
    same(PhaseKind::Rayleigh, {0.0f, 0.0f}, {0.0f, 1.0f});
}

}  // namespace
}  // namespace granita
