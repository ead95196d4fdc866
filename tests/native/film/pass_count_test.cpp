// SPDX-License-Identifier: GPL-3.0-or-later
// Strobing of the film's filters against the table of docs/sampling_error.md.
#include "hider/pass_count.h"

#include <gtest/gtest.h>

#include <cmath>

#include "film/filter.h"
#include "measured.h"

namespace granita {
namespace {

struct Row {
    const char* name;
    FilterKind kind;
    float width;
    double ripple[7];  ///< at the steps below
    double step;       ///< the longest with a ripple of 2 %
};
constexpr double kSteps[7] = {0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 3.0};
// Box: exact steps 1/m lie between steps that ripple up to step / 2.
const Row kRows[] = {
    {"box", FilterKind::Box, 1, {0, .375, 0, .625, .75, 1, 1.5}, .04},
    {"tent", FilterKind::Tent, 2, {0, .093, 0, .154, .372, 1.0, 1.5}, .36},
    {"gaussian", FilterKind::Gaussian, 1.5f, {0, .014, .125, .338, .58, 1.0, 1.6}, .77},
    {"Blackman-Harris", FilterKind::BlackmanHarris, 1.5f, {0, 0, .033, .177, .394, .83, 1.4}, .95},
    {"Mitchell", FilterKind::Mitchell, 4, {0, .004, 0, .041, .231, .78, 1.4}, 1.18},
    {"Catmull-Rom", FilterKind::CatmullRom, 4, {0, .007, 0, .059, .316, 1.0, 1.7}, 1.16},
    {"B-spline", FilterKind::Bspline, 4, {0, .004, 0, .007, .059, .33, .94}, 1.35},
    {"Lanczos", FilterKind::Lanczos, 6, {0, .001, .003, .020, .097, 1.0, 1.9}, 1.25},
};

FilterFactor factor(const PixelFilter& filter) {
    return [&filter](float d) { return filter.evaluate(d); };
}

class Strobing : public testing::TestWithParam<Row> {};

TEST_P(Strobing, RippleOfATranslatingEdge) {
    const Row& row = GetParam();
    const PixelFilter filter(row.kind, row.width);
    for (int i = 0; i < 7; ++i)
        EXPECT_WITHIN(strobing_ripple(factor(filter), filter.radius(), kSteps[i]), row.ripple[i],
                      std::max(.1 * row.ripple[i], .003))
            << "step " << kSteps[i];
}

TEST_P(Strobing, LongestStep) {
    const Row& row = GetParam();
    const PixelFilter filter(row.kind, row.width);
    const double step = longest_step(factor(filter), filter.radius());
    // The table's two digits and the search's one in a hundred.
    EXPECT_WITHIN(step, row.step, .01 + .011 * row.step);
    for (double s = step; s > .04; s *= .97)
        EXPECT_LE(strobing_ripple(factor(filter), filter.radius(), s), .0205) << "step " << s;
}

INSTANTIATE_TEST_SUITE_P(Filters, Strobing, testing::ValuesIn(kRows), [](const auto& info) {
    std::string name;
    for (const char c : std::string(info.param.name))
        if (std::isalpha(static_cast<unsigned char>(c))) name += c;
    return name;
});

TEST(PassCount, CoversMotionAndLens) {
    EXPECT_EQ(pass_count({0, 0}, 1), 1);
    EXPECT_EQ(pass_count({.5, 0}, 1), 1);
    EXPECT_EQ(pass_count({20, 0}, .8), 25);
    EXPECT_EQ(pass_count({20, 3}, 1), 29);  // pi 9 = 28.3
    EXPECT_EQ(pass_count({1e9, 0}, 1), kMostPasses);
    EXPECT_EQ(pass_count({INFINITY, 0}, 1), kMostPasses);
}

}  // namespace
}  // namespace granita
