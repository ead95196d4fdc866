// SPDX-License-Identifier: GPL-3.0-or-later
// Channels of samples: layers mixed like colours, the first surface, the pixel's centre.
#include "hider/resolve/sample_channels.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "hider/grid_builder.h"

namespace granita {
namespace {

/// Emission, Normal and Object Index of one pixel's samples under fragments of grids 1 x 1.
struct Stack {
    Options options;
    GridPool pool;
    std::vector<Grid> grids;
    TileSamples samples;
    Arena memory;
    TileStore store;
    CompositeSettings settings;
    SampleChannels values;

    Stack() {
        options.samples = 1;
        options.passes = {"Emission", "Normal", "Object Index"};
        grids.reserve(8);
        settings.projection = test::pixel_camera().projection;
        settings.film_transparent = true;
        SampleTable(options, test::pixel_camera()).fill_tile({0, 0}, {}, samples);
        store.key.assign(256, -INFINITY);
        store.id.assign(256, kNoSurface);
    }
    SurfaceId add(float z, const Vec3f& emission, const Vec3f& opacity, float index) {
        Grid grid = test::rectangle(0, 0, 16, 16, z, 1, 1);
        test::set_color(grid, Vec3f(1), opacity);
        for (int v = 0; v < 4; ++v)
            for (const float x : {emission.x, emission.y, emission.z, index, 0.0f, -1.0f, index})
                grid.channels.push_back(x);
        grids.push_back(std::move(grid));
        return pool.add(grids.back());
    }
    /// The list of sample 77, nearest first.
    void layers(const std::vector<Fragment>& list) {
        store.lists.prepare(256, memory);
        store.lists.clear();
        for (const Fragment& fragment : list) store.lists.add(77, fragment);
    }
    void run() {
        const ChannelSet channels(options);
        ASSERT_EQ(channels.vertex_width(), 7);
        settings.channels = &channels;
        SampleColors colors;
        LayerTable table(pool, std::vector<bool>(pool.size(), true));
        composite_tile(store, samples, table, {}, settings, colors, &values);
    }
    const float* row(int sample) const { return &values.filtered[sample * 6]; }
};

TEST(SampleChannels, LayersAreAttenuatedByWhatIsBeforeThem) {
    Stack stack;
    const SurfaceId pane = stack.add(2, Vec3f(1, 2, 3), Vec3f(0.25f, 0.5f, 1.0f), 4);
    const SurfaceId wall = stack.add(3, Vec3f(8, 8, 8), Vec3f(1), 9);
    stack.layers({{-2, pane, 0, 0, false}});
    stack.store.key[77] = stack.store.key[78] = -3;
    stack.store.id[77] = stack.store.id[78] = wall;
    stack.run();
    EXPECT_FLOAT_EQ(stack.row(77)[0], 1 + 0.75f * 8);
    EXPECT_FLOAT_EQ(stack.row(77)[1], 2 + 0.5f * 8);
    EXPECT_FLOAT_EQ(stack.row(77)[2], 3);
    EXPECT_FLOAT_EQ(stack.row(78)[0], 8);
    EXPECT_EQ(stack.values.center[77], 4);
    EXPECT_EQ(stack.values.center[78], 9);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(stack.row(79)[k], 0);
}

TEST(SampleChannels, TheFirstSurfaceIsTheFirstThatIsOpaqueEnough) {
    Stack stack;
    const SurfaceId pane = stack.add(2, Vec3f(1), Vec3f(0.25f), 4);
    const SurfaceId wall = stack.add(3, Vec3f(8), Vec3f(1), 9);
    stack.layers({{-2, pane, 0, 0, false}});
    stack.store.key[77] = -3;
    stack.store.id[77] = wall;
    for (const float threshold : {0.0f, 0.25f, 0.26f, 1.0f}) {
        stack.settings.end.pass_alpha_threshold = threshold;
        stack.run();
        const float index = threshold > 0.25f ? 9 : 4;
        EXPECT_FLOAT_EQ(stack.row(77)[3], index);
        EXPECT_EQ(stack.values.center[77], index);
    }
}

TEST(SampleChannels, AListThatHasEndedStillFindsTheFirstSurface) {
    Stack stack;
    const SurfaceId panes[] = {stack.add(2, Vec3f(1), Vec3f(0.4f), 4),
                               stack.add(3, Vec3f(1), Vec3f(0.4f), 5)};
    const SurfaceId wall = stack.add(4, Vec3f(8), Vec3f(1), 9);
    stack.layers({{-2, panes[0], 0, 0, false}, {-3, panes[1], 0, 0, false}});
    stack.store.key[77] = -4;
    stack.store.id[77] = wall;
    stack.settings.end.opacity_threshold = 0.6f;
    stack.settings.end.pass_alpha_threshold = 0.5f;
    stack.run();
    EXPECT_FLOAT_EQ(stack.row(77)[0], 1 + 0.6f);
    EXPECT_EQ(stack.values.center[77], 9);
}

TEST(SampleChannels, TheCentreIsTheNearestSample) {
    Options options;
    options.samples = 64;
    TileSamples samples;
    SampleTable(options, test::pixel_camera()).fill_tile({2, 3}, {}, samples);
    const CenterSamples centers = center_samples(samples);
    const auto distance = [&](std::size_t i, int p) {
        return std::hypot(samples.x[i] - (p % 16 + 0.5f), samples.y[i] - (p / 16 + 0.5f));
    };
    for (int p = 0; p < 256; ++p)
        for (int s = 0; s < 64; ++s)
            ASSERT_LE(distance(centers[p], p), distance(p * 64 + s, p) + 1e-6f);
}

TEST(ChannelSet, SharesChannelsAndRefusesWhatItDoesNotKnow) {
    Options options;
    EXPECT_TRUE(ChannelSet(options).empty());
    options.passes = {"Combined", "Depth"};
    EXPECT_TRUE(ChannelSet(options).empty());
    options.passes = {"Diffuse Direct", "Diffuse Color", "Environment"};
    const ChannelSet three(options);
    EXPECT_EQ(three.channels().size(), 3u);
    EXPECT_EQ(three.vertex_width(), 6);
    EXPECT_EQ(three.sample_width(), 9);
    options.passes = {"Ambient Occlusion"};
    EXPECT_THROW(ChannelSet{options}, SceneError);
    options.passes = {"Normal"};
    options.aovs = {{"Normal", true}};
    EXPECT_THROW(ChannelSet{options}, SceneError);
}

}  // namespace
}  // namespace granita
