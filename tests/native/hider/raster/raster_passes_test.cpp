// SPDX-License-Identifier: GPL-3.0-or-later
// The accumulation of passes and the peeling of layers, against closed forms and identities.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "hider/raster/raster_geometry.h"
#include "raster_scene.h"

namespace granita::raster_test {
namespace {

RasterFrame pixel_frame(int lattice, int passes, Statistics* statistics = nullptr) {
    Options options;
    options.sampling = Sampling::Regular;
    options.samples = lattice * lattice;
    options.time_samples = passes;
    RasterFrame frame;
    frame.projection = pixel_projection();
    frame.filter = box_filter(lattice);
    frame.passes = raster_passes(SampleTable(options, Camera{}, {true, false}), {true, false}, {});
    frame.statistics = statistics;
    return frame;
}

bool same_bits(const RasterImage& a, const RasterImage& b) {
    return a.combined.size() == b.combined.size() &&
           std::memcmp(a.combined.data(), b.combined.data(), a.combined.size() * sizeof(Vec4f)) ==
               0;
}

/// Moving, still, opaque and transparent sheets.
std::vector<Grid> mixed_sheets() {
    std::vector<Grid> grids;
    for (std::uint32_t k = 0; k < 8; ++k) {
        const float x = 4.0f * static_cast<float>(k);
        grids.push_back(make_grid(
            k, 6, 6,
            [=](float u, float v) {
                return Vec3f(x + 20 * u, 3 + 25 * v + u, 5 + u * 2 - v + k % 3);
            },
            [](float u, float v) { return Vec3f(u, v, 0.5f); }));
        if (k % 2) set_opacity(grids.back(), Vec3f(0.3f, 0.5f, 0.1f * static_cast<float>(k)));
        if (k % 3) set_motion(grids.back(), {{7, -3, 1}, {2, 4, -1}});
    }
    return grids;
}

TEST(RasterPasses, several_at_once_or_one_after_the_other_are_the_same_bits) {
    // The paper's multibuffer and multipass accumulation (listing 2).
    const std::vector<Grid> grids = mixed_sheets();
    RasterFrame frame = pixel_frame(4, 7);
    frame.most_layers = 1;
    RasterHider multipass(gl_thread(), frame);
    const RasterImage one = multipass.open({0, 0, 48, 32}, pointers(grids))->render();
    for (const int layers : {2, 3, 7}) {
        frame.most_layers = layers;
        Statistics statistics;
        frame.statistics = &statistics;
        RasterHider multibuffer(gl_thread(), frame);
        EXPECT_TRUE(same_bits(one, multibuffer.open({0, 0, 48, 32}, pointers(grids))->render()))
            << layers;
        EXPECT_GT(statistics.get(Counter::GlPrimitives), 0u);
    }
}

TEST(RasterPasses, z_batches_change_no_bit) {
    const std::vector<Grid> grids = mixed_sheets();
    RasterFrame frame = pixel_frame(4, 3);
    frame.opacity_threshold = 0.6f;
    frame.z_batch_size = 1000;
    const RasterImage all =
        RasterHider(gl_thread(), frame).open({0, 0, 48, 32}, pointers(grids))->render();
    for (const int size : {1, 2, 3}) {
        frame.z_batch_size = size;
        RasterHider hider(gl_thread(), frame);
        EXPECT_TRUE(same_bits(all, hider.open({0, 0, 48, 32}, pointers(grids))->render())) << size;
    }
}

TEST(RasterPasses, three_passes_a_layer_are_the_bits_of_one) {
    // Spectral opacity on a device that fills one target at a time (paper, 9.3.4).
    std::vector<Grid> grids = mixed_sheets();
    grids.push_back(make_rectangle(20, 3, 3, 40, 30, 4, 3, 3, Vec3f(0.1f, 0.2f, 0.3f)));
    set_opacity(grids.back(), Vec3f(0.2f, 0.5f, 1.0f));
    grids.push_back(grids.back());  // coincident
    grids.back().key.instance = 21;
    for (const bool perspective : {false, true}) {
        RasterFrame frame = pixel_frame(4, 5);
        if (perspective) frame.projection = perspective_projection(48, 32);
        frame.opacity_threshold = 0.9f;
        const RasterImage one =
            RasterHider(gl_thread(), frame).open({0, 0, 48, 32}, pointers(grids))->render();
        Statistics statistics;
        frame.statistics = &statistics;
        frame.most_targets = 1;
        RasterHider hider(gl_thread(), frame);
        EXPECT_TRUE(same_bits(one, hider.open({0, 0, 48, 32}, pointers(grids))->render()));
        EXPECT_GT(statistics.get(Counter::GlPrimitives), 0u);
    }
}

TEST(RasterPasses, what_does_not_move_costs_one_pass_and_keeps_its_bits) {
    Statistics still, moving;
    std::vector<Grid> grids;
    grids.push_back(make_rectangle(1, 2.3f, 3.1f, 40.7f, 20.9f, 2, 5, 5, Vec3f(0.7f, 0.1f, 0.3f)));
    set_opacity(grids[0], Vec3f(0.37f));
    RasterHider one(gl_thread(), pixel_frame(4, 1, &still));
    const RasterImage expected = one.open({0, 0, 48, 32}, pointers(grids))->render();
    RasterHider many(gl_thread(), pixel_frame(4, 11, &moving));
    EXPECT_TRUE(same_bits(expected, many.open({0, 0, 48, 32}, pointers(grids))->render()));
    EXPECT_EQ(still.get(Counter::GlPasses), moving.get(Counter::GlPasses));

    // Something moving beside it changes no bit of it: a mean of equal values is exact.
    grids.push_back(make_rectangle(2, 50, 0, 52, 30, 3));
    set_motion(grids[1], {{5, 0, 0}});
    const RasterImage beside = many.open({0, 0, 48, 32}, pointers(grids))->render();
    EXPECT_TRUE(same_bits(expected, beside));
}

TEST(RasterPasses, grids_are_not_drawn_at_instants_when_they_touch_nothing) {
    Statistics statistics;
    RasterFrame frame = pixel_frame(1, 8, &statistics);
    frame.most_layers = 4;
    RasterHider hider(gl_thread(), frame);
    // Its left side is at -100 + 180 t, t = 1/16, 3/16...: at 1.25, 23.75 and 46.25 in the cell of
    // 64 pixels, at no other instant.
    Grid grid = make_rectangle(1, -100, 0, -90, 10, 2);
    set_motion(grid, {{180, 0, 0}});
    const RasterImage image = hider.open({0, 0, 64, 64}, {&grid})->render();
    EXPECT_EQ(statistics.get(Counter::GlPrimitives), 6u);
    double alpha = 0.0;
    for (const Vec4f& pixel : image.combined) alpha += pixel.w;
    // Ten by ten pixels' centres.
    EXPECT_WITHIN(alpha, 3 * 100.0 / 8, 1e-4);
}

TEST(RasterPasses, grids_are_not_drawn_at_instants_when_they_are_hidden) {
    // A wall left of 32, and behind it a grid whose right side is at 10 + 48 t: of the instants
    // 1/16, 3/16... it shows at the last four.
    const Grid wall = make_rectangle(1, -5, -5, 32, 70, 2);
    Grid grid = make_rectangle(2, 0, 8, 10, 18, 3);
    set_motion(grid, {{48, 0, 0}});
    for (const int layers : {1, 3, 8}) {
        Statistics statistics;
        RasterFrame frame = pixel_frame(1, 8, &statistics);
        frame.most_layers = layers;
        RasterHider hider(gl_thread(), frame);
        const auto bucket = hider.open({0, 0, 64, 64}, {&wall, &grid});
        EXPECT_EQ(bucket->find_seen(), (std::vector<bool>{true, true}));
        EXPECT_EQ(statistics.get(Counter::GlPrimitives), 2u * 8 + 2u * 8);
        const RasterImage image = bucket->render();
        EXPECT_EQ(statistics.get(Counter::GlPrimitives), 2u * 16 + 2u * 8 + 2u * 4) << layers;
        double alpha = 0.0;
        for (const Vec4f& pixel : image.combined) alpha += pixel.w;
        // Right sides at 37, 43, 49 and 55: 5 and three times 10 columns of 10 pixels.
        EXPECT_WITHIN(alpha, 32 * 64 + (5 + 3 * 10) * 10 / 8.0, 1e-3);
    }
}

TEST(RasterPeel, what_lies_behind_saturated_samples_is_not_seen) {
    std::vector<Grid> grids;
    for (std::uint32_t k = 0; k < 4; ++k) {
        grids.push_back(
            make_rectangle(k, -2, -2, 20, 20, 1.0f + static_cast<float>(k), 1, 1, Vec3f(0.9f)));
        set_opacity(grids.back(), Vec3f(0.9f));
    }
    grids.push_back(make_rectangle(9, -2, -2, 20, 20, 7));
    for (const int batch : {1, 26}) {
        RasterFrame frame = pixel_frame(2, 1);
        frame.opacity_threshold = 0.95f;
        frame.z_batch_size = batch;
        RasterHider hider(gl_thread(), frame);
        const auto bucket = hider.open({0, 0, 16, 16}, pointers(grids));
        EXPECT_EQ(bucket->find_seen(), (std::vector<bool>{true, true, false, false, false}));
        for (const Vec4f& pixel : bucket->render().combined) {
            EXPECT_WITHIN(pixel.x, 0.99, 1e-6);
            EXPECT_WITHIN(pixel.w, 0.99, 1e-6);
        }
    }
    // A hole in the second layer, left of pixel 8, lets the third one be seen.
    grids[1] = make_rectangle(1, 8, -2, 20, 20, 2, 1, 1, Vec3f(0.9f));
    set_opacity(grids[1], Vec3f(0.9f));
    RasterFrame frame = pixel_frame(2, 1);
    frame.opacity_threshold = 0.95f;
    EXPECT_EQ(RasterHider(gl_thread(), frame).open({0, 0, 16, 16}, pointers(grids))->find_seen(),
              (std::vector<bool>{true, true, true, false, false}));
}

TEST(RasterPasses, a_moving_tiling_covers_each_sample_exactly_once) {
    // Hard case 42: a transparent patch of many grids has no seams and no double hits.
    std::vector<Grid> grids;
    for (std::uint32_t k = 0; k < 36; ++k) {
        const float x = -10.0f + 7.3f * static_cast<float>(k % 6),
                    y = -9.0f + 7.1f * static_cast<float>(k / 6);
        const float x1 = -10.0f + 7.3f * static_cast<float>(k % 6 + 1),
                    y1 = -9.0f + 7.1f * static_cast<float>(k / 6 + 1);
        grids.push_back(make_rectangle(k, x, y, x1, y1, 2, 7, 5, Vec3f(0.37f)));
        set_opacity(grids.back(), Vec3f(0.37f));
        set_motion(grids.back(), {{3.3f, -2.1f, 0}, {1.7f, 2.9f, 0}});
    }
    RasterHider hider(gl_thread(), pixel_frame(4, 9));
    const RasterImage image = hider.open({0, 0, 24, 24}, pointers(grids))->render();
    for (const Vec4f& pixel : image.combined) EXPECT_EQ(pixel.w, image.combined[0].w);
    EXPECT_WITHIN(image.combined[0].w, 0.37, 1e-7);
}

TEST(RasterPeel, coincident_layers_all_count_in_any_order) {
    // Hard case 40.
    Grid a = make_rectangle(1, -2, -3, 20, 21, 2, 3, 3, Vec3f(0.3f, 0, 0));
    Grid b = make_rectangle(2, -2, -3, 20, 21, 2, 3, 3, Vec3f(0, 0.6f, 0));
    Grid c = make_rectangle(3, -2, -3, 20, 21, 2, 3, 3, Vec3f(0, 0, 0.5f));
    set_opacity(a, Vec3f(0.3f));
    set_opacity(b, Vec3f(0.6f));
    set_opacity(c, Vec3f(0.5f));
    RasterHider hider(gl_thread(), pixel_frame(2, 1));
    for (const auto& list : {std::vector<const Grid*>{&a, &b, &c}, {&c, &a, &b}}) {
        const RasterImage image = hider.open({0, 0, 8, 8}, list)->render();
        for (const Vec4f& pixel : image.combined) {
            EXPECT_WITHIN(pixel.w, 1 - 0.7 * 0.4 * 0.5, 1e-6);
            EXPECT_WITHIN(pixel.x, 0.3, 1e-6);  // the smaller key is in front
            EXPECT_WITHIN(pixel.y, 0.7 * 0.6, 1e-6);
            EXPECT_WITHIN(pixel.z, 0.7 * 0.4 * 0.5, 1e-6);
        }
    }
}

TEST(RasterPeel, opacity_is_spectral_and_holdouts_cut) {
    Grid glass = make_rectangle(1, -2, -2, 10, 10, 1, 1, 1, Vec3f(0.1f, 0.0f, 0.2f));
    set_opacity(glass, Vec3f(0.2f, 0.5f, 1.0f));
    Grid holdout = make_rectangle(2, -2, -2, 10, 10, 2);
    holdout.holdout = true;
    set_opacity(holdout, Vec3f(0.5f));
    const Grid wall = make_rectangle(3, -2, -2, 4, 10, 3, 1, 1, Vec3f(1.0f, 2.0f, 3.0f));
    RasterFrame frame = pixel_frame(1, 1);
    frame.film_transparent = false;
    RasterBackground background;
    background.constant = {0.25f, 0.5f, 1.0f, 1.0f};
    RasterHider hider(gl_thread(), frame);
    const RasterImage image =
        hider.open({0, 0, 8, 1}, {&glass, &holdout, &wall})->render(background);
    // Through the glass .8 .5 0, the holdout takes half of that: T = .4 .25 0, cut = 1.3 / 6.
    const Vec4f on_wall = image.combined[1], beside = image.combined[6];
    for (const Vec4f& pixel : {on_wall, beside}) EXPECT_WITHIN(pixel.w, 1.0 - 1.3 / 6, 1e-6);
    EXPECT_WITHIN(on_wall.x, 0.1 + 0.4 * 1.0, 1e-6);
    EXPECT_WITHIN(on_wall.y, 0.25 * 2.0, 1e-6);
    EXPECT_WITHIN(on_wall.z, 0.2, 1e-6);
    EXPECT_WITHIN(beside.x, 0.1 + 0.4 * 0.25, 1e-6);
    EXPECT_WITHIN(beside.y, 0.25 * 0.5, 1e-6);
}

TEST(RasterPeel, opaque_surfaces_hide_and_are_hidden_at_the_right_depth) {
    Grid front = make_rectangle(1, -2, -2, 10, 10, 1, 1, 1, Vec3f(0.5f, 0, 0));
    Grid behind = make_rectangle(2, -2, -2, 10, 10, 3, 1, 1, Vec3f(0, 0, 0.5f));
    for (Grid* grid : {&front, &behind}) set_opacity(*grid, Vec3f(0.5f));
    const Grid wall = make_rectangle(3, -2, -2, 10, 10, 2, 1, 1, Vec3f(0, 1, 0));
    RasterHider hider(gl_thread(), pixel_frame(2, 1));
    auto bucket = hider.open({0, 0, 4, 4}, {&behind, &front, &wall});
    EXPECT_EQ(bucket->find_seen(), (std::vector<bool>{false, true, true}));
    for (const Vec4f& pixel : bucket->render().combined)
        EXPECT_EQ(pixel, Vec4f(0.5f, 0.5f, 0.0f, 1.0f));
}

TEST(RasterPeel, additive_surfaces_without_opacity_add) {
    // Hard case 45.
    Grid flame = make_rectangle(1, -2, -2, 10, 10, 1, 1, 1, Vec3f(2.0f, 1.0f, 0.0f));
    set_opacity(flame, Vec3f(0.0f));
    flame.additive = true;
    Grid clear = make_rectangle(2, -2, -2, 10, 10, 2);
    set_opacity(clear, Vec3f(0.0f));
    RasterHider hider(gl_thread(), pixel_frame(2, 1));
    for (const Vec4f& pixel : hider.open({0, 0, 4, 4}, {&flame, &clear})->render().combined)
        EXPECT_EQ(pixel, Vec4f(2.0f, 1.0f, 0.0f, 0.0f));
}

TEST(RasterGeometry, small_grids_are_drawn_together) {
    // 1,000 grids of one micropolygon: a range holds 256 of them.
    std::vector<Grid> grids;
    for (std::uint32_t k = 0; k < 1000; ++k)
        grids.push_back(make_rectangle(k, static_cast<float>(k % 50), static_cast<float>(k / 50),
                                       static_cast<float>(k % 50 + 1),
                                       static_cast<float>(k / 50 + 1), 2));
    std::vector<GridSweep> sweeps;
    std::vector<const GridSweep*> of;
    sweeps.reserve(grids.size());
    for (const Grid& grid : grids)
        of.push_back(
            &sweeps.emplace_back(grid, pixel_projection(), LensShape(0, 0.0f, Vec2f(1.0f))));
    const RasterGeometry geometry(of);
    EXPECT_EQ(geometry.opaque().size(), 4u);
    EXPECT_EQ(geometry.indices().size(), 6000u);
    RasterHider hider(gl_thread(), pixel_frame(2, 1));
    const RasterImage image = hider.open({0, 0, 50, 20}, pointers(grids))->render();
    for (const Vec4f& pixel : image.combined) EXPECT_EQ(pixel.w, 1.0f);
}

}  // namespace
}  // namespace granita::raster_test
