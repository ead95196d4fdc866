// SPDX-License-Identifier: GPL-3.0-or-later
// The filter on the device against closed forms (docs/hard_cases.md, cases 1, 2, 5, 8).
#include <gtest/gtest.h>

#include <numbers>

#include "base/error.h"
#include "raster_scene.h"

namespace granita::raster_test {
namespace {

constexpr int kLattice = 16;
using std::numbers::pi;

struct FilterCase {
    const char* name;
    double radius;
    double (*factor)(double);
    /// E(d) at d = .25, .5, .75, 1, 1.5, 2 (docs/sampling_error.md, four digits).
    double response[6];
};

double box1(double d) {
    return std::abs(d) <= 0.5 ? 1.0 : 0.0;
}
double box2(double d) {
    return std::abs(d) <= 1.0 ? 0.5 : 0.0;
}
double tent2(double d) {
    return std::max(0.0, 1.0 - std::abs(d));
}
double cycles_gaussian(double d) {
    return std::abs(d) <= 2.25 ? std::exp(-8.0 * d * d / 2.25) : 0;
}
double blackman_harris(double d) {
    const double x = (d + 1.5) / 3.0;
    if (x < 0.0 || x > 1.0) return 0.0;
    return 0.35875 - 0.48829 * std::cos(2 * pi * x) + 0.14128 * std::cos(4 * pi * x) -
           0.01168 * std::cos(6 * pi * x);
}
double catmull_rom(double d) {
    const double x = std::abs(d);
    if (x >= 2.0) return 0.0;
    return x < 1.0 ? 1.5 * x * x * x - 2.5 * x * x + 1.0
                   : -0.5 * x * x * x + 2.5 * x * x - 4.0 * x + 2.0;
}
double bspline(double d) {
    const double x = std::abs(d);
    if (x >= 2.0) return 0.0;
    return x < 1.0 ? 0.5 * x * x * x - x * x + 2.0 / 3.0 : std::pow(2.0 - x, 3) / 6.0;
}
double lanczos3(double d) {
    if (std::abs(d) >= 3.0) return 0.0;
    const auto sinc = [](double x) { return x == 0.0 ? 1.0 : std::sin(pi * x) / (pi * x); };
    return sinc(d) * sinc(d / 3.0);
}

const FilterCase kFilters[] = {
    {"box1", 0.5, box1, {.75, 1, 1, 1, 1, 1}},
    {"box2", 1.0, box2, {.625, .75, .875, 1, 1, 1}},
    {"tent2", 1.0, tent2, {.7188, .8750, .9688, 1, 1, 1}},
    {"cycles_gaussian", 2.25, cycles_gaussian, {.7475, .9088, .9772, .9962, 1, 1}},
    {"blackman_harris", 1.5, blackman_harris, {.7205, .8814, .9649, .9938, 1, 1}},
    {"mitchell", 2.0, mitchell, {.7129, .8793, .9777, 1.0139, 1.0078, 1}},
    {"catmull_rom", 2.0, catmull_rom, {.7384, .9193, 1.0171, 1.0417, 1.0130, 1}},
    {"bspline", 2.0, bspline, {.6619, .7995, .8990, .9583, .9974, 1}},
    {"lanczos3", 3.0, lanczos3, {.7414, .9317, 1.0416, 1.0731, 1.0175, .9834}},
};
constexpr double kDistances[6] = {.25, .5, .75, 1, 1.5, 2};

// The lattice is a midpoint rule of step h = 1/16 with the edge between two sub-samples: its error
// is h^2/24 |f'|, and |f'| < 2 for these filters; the table has four digits.
constexpr double kTolerance = 2.0 / (24.0 * kLattice * kLattice) + 5e-5;

RasterFrame frame_of(const FilterCase& f, Statistics* statistics = nullptr) {
    RasterFrame frame;
    frame.projection = pixel_projection();
    frame.filter = make_raster_filter(kLattice, f.radius, f.factor);
    frame.statistics = statistics;
    return frame;
}

class RasterEdge : public testing::TestWithParam<FilterCase> {};

TEST_P(RasterEdge, response_is_the_closed_form_in_x_and_y) {
    const FilterCase& f = GetParam();
    RasterHider hider(gl_thread(), frame_of(f));
    const Vec3f color(2.0f, -0.5f, 0.25f);
    for (int i = 0; i < 6; ++i)
        for (const bool along_x : {true, false}) {
            const auto edge = static_cast<float>(8.5 + kDistances[i]);
            const Grid grid = make_rectangle(1, -50, -50, along_x ? edge : 50, along_x ? 50 : edge,
                                             1, 1, 1, color);
            const RasterImage image = hider.open({8, 8, 9, 9}, {&grid})->render();
            ASSERT_EQ(image.combined.size(), 1u);
            const Vec4f& pixel = image.combined[0];
            EXPECT_WITHIN(pixel.w, f.response[i], kTolerance) << "d = " << kDistances[i];
            // Colour rings with coverage; weights of up to 96 taps are rounded to floats.
            for (int c = 0; c < 3; ++c) EXPECT_WITHIN(pixel[c], color[c] * pixel.w, 4e-6);
        }
}

INSTANTIATE_TEST_SUITE_P(Filters, RasterEdge, testing::ValuesIn(kFilters),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(RasterResolve, far_from_the_origin_an_edge_has_the_same_bits) {
    // Hard case 8: cell coordinates are subtracted in double.
    RasterHider hider(gl_thread(), frame_of(kFilters[5]));
    const auto at = [&](int x) {
        const Grid grid = make_rectangle(1, x - 40.0f, -10, x + 0.25f, 10, 1);
        return hider.open({x, 0, x + 1, 1}, {&grid})->render().combined[0].w;
    };
    const float near_zero = at(0);
    EXPECT_WITHIN(near_zero, 1.0 - .7129, kTolerance);
    EXPECT_EQ(at(16384), near_zero);
    EXPECT_EQ(at(-16384), near_zero);
}

TEST(RasterResolve, a_filter_wider_than_a_cell_keeps_the_energy) {
    // Hard cases 5 and I0: a B-spline of 96 pixels (a partition of unity at 24, so at 1).
    constexpr double kStretch = 24.0;
    RasterFrame frame;
    frame.projection = pixel_projection();
    frame.filter = make_raster_filter(2, 2.0 * kStretch,
                                      [](double d) { return bspline(d / kStretch) / kStretch; });
    RasterHider hider(gl_thread(), frame);
    const Grid grid = make_rectangle(1, 3, 4, 8, 6, 1);
    const RasterImage image = hider.open({-60, -60, 70, 70}, {&grid})->render();
    double energy = 0.0;
    for (const Vec4f& pixel : image.combined) energy += pixel.w;
    // 10 square pixels; float sums of 192 taps.
    EXPECT_WITHIN(energy, 10.0, 1e-4);
}

TEST(RasterResolve, background_fills_what_nothing_covers) {
    RasterBackground background;
    background.constant = {0.5f, 0.25f, 0.125f, 1.0f};
    RasterHider hider(gl_thread(), frame_of(kFilters[5]));
    const RasterImage image =
        hider.open({0, 0, 5, 3}, std::vector<const Grid*>{})->render(background);
    ASSERT_EQ(image.combined.size(), 15u);
    for (const Vec4f& pixel : image.combined)
        for (int c = 0; c < 4; ++c) EXPECT_WITHIN(pixel[c], background.constant[c], 4e-6);
}

TEST(RasterResolve, a_filter_that_no_target_holds_is_an_error) {
    RasterFrame frame;
    frame.projection = pixel_projection();
    frame.filter = make_raster_filter(64, 2000.0, [](double) { return 1.0; });
    EXPECT_THROW(RasterHider(gl_thread(), frame), GlError);
}

}  // namespace
}  // namespace granita::raster_test
