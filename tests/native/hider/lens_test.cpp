// SPDX-License-Identifier: GPL-3.0-or-later
// Depth of field against closed forms: hard cases 28 to 34.  Orthographic camera with a lens:
// circle of confusion of radius lens_radius |z / focus - 1| pixels.
#include <algorithm>

#include "defocus.h"
#include "executor_test.h"

namespace granita::test {
namespace {

class Lens : public ExecutorTest {};
GRANITA_ALL_EXECUTORS(Lens);

/// An edge out of focus by a circle of 3 pixels, 64 samples (docs/sampling_error.md).
constexpr SamplingError kEdge3{.0161, .0216};

Camera lens_camera(double radius, double focus = 10) {
    Camera camera = pixel_camera();
    camera.projection.lens_radius = radius;
    camera.projection.focus = focus;
    return camera;
}

TEST_P(Lens, SmallSquareSpreadsOverItsDisc) {
    // 2 x 2 pixels at z = 20, focus 10, lens 5: a disc of 5 pixels.
    Shot shot;
    shot.camera = lens_camera(5);
    shot.options.samples = 256;
    shot.tiles = {0, 0, 2, 2};
    shot.grids.push_back(rectangle(15, 15, 17, 17, 20, 2, 2));
    const Picture p = render(GetParam(), shot);
    double i0 = 0, i1 = 0, i2x = 0, i2y = 0;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
            const double a = p.alpha(x, y);
            i0 += a;
            i1 += a * (x + .5);
            i2x += a * (x + .5 - 16) * (x + .5 - 16);
            i2y += a * (y + .5 - 16) * (y + .5 - 16);
        }
    // Four times what is predicted of Owen-scrambled samples (docs/sampling_error.md).
    const double disc = M_PI * 25, p0 = 4 / disc;
    EXPECT_WITHIN(i0, 4, 4 * .069);
    EXPECT_WITHIN(i1 / i0, 16, 4 * .056);
    // Disc R^2 / 4, the square 2^2 / 12, the pixel 1 / 12.
    EXPECT_WITHIN(i2x / i0, 25.0 / 4 + 4.0 / 12 + 1.0 / 12, 4 * .125);
    EXPECT_WITHIN(i2y / i0, 25.0 / 4 + 4.0 / 12 + 1.0 / 12, 4 * .125);
    double middle = 0;  // well inside the disc it is flat
    for (int y = 14; y < 18; ++y)
        for (int x = 14; x < 18; ++x) middle += p.alpha(x, y) / 16;
    EXPECT_WITHIN(middle, p0, 4 * .0020);
}

TEST_P(Lens, PolygonalBokehHasThePolygonsArea) {
    Shot shot;
    shot.camera = lens_camera(5);
    shot.camera.blades = 6;
    shot.options.samples = 256;
    shot.tiles = {0, 0, 2, 2};
    shot.grids.push_back(rectangle(15, 15, 17, 17, 20, 2, 2));
    const Picture p = render(GetParam(), shot);
    const double area = 3 * std::sin(M_PI / 3) * 25, p0 = 4 / area;
    double middle = 0;
    for (int y = 14; y < 18; ++y)
        for (int x = 14; x < 18; ++x) middle += p.alpha(x, y) / 16;
    // As of the disc, by the root of what is covered: 4 / 65 for 4 / 79.
    EXPECT_WITHIN(middle, p0, 4 * .0022);
}

TEST_P(Lens, DefocusedEdge) {
    ASSERT_NEAR(edge_in_disc(1.2, 3), .74768, 1e-5);
    for (const float z : {4.0f, 20.0f}) {  // before and behind the focus
        Shot shot;
        shot.camera = lens_camera(3 / std::fabs(z / 10 - 1));
        shot.grids.push_back(rectangle(-40, -40, 8, 60, z, 24, 50));
        const auto alpha = [](double x, double) { return edge_in_disc(8 - x, 3); };
        EXPECT_LE(worst_excess(render(GetParam(), shot), alpha, kEdge3), 0) << z;
    }
}

TEST_P(Lens, SharpBackgroundBehindADefocusedEdge) {
    // Background at the focus: a step of 1 to 3 at x = 10; in front a black edge at x = 8 with a
    // disc of 3.  C = (1 - a) B with B sharp.
    Shot shot;
    shot.options.samples = 256;
    shot.camera = lens_camera(3 / .5);
    shot.grids.push_back(rectangle(-40, -40, 10, 60, 10, 25, 50));
    shot.grids.push_back(rectangle(10, -40, 60, 60, 10, 25, 50));
    set_color(shot.grids[1], Vec3f(3));
    shot.grids.push_back(rectangle(-40, -40, 8, 60, 5, 24, 50));
    set_color(shot.grids[2], Vec3f(0));
    const Picture p = render(GetParam(), shot);
    for (int x = 0; x < 16; ++x) {
        double column = 0;
        for (int y = 0; y < 16; ++y) column += p.at(x, y).x / 16;
        const double a =
            pixel_mean([](double px, double) { return edge_in_disc(8 - px, 3); }, x, 0);
        const double b = x < 10 ? 1 : 3;
        // The mean of 16 pixels of DefocusedEdge with 256 samples, of which the worst errs by
        // .0083.
        EXPECT_WITHIN(column, (1 - a) * b, b * 4 * .0083 / 4) << x;
        for (int y = 0; y < 16; ++y) EXPECT_EQ(p.alpha(x, y), 1.0f);
    }
}

TEST_P(Lens, InFocusIsThePinholePicture) {
    Shot sharp, blurred;
    blurred.camera = lens_camera(3);
    sharp.grids.push_back(rectangle(2.3f, 3.7f, 11.2f, 12.9f, 10, 9, 9));
    blurred.grids = sharp.grids;
    const Picture a = render(GetParam(), sharp), b = render(GetParam(), blurred);
    for (std::size_t i = 0; i < a.combined.size(); ++i) EXPECT_EQ(a.combined[i], b.combined[i]);
}

TEST_P(Lens, SurfaceThroughTheFocus) {
    // z = 10 + x/4 around the focus: tiled and closed, so every sample once, whatever its disc.
    Shot shot;
    shot.options.samples = 16;
    shot.camera = lens_camera(4);
    shot.grids.push_back(make_grid(96, 96, 1, [](float u, float v, int) {
        return Vec3f(-24 + 64 * u, -24 + 64 * v, 10 + .25f * (-24 + 64 * u - 8));
    }));
    set_color(shot.grids[0], Vec3f(1), Vec3f(.5f));
    for (const int layers : layers_per_sample(GetParam(), shot)) ASSERT_EQ(layers, 1);
}

TEST_P(Lens, DefocusAndMotionTogether) {
    // A defocused edge that moves by 8: the disc's edge response averaged over the path.
    Shot shot;
    shot.camera = lens_camera(3);
    shot.grids.push_back(moving_rectangle(-40, -40, 4, 60, 20, 8, 0, 22, 50));
    const auto alpha = [](double x, double) {
        double sum = 0;
        for (int i = 0; i < 32; ++i) sum += edge_in_disc(4 + 8 * (i + .5) / 32 - x, 3) / 32;
        return sum;
    };
    EXPECT_LE(worst_excess(render(GetParam(), shot), alpha, {.0166, .0269}), 0);
}

TEST_P(Lens, PerspectiveCircleOfConfusion) {
    // Radius in pixels: f lens |z - focus| / (z focus) (Potmesil and Chakravarty).
    Shot shot;
    shot.camera = pinhole_camera(100);
    shot.camera.projection.lens_radius = .3;
    shot.camera.projection.focus = 5;
    const double radius = 100 * .3 * (10 - 5) / (10.0 * 5);
    shot.grids.push_back(rectangle(-4, -4, .8f, 6, 10, 40, 40));  // edge at pixel 8
    const auto alpha = [=](double x, double) { return edge_in_disc(8 - x, radius); };
    EXPECT_LE(worst_excess(render(GetParam(), shot), alpha, kEdge3), 0);
}

}  // namespace
}  // namespace granita::test
