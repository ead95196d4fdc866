// SPDX-License-Identifier: GPL-3.0-or-later
// Motion against closed forms: hard cases 10, 13, 16 to 19, 21, 22, 25, 26.
#include <algorithm>

#include "executor_test.h"

namespace granita::test {
namespace {

class Motion : public ExecutorTest {};
GRANITA_ALL_EXECUTORS(Motion);

TEST_P(Motion, MovingEdge) {
    // Four times the worst pixel's error (docs/sampling_error.md), of a mean of four: the 16 pixels
    // of a column are not independent, since neighbours continue one sequence.
    for (const auto& [v, predicted] :
         {std::pair{0.7f, .0176}, {5.0f, .0157}, {20.0f, .0113}, {100.0f, .0079}}) {
        Shot shot;
        shot.tiles = {0, 0, 2, 1};
        const float e0 = 12.3f - v / 2;
        shot.grids.push_back(moving_rectangle(-200, -1, e0, 17, 5, v, 0, 40, 18));
        const Picture p = render(GetParam(), shot);
        const auto g = [](double e) { return e < 0 ? 0.0 : e <= 1 ? e * e / 2 : e - .5; };
        for (int x = 0; x < 32; ++x) {
            double column = 0;
            for (int y = 0; y < 16; ++y) column += p.alpha(x, y) / 16.0;
            const double expected = (g(e0 - x + v) - g(e0 - x)) / v;
            EXPECT_WITHIN(column, expected, 4 * predicted / 2) << "v " << v << " x " << x;
        }
    }
}

TEST_P(Motion, MovingDisc) {
    const double r = 6, length = 9;
    Shot shot;
    shot.tiles = {0, 0, 2, 1};
    shot.grids.push_back(make_grid(128, 4, 2, [=](float u, float v, int k) {
        const double a = 2 * M_PI * std::lround(u * 128) / 128;
        return Vec3f(9 + r * v * std::cos(a) + length * k, 8 + r * v * std::sin(a), 5);
    }));
    const auto fraction = [=](double x, double y) {
        const double d = y - 8, a = x - 9;
        if (std::fabs(d) >= r) return 0.0;
        const double h = std::sqrt(r * r - d * d);
        return std::max(0.0, std::min(a + h, length) - std::max(a - h, 0.0)) / length;
    };
    EXPECT_LE(worst_excess(render(GetParam(), shot), fraction, {.0136, .0283}), 0);
}

/// A disc of radius 1 that comes from z0 to z1, focal length 500 pixels, seen around radius 120.
Picture dolly(HiderMaker make, float z0, float z1) {
    Shot shot;
    shot.camera = pinhole_camera(500);
    shot.tiles = {7, 0, 8, 1};
    shot.grids.push_back(disc(0, 0, {1, 1}, {z0, z1}, 96, 3));
    return render(make, shot);
}

TEST_P(Motion, DollyInterpolatesBeforeProjection) {
    const auto fraction = [](double x, double y) {
        const double t = (500 / std::hypot(x, y) - 10) / (2 - 10);
        return std::clamp(1 - t, 0.0, 1.0);
    };
    ASSERT_NEAR(fraction(120, 0), .27083, 1e-5);
    EXPECT_LE(worst_excess(dolly(GetParam(), 10, 2), fraction, {.0067, .0080}), 0);
}

TEST_P(Motion, ThroughTheNearPlaneAndTheEye) {
    // z = 2 - 3t, near clip .1: seen from z = min(2, 500 / r) on, until the clip.
    const auto fraction = [](double x, double y) {
        return (std::min(2.0, 500 / std::hypot(x, y)) - .1) / 3;
    };
    ASSERT_NEAR(fraction(120, 0), .6333, 1e-4);
    EXPECT_LE(worst_excess(dolly(GetParam(), 2, -1), fraction, {.0079, .0080}), 0);
}

TEST_P(Motion, ScaleThroughZero) {
    Shot shot;
    shot.tiles = {1, 0, 2, 1};
    shot.grids.push_back(disc(0, 0, {50, -50}, {5, 5}, 96, 5));
    const auto fraction = [](double x, double y) {
        return std::max(0.0, 1 - std::hypot(x, y) / 50);
    };
    EXPECT_LE(worst_excess(render(GetParam(), shot), fraction, {.0098, .0130}), 0);
}

TEST_P(Motion, MirroredInstance) {
    Shot shot, mirrored;
    const auto shape = [](float u, float v, float sign) {
        return Vec3f(sign * (-7 + 9 * u + 3 * v), 2 + 11 * v - 2 * u, 5 + u);
    };
    shot.options.sampling = mirrored.options.sampling = Sampling::Regular;
    shot.options.time_samples = mirrored.options.time_samples = 1;  // a square lattice
    shot.tiles = mirrored.tiles = {-1, 0, 1, 1};
    shot.grids.push_back(make_grid(5, 6, 1, [=](float u, float v, int) { return shape(u, v, 1); }));
    mirrored.grids.push_back(
        make_grid(5, 6, 1, [=](float u, float v, int) { return shape(u, v, -1); }));
    const Picture a = render(GetParam(), shot), b = render(GetParam(), mirrored);
    double sum = 0;
    for (int y = 0; y < 16; ++y)
        for (int x = -16; x < 16; ++x) {
            EXPECT_EQ(a.alpha(x, y), b.alpha(-1 - x, y));
            sum += a.alpha(x, y);
        }
    // The parallelogram's area: its sides are vectors of the lattice, which so has as many points
    // in it wherever it lies.
    EXPECT_WITHIN(sum, 9 * 11 + 2 * 3, 1e-3);
}

TEST_P(Motion, VeryFastAndSmall) {
    // 50 pixels wide over 5000 pixels: each pixel sees it for 1 % of the shutter.
    Shot shot;
    shot.options.samples = 256;
    shot.grids.push_back(moving_rectangle(-2500, -2, -2450, 18, 5, 5000, 0, 50, 20));
    const auto fraction = [](double, double) { return .01; };
    EXPECT_LE(worst_excess(render(GetParam(), shot), fraction, {.0022, .0026}), 0);
}

TEST_P(Motion, OutAndBackIsSeenOnlyInTheMiddle) {
    // Three knots: far left, over the tile, far left; |t - 1/2| < 1/4 * ... by its own closed form.
    Shot shot;
    shot.grids.push_back(make_grid(10, 5, 3, [](float u, float v, int k) {
        return Vec3f(-60 + 50 * u + (k == 1 ? 40.0f : 0.0f), -4 + 24 * v, 5);
    }));
    const auto fraction = [](double x, double) {  // right border at -10 + 40 (1 - 2 |t - 1/2|)
        return std::clamp(1 - (x + 10) / 40, 0.0, 1.0);
    };
    EXPECT_LE(worst_excess(render(GetParam(), shot), fraction, {.0106, .0152}), 0);
}

TEST_P(Motion, OccluderAndObjectAtDifferentTimes) {
    // The black occluder crosses first; what counts is when the white object is seen alone.
    Shot shot;
    shot.options.samples = 256;
    shot.grids.push_back(moving_rectangle(-4, -2, 0, 18, 9, 16, 0, 4, 10));  // white, 4 px, 16 px/s
    shot.grids.push_back(moving_rectangle(-2, -2, 2, 18, 4, 16, 0, 4, 10));
    set_color(shot.grids[1], Vec3f(0));
    Picture p = render(GetParam(), shot);
    for (Vec4f& c : p.combined) c.w = c.x;
    const auto white = [](double x, double) {  // [x, x + 4] / 16 without [x - 2, x + 2] / 16
        const auto in = [](double a, double b) {
            return std::max(0.0, std::min(b, 16.0) - std::max(a, 0.0)) / 16;
        };
        return in(x, x + 4) - in(x, x + 2);
    };
    EXPECT_LE(worst_excess(p, white, {.0055, .0072}), 0);
}

TEST_P(Motion, ShutterCurveWeighsTime) {
    // Opening 0 -> 1 -> 0: an edge that crosses the pixels at t = x / 16 leaves 1 - W(t).
    Shot shot;
    shot.options.shutter_curve = {0, 1, 0};
    shot.grids.push_back(moving_rectangle(-100, -2, 0, 18, 5, 16, 0, 50, 10));
    const auto fraction = [](double x, double) {
        const double t = x / 16;
        return 1 - (t < .5 ? 2 * t * t : 1 - 2 * (1 - t) * (1 - t));
    };
    EXPECT_LE(worst_excess(render(GetParam(), shot), fraction, {.0099, .0144}), 0);
}

TEST_P(Motion, EqualKnotsAreTheStaticPicture) {
    Shot moving, still;
    moving.grids.push_back(moving_rectangle(2.3f, 3.7f, 11.2f, 12.9f, 5, 0, 0, 9, 9));
    still.grids.push_back(rectangle(2.3f, 3.7f, 11.2f, 12.9f, 5, 9, 9));
    const Picture a = render(GetParam(), moving), b = render(GetParam(), still);
    for (std::size_t i = 0; i < a.combined.size(); ++i) EXPECT_EQ(a.combined[i], b.combined[i]);
    EXPECT_EQ(still.statistics.get(Counter::SampleTestsMoving), 0u);
    EXPECT_EQ(moving.statistics.get(Counter::SampleTestsStatic), 0u);
}

}  // namespace
}  // namespace granita::test
