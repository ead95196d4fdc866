// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases 1 and 2: the numbers of the filters, from tables made independently of this code.
#include "film/filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "film/filter_samples.h"
#include "measured.h"

namespace granita {
namespace {

struct Case {
    FilterKind kind;
    float width, radius;
    double response[6];  ///< E(d) at d = .25, .5, .75, 1, 1.5, 2
    double variance;
    double square;  ///< integral of f^2
};

const Case kCases[] = {
    {FilterKind::Box, 1, .5f, {.75, 1, 1, 1, 1, 1}, .0833, 1},
    {FilterKind::Box, 2, 1, {.625, .75, .875, 1, 1, 1}, .3333, .5},
    {FilterKind::Tent, 2, 1, {.7188, .8750, .9688, 1, 1, 1}, .1667, .667},
    {FilterKind::Gaussian, 1.5f, 2.25f, {.7475, .9088, .9772, .9962, 1, 1}, .1406, .752},
    {FilterKind::BlackmanHarris, 1.5f, 1.5f, {.7205, .8814, .9649, .9938, 1, 1}, .1727, .668},
    {FilterKind::Mitchell, 4, 2, {.7129, .8793, .9777, 1.0139, 1.0078, 1}, .1111, .682},
    {FilterKind::CatmullRom, 4, 2, {.7384, .9193, 1.0171, 1.0417, 1.0130, 1}, 0, .814},
    {FilterKind::Bspline, 4, 2, {.6619, .7995, .8989, .9583, .9974, 1}, .3333, .479},
    {FilterKind::Lanczos, 6, 3, {.7414, .9317, 1.0416, 1.0731, 1.0175, .9834}, 0, .894},
};

TEST(PixelFilter, EdgeResponses) {
    const double at[6] = {.25, .5, .75, 1, 1.5, 2};
    for (const Case& c : kCases) {
        const PixelFilter filter(c.kind, c.width);
        EXPECT_EQ(filter.radius(), c.radius);
        for (int i = 0; i < 6; ++i) {
            // The table has four digits.
            EXPECT_WITHIN(filter.edge_response(at[i]), c.response[i], 6e-5)
                << static_cast<int>(c.kind) << " at " << at[i];
            EXPECT_WITHIN(filter.edge_response(-at[i]), 1 - c.response[i], 6e-5);
        }
    }
}

TEST(PixelFilter, PiecesAreTheFilter) {
    // One sample in sixteen: what a pixel of the tile gives to itself and its neighbours in the row
    // is that sample's weight, f(dx) f(dy).  Odd widths put the filter's end and knots anywhere.
    for (const float scale : {1.0f, .73f, 2.9f})
        for (const Case& c : kCases) {
            const PixelFilter filter(c.kind, c.width * scale);
            const FilterPieces pieces(filter);
            const int each_side = static_cast<int>(std::ceil(filter.radius()));
            const double peak = filter.evaluate(0) * filter.evaluate(0);
            constexpr int kPixels = kTileSize * kTileSize, kRow = 5;
            TileSamples samples;
            samples.samples = 1;
            samples.x.resize(kPixels);
            samples.y.resize(kPixels);
            for (int step = 0; step < 1000; ++step) {
                const int pixel = step % kTileSize;
                SampleColors colors(kPixels);
                const auto sample = static_cast<std::size_t>(kRow * kTileSize + pixel);
                colors.red[sample] = 1.0f;
                samples.x[sample] = static_cast<float>(pixel) + static_cast<float>(step) / 1000;
                samples.y[sample] = kRow + static_cast<float>(step * 7 % 1000) / 1000;
                TileSums sums(each_side, 0);
                filter_samples(pieces, samples, colors, nullptr, kRow, kRow + 1, sums);
                for (int tap = -each_side; tap <= each_side; ++tap) {
                    const float dx = samples.x[sample] - (static_cast<float>(pixel + tap) + .5f);
                    const double expected = static_cast<double>(filter.evaluate(dx)) *
                                            filter.evaluate(samples.y[sample] - (kRow + .5f));
                    const int at = (kRow + each_side) * sums.side + pixel + tap + each_side;
                    ASSERT_NEAR(sums.plane(TileSums::kRed)[at], expected, 2e-6 * peak)
                        << static_cast<int>(c.kind) << " width " << c.width * scale << " at " << dx;
                }
            }
        }
}

TEST(PixelFilter, IntegralVarianceAndEnergy) {
    for (const Case& c : kCases) {
        const PixelFilter filter(c.kind, c.width);
        double sum = 0, second = 0, square = 0;
        const int n = 60000;
        const double h = 2.0 * c.radius / n;
        for (int i = 0; i < n; ++i) {
            const double d = -c.radius + (i + .5) * h, f = filter.evaluate(static_cast<float>(d));
            sum += f * h;
            second += f * d * d * h;
            square += f * f * h;
        }
        EXPECT_WITHIN(sum, 1, 1e-5) << static_cast<int>(c.kind);
        EXPECT_WITHIN(square, c.square, 6e-4) << static_cast<int>(c.kind);
        // Lanczos' variance is given as 0 to two digits.
        EXPECT_WITHIN(second, c.variance, c.kind == FilterKind::Lanczos ? 2e-2 : 1e-4)
            << static_cast<int>(c.kind);
    }
}

TEST(PixelFilter, Overshoot) {
    const PixelFilter catmull(FilterKind::CatmullRom, 4), mitchell(FilterKind::Mitchell, 4);
    EXPECT_WITHIN(catmull.edge_response(1) - 1, 1.0 / 24, 1e-7);
    EXPECT_WITHIN(mitchell.edge_response(1.143) - 1, .0175, 5e-5);
}

TEST(PixelFilter, WidthScales) {
    for (const Case& c : kCases) {
        const PixelFilter one(c.kind, c.width), three(c.kind, 3 * c.width);
        EXPECT_FLOAT_EQ(three.radius(), 3 * one.radius());
        for (const double d : {.1, .4, .9}) {
            EXPECT_WITHIN(three.edge_response(3 * d), one.edge_response(d), 1e-9);
            EXPECT_WITHIN(three.evaluate(static_cast<float>(3 * d)),
                          one.evaluate(static_cast<float>(d)) / 3, 1e-6);
        }
        EXPECT_EQ(one.evaluate(c.radius * 1.001f), 0.0f);
    }
}

TEST(PixelFilter, PartitionOfUnity) {
    for (const auto& [kind, width] : {std::pair{FilterKind::Box, 1.0f},
                                      {FilterKind::Tent, 2.0f},
                                      {FilterKind::Mitchell, 4.0f},
                                      {FilterKind::CatmullRom, 4.0f},
                                      {FilterKind::Bspline, 4.0f}}) {
        const PixelFilter filter(kind, width);
        for (float x = -.5f; x < .5f; x += .01f) {
            double sum = 0;
            for (int i = -3; i <= 3; ++i) sum += filter.evaluate(x + static_cast<float>(i));
            EXPECT_WITHIN(sum, 1, 1e-6);
        }
    }
}

TEST(PixelFilter, RefusesImpossibleWidths) {
    for (const float width : {0.0f, -1.0f, std::nanf(""), INFINITY, 1000.0f})
        EXPECT_THROW(PixelFilter(FilterKind::Box, width), SceneError);
}

}  // namespace
}  // namespace granita
