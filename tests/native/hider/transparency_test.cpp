// SPDX-License-Identifier: GPL-3.0-or-later
// Layers: hard cases 35 to 46, as far as they are the hider's.
#include <algorithm>
#include <numeric>
#include <random>

#include "executor_test.h"

namespace granita::test {
namespace {

class Transparency : public ExecutorTest {};
GRANITA_ALL_EXECUTORS(Transparency);
class StoredDepth : public ExecutorTest {};
GRANITA_STORING_EXECUTORS(StoredDepth);

Grid layer(float z, const Vec3f& color, const Vec3f& opacity) {
    Grid grid = rectangle(-1, -1, 17, 17, z, 3, 3);
    set_color(grid, color, opacity);
    return grid;
}

TEST_P(Transparency, ManyEqualLayers) {
    for (const auto& [n, alpha, expected] :
         {std::tuple{128, 1.0f / 128, .6335623}, std::tuple{1000, .001f, .6323046}}) {
        Shot shot;
        shot.options.samples = 1;
        std::vector<int> order(n);
        std::iota(order.begin(), order.end(), 0);
        std::shuffle(order.begin(), order.end(), std::mt19937(1));
        double red = 0;
        for (int i = 0; i < n; ++i)
            red += alpha * std::pow(1 - static_cast<double>(alpha), i) * (i % 2 ? 0.0 : 1.0);
        for (const int i : order)
            shot.grids.push_back(layer(5 + .01f * static_cast<float>(i),
                                       Vec3f(i % 2 ? 0.0f : 1.0f, 1, 1), Vec3f(alpha)));
        const Picture p = render(GetParam(), shot);
        // OpenGL adds the layers in float: half an ulp of 1 each, at most.
        const double error = GetParam() == raster_executor ? n * 0x1p-25 : 2e-7;
        for (const Vec4f& c : p.combined) {
            EXPECT_WITHIN(c.w, expected, error);
            EXPECT_WITHIN(c.x, red, error);
            EXPECT_WITHIN(c.y, expected, error);
        }
    }
}

TEST_P(Transparency, ExtremeOpacities) {
    const auto alpha_of = [&](float opacity) {
        Shot shot;
        shot.options.samples = 4;
        shot.grids.push_back(layer(5, Vec3f(0), Vec3f(opacity)));
        return render(GetParam(), shot).alpha(8, 8);
    };
    EXPECT_EQ(alpha_of(0), 0.0f);
    EXPECT_WITHIN(alpha_of(1e-7f), 1e-7, 1e-13);
    EXPECT_EQ(alpha_of(1 - 1e-7f), 1 - 1e-7f);
    EXPECT_EQ(alpha_of(1), 1.0f);
    EXPECT_EQ(alpha_of(1.5f), 1.0f);
    EXPECT_EQ(alpha_of(-.5f), 0.0f);
    EXPECT_EQ(alpha_of(std::numeric_limits<float>::quiet_NaN()), 0.0f);
}

TEST(Composite, MillionLayersOfAMillionth) {
    const Grid grid = layer(5, Vec3f(2, 1, 0), Vec3f(1e-6f));
    GridPool pool;
    pool.add(grid);
    TileSamples samples;
    Options options;
    options.samples = 1;
    SampleTable(options, pixel_camera()).fill_tile({0, 0}, {}, samples);
    TileStore store;
    store.key.assign(256, -INFINITY);
    store.id.assign(256, kNoSurface);
    Arena memory;
    store.lists.prepare(256, memory);
    for (int i = 0; i < 1000000; ++i) store.lists.add(77, {-5, 4, 0.25f, 0.25f, false});
    LayerTable table(pool, std::vector<bool>(pool.size(), true));
    CompositeSettings settings;
    settings.projection = pixel_camera().projection;
    const Vec3f background(1);
    SampleColors colors;
    composite_tile(store, samples, table, std::span(&background, 1), settings, colors);
    const double a = 1e-6f, t = std::exp(1e6 * std::log1p(-a));
    EXPECT_WITHIN(colors[77].color.x, 2 * (1 - t) + t, 1e-6);
    EXPECT_WITHIN(colors[77].color.z, t, 1e-6);
    EXPECT_EQ(colors[77].alpha, 1.0f);
    settings.film_transparent = true;
    composite_tile(store, samples, table, {}, settings, colors);
    EXPECT_WITHIN(colors[77].alpha, 1 - t, 1e-6);
}

TEST_P(Transparency, ThresholdEndsTheListAfterTheFragmentThatReachesIt) {
    Shot shot;
    shot.options.samples = 4;
    for (int i = 7; i >= 0; --i)
        shot.grids.push_back(layer(5 + static_cast<float>(i), Vec3f(1), Vec3f(.1f)));
    shot.composite.end.opacity_threshold = .2f;  // after two layers .19, after three .271
    EXPECT_WITHIN(render(GetParam(), shot).alpha(3, 3), .271, 1e-6);
    shot.composite.end.opacity_threshold = 1;
    EXPECT_WITHIN(render(GetParam(), shot).alpha(3, 3), 1 - std::pow(.9, 8), 1e-6);
    // The smallest channel decides.
    for (Grid& grid : shot.grids) set_color(grid, Vec3f(1), Vec3f(.5f, .1f, .1f));
    shot.composite.end.opacity_threshold = .2f;
    EXPECT_WITHIN(render(GetParam(), shot).at(3, 3).y, .271, 1e-6);
}

TEST_P(Transparency, SpectralOpacityIsAProductPerChannel) {
    Shot shot;
    shot.options.samples = 4;
    shot.grids.push_back(layer(5, Vec3f(0), Vec3f(.2f, .5f, 0)));
    shot.grids.push_back(layer(6, Vec3f(0), Vec3f(.3f, 1, .7f)));
    shot.background = Vec3f(1);
    shot.composite.film_transparent = false;
    const Vec4f p = render(GetParam(), shot).at(5, 5);
    EXPECT_WITHIN(p.x, .8 * .7, 1e-6);
    EXPECT_WITHIN(p.y, 0, 1e-6);
    EXPECT_WITHIN(p.z, .3, 1e-6);
    EXPECT_EQ(p.w, 1.0f);
    shot.composite.film_transparent = true;
    EXPECT_WITHIN(render(GetParam(), shot).alpha(5, 5), (.44 + 1 + .7) / 3, 1e-6);
}

TEST_P(Transparency, InterpenetratingPlanesSwapAtTheirLine) {
    const auto plane = [](float slope, float z0, float dz) {
        return make_grid(4, 4, dz == 0 ? 1 : 2, [=](float u, float v, int k) {
            const float x = -1 + 18 * u;
            return Vec3f(x, -1 + 18 * v, z0 + slope * x + dz * static_cast<float>(k));
        });
    };
    Shot shot;  // z = 10 + x and z = 20 - x: equal at x = 5
    shot.grids.push_back(plane(1, 10, 0));
    shot.grids.push_back(plane(-1, 20, 0));
    set_color(shot.grids[0], Vec3f(1, 0, 0), Vec3f(.5f));
    set_color(shot.grids[1], Vec3f(0, 1, 0), Vec3f(.5f));
    Picture p = render(GetParam(), shot);
    for (int x = 0; x < 16; ++x) {
        EXPECT_WITHIN(p.at(x, 7).x, x < 5 ? .5 : .25, 1e-6) << x;
        EXPECT_WITHIN(p.at(x, 7).y, x < 5 ? .25 : .5, 1e-6) << x;
    }
    // The second recedes by 4 during the shutter: the line runs from 5 to 7.
    shot.grids[1] = plane(-1, 20, 4);
    set_color(shot.grids[1], Vec3f(0, 1, 0), Vec3f(.5f));
    p = render(GetParam(), shot);
    constexpr double kPixelError = .0153;  // docs/sampling_error.md, of a pixel that it crosses
    for (const auto& [x, first_in_front] : {std::pair{4, 1.0}, {5, .75}, {6, .25}, {7, 0.0}}) {
        double column = 0;
        for (int y = 0; y < 16; ++y) column += p.at(x, y).x / 16;
        EXPECT_WITHIN(column, .25 + .25 * first_in_front,
                      (x == 5 || x == 6 ? .25 * 4 * kPixelError / std::sqrt(16) : 0) + 1e-6);
    }
}

TEST_P(Transparency, CoincidentLayersBothCount) {
    Shot shot;
    shot.options.samples = 16;
    shot.grids.push_back(layer(5, Vec3f(1), Vec3f(.3f)));
    shot.grids.push_back(layer(5, Vec3f(1), Vec3f(.6f)));
    for (const Vec4f& c : render(GetParam(), shot).combined) EXPECT_WITHIN(c.w, 1 - .7 * .4, 1e-6);
}

TEST_P(Transparency, CoincidentOpaqueSurfacesHaveOneWinner) {
    Shot shot;
    for (int i = 0; i < 3; ++i) {
        shot.grids.push_back(rectangle(-1, -1, 17, 17, 5, 3 + 2 * i, 4 + i));
        set_color(shot.grids[i], Vec3f(static_cast<float>(i)));
    }
    shot.grids[1].key.instance = 0;
    shot.grids[0].key.instance = 7;
    shot.grids[2].key.instance = 9;
    for (const Vec4f& c : render(GetParam(), shot).combined) EXPECT_EQ(c, Vec4f(1, 1, 1, 1));
    std::swap(shot.grids[0], shot.grids[2]);
    std::swap(shot.grids[0], shot.grids[1]);
    for (const Vec4f& c : render(GetParam(), shot).combined) EXPECT_EQ(c, Vec4f(1, 1, 1, 1));
}

TEST_P(Transparency, LayersCorrelatedInTime) {
    // At pixel 8: a = .5 during [.2, .6] and a = .7 during [.1, .6]: T = .59, not .52.
    Shot shot;
    shot.options.samples = 256;
    const auto crossing = [](float from, float to, float z, float opacity) {
        Grid grid = moving_rectangle(8 - 10 * to, -2, 8 - 10 * from, 18, z, 10, 0, 5, 18);
        set_color(grid, Vec3f(1), Vec3f(opacity));
        return grid;
    };
    shot.grids.push_back(crossing(.2f, .6f, 5, .5f));
    shot.grids.push_back(crossing(.1f, .6f, 6, .7f));
    const Picture p = render(GetParam(), shot);
    double column = 0;
    for (int y = 0; y < 16; ++y) column += p.alpha(8, y) / 16;
    // Four times the error of the mean of 16 pixels (docs/sampling_error.md): tells .59 from .52.
    EXPECT_WITHIN(column, 1 - .59, 4 * .0046 / std::sqrt(16));
}

TEST_P(Transparency, DicedSphereHasNoSeams) {
    const float a = .3f;
    Shot shot;
    shot.grids.push_back(make_grid(48, 24, 1, [](float u, float v, int) {
        const int side = static_cast<int>(std::lround(u * 48)) % 48;
        const double phi = 2 * M_PI * side / 48, theta = M_PI * v;
        const double ring = v == 0 || v == 1 ? 0 : std::sin(theta);
        return Vec3f(8 + 7 * ring * std::cos(phi), 8 + 7 * ring * std::sin(phi),
                     20 + 7 * std::cos(theta));
    }));
    set_color(shot.grids[0], Vec3f(1), Vec3f(a));
    const Picture p = render(GetParam(), shot);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            if (std::hypot(x + .5 - 8, y + .5 - 8) < 6) {
                EXPECT_WITHIN(p.alpha(x, y), 1 - (1 - a) * (1 - a), 1e-6);
            }
}

TEST_P(Transparency, WhatIsHiddenHasNoEffect) {
    Shot shot;
    shot.grids.push_back(rectangle(2, 2, 13, 13, 5, 8, 8));
    shot.grids.push_back(layer(3, Vec3f(.2f, 1, 0), Vec3f(.4f)));
    const Picture before = render(GetParam(), shot);
    shot.grids.insert(shot.grids.begin(), rectangle(3, 3, 12, 12, 9, 5, 5));  // hidden
    shot.grids.push_back(rectangle(3, 3, 12, 12, 7, 5, 5));                   // hidden
    set_color(shot.grids.back(), Vec3f(5), Vec3f(.5f));
    shot.grids.push_back(rectangle(300, 3, 312, 12, 2, 5, 5));  // elsewhere
    shot.grids.push_back(layer(1, Vec3f(1), Vec3f(0)));         // clear
    const Picture after = render(GetParam(), shot);
    for (std::size_t i = 0; i < before.combined.size(); ++i)
        EXPECT_EQ(before.combined[i], after.combined[i]);
}

TEST_P(Transparency, AdditiveLayersShineThroughClearOnes) {
    Shot shot;
    shot.grids.push_back(rectangle(-1, -1, 17, 17, 9, 4, 4));
    shot.grids.push_back(layer(5, Vec3f(1), Vec3f(0)));
    shot.grids[1].radiance.assign(16, Vec3f(.25f));
    shot.grids[1].additive = true;
    EXPECT_EQ(render(GetParam(), shot).at(8, 8), Vec4f(1.25f, 1.25f, 1.25f, 1));
}

TEST_P(Transparency, HoldoutCutsAlpha) {
    Shot shot;
    shot.background = Vec3f(4);
    shot.grids.push_back(rectangle(-1, -1, 8, 17, 5, 4, 4));
    shot.grids[0].holdout = true;
    shot.grids.push_back(rectangle(-1, -1, 12, 17, 6, 4, 4));
    Picture p = render(GetParam(), shot);
    EXPECT_EQ(p.at(4, 8), Vec4f(0));
    EXPECT_EQ(p.at(10, 8), Vec4f(1));
    EXPECT_EQ(p.at(14, 8), Vec4f(0));
    shot.composite.film_transparent = false;
    p = render(GetParam(), shot);
    EXPECT_EQ(p.at(4, 8), Vec4f(0));
    EXPECT_EQ(p.at(10, 8), Vec4f(1));
    EXPECT_EQ(p.at(14, 8), Vec4f(4, 4, 4, 1));
}

TEST_P(Transparency, MixedGridsAreClassifiedByMicropolygon) {
    // Left half opaque, right half clear, one micropolygon column in between.
    Shot shot;
    shot.grids.push_back(rectangle(0, 0, 16, 16, 5, 4, 4));
    Grid& grid = shot.grids[0];
    set_color(grid, Vec3f(1), Vec3f(.5f));
    for (int v = 0; v < grid.vertex_count(); ++v) grid.opacity[v] = Vec3f(v % 5 <= 2 ? 1.0f : 0.0f);
    const Picture p = render(GetParam(), shot);
    EXPECT_EQ(p.alpha(3, 3), 1.0f);
    EXPECT_EQ(p.alpha(14, 3), 0.0f);
    for (int x = 8; x < 12; ++x) {
        double column = 0;
        for (int y = 0; y < 16; ++y) column += p.alpha(x, y) / 16;
        // Linear from 1 at x = 8 to 0 at x = 12; of x each 64th of a pixel has one sample, and the
        // pixels of a block share a sequence, so a column may err as one pixel.
        EXPECT_WITHIN(column, 1 - (x + .5 - 8) / 4, 4 * .25 / 64 / std::sqrt(12 * 64));
    }
    EXPECT_LT(shot.statistics.get(Counter::FragmentsStored), 4u * 17 * 64 * 4);
}

TEST_P(StoredDepth, IsThatOfTheNearestSurface) {
    Shot shot;
    shot.camera = pinhole_camera(10);
    shot.grids.push_back(rectangle(-9, -9, 99, 99, 8, 3, 3));
    shot.grids.push_back(rectangle(-9, -9, 99, 99, 4, 3, 3));
    set_color(shot.grids[1], Vec3f(1), Vec3f(.1f));
    const SampleTable table(shot.options, shot.camera);
    const HiderFrame frame{&table, shot.camera.projection};
    const auto hider = GetParam()(frame, {0, 0, 1, 1}, {0, 0, 16, 16});
    for (const Grid& grid : shot.grids) hider->hide(grid);
    shot.composite.projection = shot.camera.projection;
    const TileStore& store = hider->finish()[0];
    SampleColors colors;
    LayerTable layers(hider->pool(), hider->seen_grids());
    composite_tile(store, hider->tile_samples(0), layers, {}, shot.composite, colors);
    for (const float depth : colors.depth) EXPECT_EQ(depth, 4.0f);
}

}  // namespace
}  // namespace granita::test
