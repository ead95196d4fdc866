// SPDX-License-Identifier: GPL-3.0-or-later
// A lens that opens, closes or focuses elsewhere within the shutter against closed forms: circles
// of confusion of lens_test.cpp, averaged over the shutter.
#include <algorithm>

#include "defocus.h"
#include "executor_test.h"

namespace granita::test {
namespace {

class LensMotion : public ExecutorTest {};
GRANITA_ALL_EXECUTORS(LensMotion);

/// Orthographic, a pixel a unit; knots of (radius, focus distance).
Camera moving_lens(const std::vector<Vec2d>& knots) {
    Camera camera = pixel_camera();
    camera.lens = LensKnots(knots, camera.projection);
    return camera;
}

/// Mean over the shutter, by the midpoint rule.
template <class F>
double over_shutter(F f) {
    constexpr int kSteps = 64;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) sum += f((i + .5) / kSteps);
    return sum / kSteps;
}

/// Half of the raster, left of x = 8.
Grid wall(float z) {
    return rectangle(-60, -60, 8, 80, z, 30, 60);
}

TEST_P(LensMotion, RackFocus) {
    // The sharp plane comes from 10 to 40 through the edge at 20: a circle of 6 |20 / F - 1|
    // pixels.
    Shot shot;
    shot.camera = moving_lens({{6, 10}, {6, 40}});
    shot.grids.push_back(wall(20));
    const auto alpha = [](double x, double) {
        return over_shutter(
            [=](double t) { return edge_in_disc(8 - x, 6 * std::fabs(20 / (10 + 30 * t) - 1)); });
    };
    EXPECT_LE(worst_excess(render(GetParam(), shot), alpha, {.0148, .0294}), 0);
}

TEST_P(LensMotion, ApertureThatOpensFromAPinhole) {
    // Radius 10 t at twice the focus: discs of 10 t pixels, whose second moment is 25 t^2.
    Shot shot;
    shot.options.samples = 256;
    shot.camera = moving_lens({{0, 10}, {10, 10}});
    shot.tiles = {0, 0, 2, 2};
    shot.grids.push_back(rectangle(15, 15, 17, 17, 20, 2, 2));
    const Picture p = render(GetParam(), shot);
    double i0 = 0, i1 = 0, i2 = 0;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
            const double a = p.alpha(x, y);
            i0 += a;
            i1 += a * (x + .5);
            i2 += a * ((x + .5 - 16) * (x + .5 - 16) + (y + .5 - 16) * (y + .5 - 16));
        }
    // Four times what is predicted of Owen-scrambled samples (docs/sampling_error.md).
    EXPECT_WITHIN(i0, 4, 4 * .086);
    EXPECT_WITHIN(i1 / i0, 16, 4 * .095);
    // Per axis the mean of R^2 / 4 over the shutter, the square 2^2 / 12 and the pixel 1 / 12.
    EXPECT_WITHIN(i2 / i0, 2 * (100.0 / 3 / 4 + 4.0 / 12 + 1.0 / 12), 4 * .234);
}

TEST_P(LensMotion, OpeningAndFocusThroughThreeKnots) {
    Shot shot;
    shot.camera = moving_lens({{2, 12}, {8, 16}, {4, 40}});
    shot.grids.push_back(wall(20));
    const auto circle = [](double t) {
        const double radius = t < .5 ? 2 + 12 * t : 8 - 8 * (t - .5);
        const double focus = t < .5 ? 12 + 8 * t : 16 + 48 * (t - .5);
        return radius * std::fabs(20 / focus - 1);
    };
    const auto alpha = [&](double x, double) {
        return over_shutter([&](double t) { return edge_in_disc(8 - x, circle(t)); });
    };
    EXPECT_LE(worst_excess(render(GetParam(), shot), alpha, {.0208, .0272}), 0);
}

TEST_P(LensMotion, WithWhatMovesInDepth) {
    // In perspective, edge and focus on their way past each other: both are exact, whatever the
    // knots of the two.  The edge stays at the slope of pixel 8.
    Shot shot;
    shot.camera = pinhole_camera(100);
    shot.camera.lens = LensKnots({{.1, 4}, {.3, 6}, {.3, 12}}, shot.camera.projection);
    shot.grids.push_back(make_grid(30, 30, 2, [](float u, float v, int k) {
        const float z = k ? 5.0f : 10.0f;
        return Vec3f((.08f - .8f * (1 - u)) * z, (v - .5f) * 2 * z, z);
    }));
    const auto circle = [](double t) {
        const double radius = t < .5 ? .1 + .4 * t : .3;
        const double focus = t < .5 ? 4 + 4 * t : 6 + 12 * (t - .5), z = 10 - 5 * t;
        return 100 * radius * std::fabs(1 / focus - 1 / z);
    };
    const auto alpha = [&](double x, double) {
        return over_shutter([&](double t) { return edge_in_disc(8 - x, circle(t)); });
    };
    EXPECT_LE(worst_excess(render(GetParam(), shot), alpha, {.0171, .0287}), 0);
}

TEST_P(LensMotion, FocusThroughAClosedSurface) {
    // z = 10 + x/4, the sharp plane passes through all of it: every sample once.
    Shot shot;
    shot.options.samples = 16;
    shot.camera = moving_lens({{0, 6}, {5, 14}});
    shot.grids.push_back(make_grid(96, 96, 1, [](float u, float v, int) {
        return Vec3f(-40 + 96 * u, -40 + 96 * v, 10 + .25f * (-40 + 96 * u - 8));
    }));
    set_color(shot.grids[0], Vec3f(1), Vec3f(.5f));
    for (const int layers : layers_per_sample(GetParam(), shot)) ASSERT_EQ(layers, 1);
}

TEST_P(LensMotion, KnotsThatAreTheSameAreAStillLens) {
    Shot still, knots;
    still.camera = moving_lens({{3, 12}});
    knots.camera = moving_lens({{3, 12}, {3, 12}, {3, 12}});
    still.grids.push_back(rectangle(2.3f, 3.7f, 11.2f, 12.9f, 20, 9, 9));
    knots.grids = still.grids;
    EXPECT_EQ(render(GetParam(), still).combined, render(GetParam(), knots).combined);
}

TEST_P(LensMotion, AShutterThatOpensOnceSeesOneInstant) {
    // A spike of opening at t = 3/4: the picture is that of the lens as it is then, to the width of
    // the spike.
    Shot moving, still;
    moving.camera = moving_lens({{0, 10}, {8, 30}});
    moving.options.shutter_curve.assign(4097, 0.0f);
    moving.options.shutter_curve[3072] = 1.0f;
    still.camera = moving_lens({{6, 25}});
    for (Shot* shot : {&moving, &still}) shot->grids.push_back(wall(10));
    const Picture a = render(GetParam(), moving), b = render(GetParam(), still);
    double worst = 0;
    for (std::size_t i = 0; i < a.combined.size(); ++i)
        worst = std::max<double>(worst, std::fabs(a.combined[i].w - b.combined[i].w));
    // The same samples, whose lens points differ by 1/4096 of 8 pixels at most: of 64 samples an
    // edge passes .13 on average, and four standard deviations above (Poisson) are 1.6.
    EXPECT_LE(worst, 1.6 / 64);
}

}  // namespace
}  // namespace granita::test
