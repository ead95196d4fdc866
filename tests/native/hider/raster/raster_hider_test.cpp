// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster/raster_hider.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "hider/samples/sample_table.h"
#include "raster_scene.h"

namespace granita::raster_test {
namespace {

RasterFrame make_frame(const Projection& projection, const RasterFilter& filter,
                       Statistics* statistics = nullptr) {
    RasterFrame frame;
    frame.projection = projection;
    frame.filter = filter;
    frame.statistics = statistics;
    return frame;
}

/// Overlapping wavy sheets, coloured, in perspective.
std::vector<Grid> make_sheets() {
    std::vector<Grid> grids;
    for (int k = 0; k < 6; ++k)
        grids.push_back(make_grid(
            10 - k, 12, 12,
            [k](float u, float v) {
                const float z = 4.0f + 0.4f * k + std::sin(5 * u + k) + std::cos(4 * v - k);
                return Vec3f((3 * u - 2 + 0.2f * k) * 2, (3 * v - 2 + 0.3f * k) * 2, z);
            },
            [k](float u, float v) { return Vec3f(u, v, 0.1f * k); }));
    return grids;
}

bool same_bits(const std::vector<Vec4f>& a, const std::vector<Vec4f>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec4f)) == 0;
}

TEST(RasterHider, draws_with_opengl_and_tests_no_sample_on_the_cpu) {
    Statistics statistics;
    RasterHider hider(gl_thread(), make_frame(pixel_projection(), box_filter(4), &statistics));
    const Grid grid = make_rectangle(1, 2, 1, 6, 5, 1, 3, 2);
    const RasterImage image = hider.open({0, 0, 8, 8}, {&grid})->render();
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            EXPECT_EQ(image.combined[y * 8 + x].w, x >= 2 && x < 6 && y >= 1 && y < 5) << x << y;
    EXPECT_EQ(statistics.get(Counter::GlPrimitives), 12u);  // a micropolygon has two
    EXPECT_EQ(statistics.get(Counter::GlPasses), 1u);
    EXPECT_EQ(statistics.get(Counter::Micropolygons), 6u);
    EXPECT_EQ(statistics.get(Counter::SamplesTotal), 1024u);
    EXPECT_EQ(statistics.get(Counter::SampleTestsStatic), 0u);
    EXPECT_EQ(statistics.get(Counter::SampleTestsMoving), 0u);
}

TEST(RasterHider, samples_lie_where_the_regular_table_has_them) {
    Options options;
    options.sampling = Sampling::Regular;
    options.samples = 25;
    const SampleTable table(options, Camera{}, {});
    TileSamples samples;
    table.fill_tile({3, -2}, {}, samples);
    ASSERT_EQ(samples.samples, 25);
    for (int pixel : {0, 17, 255})
        for (int s = 0; s < 25; ++s) {
            // 2^-20 is the table's own unit; the largest coordinate is below 16.
            EXPECT_WITHIN(samples.x[pixel * 25 + s], pixel % 16 + (s % 5 + 0.5) / 5, 0x1p-20);
            EXPECT_WITHIN(samples.y[pixel * 25 + s], pixel / 16 + (s / 5 + 0.5) / 5, 0x1p-20);
        }
}

TEST(RasterHider, interpolates_radiance_perspective_correctly) {
    // Radiance is the position, so a pixel shows where its ray meets the plane z = 3 + x / 2.
    const int size = 32;
    const Projection projection = perspective_projection(size, size);
    RasterHider hider(gl_thread(), make_frame(projection, box_filter(1)));
    const auto plane = [](float u, float v) {
        const float x = 8 * u - 4;
        return Vec3f(x, 12 * v - 6, 3 + x / 2);
    };
    const Grid grid = make_grid(1, 3, 2, plane, plane);
    const RasterImage image = hider.open({0, 0, size, size}, {&grid})->render();
    int seen = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const Vec4f& pixel = image.combined[y * size + x];
            if (pixel.w == 0.0f) continue;
            ++seen;
            const double slope_x = (x + 0.5 - projection.center.x) / projection.scale.x;
            const double slope_y = (y + 0.5 - projection.center.y) / projection.scale.y;
            const double z = 3.0 / (1.0 - slope_x / 2.0);
            // Vertices move by up to 2^-9 pixel when OpenGL snaps them: 2^-9 / 16 in slope, times
            // dz/dslope = z^2 / 6.
            const double tolerance = 0x1p-9 / 16 * (z * z / 6 + z) * 2;
            EXPECT_WITHIN(pixel.x, slope_x * z, tolerance);
            EXPECT_WITHIN(pixel.y, slope_y * z, tolerance);
            EXPECT_WITHIN(pixel.z, z, tolerance);
        }
    EXPECT_GT(seen, 500);
}

TEST(RasterHider, no_bit_depends_on_buckets_or_crop) {
    const int width = 150, height = 90;
    const RasterFilter filter = make_raster_filter(4, 2.0, mitchell);
    RasterHider hider(gl_thread(), make_frame(perspective_projection(width, height), filter));
    const std::vector<Grid> grids = make_sheets();
    const Rect whole_rect{-7, -5, width, height};
    const RasterImage whole = hider.open(whole_rect, pointers(grids))->render();
    const auto compare = [&](const Rect& pixels) {
        const RasterImage part = hider.open(pixels, pointers(grids))->render();
        int different = 0;
        for (int y = pixels.y0; y < pixels.y1; ++y)
            for (int x = pixels.x0; x < pixels.x1; ++x)
                different +=
                    std::memcmp(&part.combined[(y - pixels.y0) * pixels.width() + x - pixels.x0],
                                &whole.combined[(y + 5) * whole_rect.width() + x + 7],
                                sizeof(Vec4f)) != 0;
        EXPECT_EQ(different, 0) << pixels.x0 << ", " << pixels.y0 << " size " << pixels.width();
    };
    for (const int size : {16, 32, 48, 64, 128})
        for (int y = 0; y < height; y += size)
            for (int x = 0; x < width; x += size)
                compare(Rect{x, y, x + size, y + size}.intersect({0, 0, width, height}));
    compare({61, 13, 68, 71});
    compare({-7, -5, 1, 1});
}

TEST(RasterHider, no_bit_depends_on_hidden_or_off_screen_grids_or_their_order) {
    RasterHider hider(gl_thread(), make_frame(perspective_projection(64, 64),
                                              make_raster_filter(4, 2.0, mitchell)));
    std::vector<Grid> grids = make_sheets();
    std::vector<const Grid*> list = pointers(grids);
    const Rect pixels{0, 0, 64, 64};
    const RasterImage image = hider.open(pixels, list)->render();

    std::reverse(list.begin(), list.end());
    EXPECT_TRUE(same_bits(image.combined, hider.open(pixels, list)->render().combined));

    const Grid on_the_left = make_rectangle(0, -90, -90, -80, 90, 5);
    const Grid behind_the_eye = make_rectangle(2, -5, -5, 5, 5, -5);
    const Grid beyond_the_far_clip = make_rectangle(3, -500, -500, 500, 500, 101);
    list.insert(list.end(), {&on_the_left, &behind_the_eye, &beyond_the_far_clip});
    EXPECT_TRUE(same_bits(image.combined, hider.open(pixels, list)->render().combined));
}

TEST(RasterHider, of_coincident_grids_the_smaller_key_wins_in_any_order) {
    RasterHider hider(gl_thread(), make_frame(perspective_projection(16, 16), box_filter(2)));
    const auto tilted = [](float u, float v) {
        return Vec3f(20 * u - 10, 20 * v - 10, 5 + u + 0.3f * v);
    };
    Grid red = make_grid(5, 7, 3, tilted, [](float, float) { return Vec3f(1, 0, 0); });
    Grid green = make_grid(6, 7, 3, tilted, [](float, float) { return Vec3f(0, 1, 0); });
    for (const auto& list : {std::vector<const Grid*>{&red, &green}, {&green, &red}}) {
        const RasterImage image = hider.open({0, 0, 16, 16}, list)->render();
        // A device may interpolate a colour that is the same at all corners to 1 - 2^-24, and four
        // samples of it are added.
        for (const Vec4f& pixel : image.combined) {
            EXPECT_NEAR(pixel.x, 1.0f, 0x1p-22f);
            EXPECT_EQ(Vec3f(pixel.y, pixel.z, pixel.w), Vec3f(0, 0, 1));
        }
    }
}

TEST(RasterHider, an_error_while_drawing_leaves_nothing_to_the_next_bucket) {
    std::string failing;
    gl::ContextOptions options;
    options.faults.at_check = [&](const std::string& what) {
        if (what == failing) throw GlError(what);
    };
    gl::GlThread thread(options);
    RasterHider hider(thread, make_frame(pixel_projection(), box_filter(2)));
    const Grid wall = make_rectangle(1, -1, -1, 17, 17, 1, 4, 4);
    const auto bucket = hider.open({0, 0, 16, 16}, {&wall});
    const auto empty = hider.open({0, 0, 16, 16}, std::vector<const Grid*>{});
    bucket->render();
    for (const char* step : {"drawing grids", "accumulating passes"}) {
        failing = step;
        EXPECT_THROW(bucket->render(), GlError);
        failing.clear();
        for (const Vec4f& pixel : empty->render().combined) EXPECT_EQ(pixel, Vec4f(0));
    }
}

TEST(RasterHider, a_tiling_whose_edges_run_through_samples_covers_each_exactly_once) {
    // Hard case 51: at lattice 2 samples lie at quarters; so do all vertices, diagonals included.
    RasterHider hider(gl_thread(), make_frame(pixel_projection(), box_filter(2)));
    Grid left = make_rectangle(1, 1.25f, 1.25f, 5.25f, 9.25f, 1, 8, 16);
    Grid right = make_rectangle(2, 5.25f, 1.25f, 9.25f, 9.25f, 1, 4, 2);
    auto bucket = hider.open({0, 0, 12, 12}, {&left, &right});
    EXPECT_EQ(bucket->find_seen(), (std::vector<bool>{true, true}));
    // 8 x 8 pixels of 4 samples.
    std::uint64_t covered[2] = {};
    for (const auto& s : bucket->surfaces().surface)
        if (s.grid >= 0) ++covered[s.grid];
    EXPECT_EQ(covered[0], 128u);
    EXPECT_EQ(covered[1], 128u);
    // Of a transparent plane a sample in two triangles would be two layers.
    for (Grid* grid : {&left, &right}) set_opacity(*grid, Vec3f(0.25f));
    const RasterImage image = hider.open({0, 0, 12, 12}, {&left, &right})->render();
    double alpha = 0.0;
    for (const Vec4f& pixel : image.combined) alpha += pixel.w;
    EXPECT_DOUBLE_EQ(alpha, 16.0);
}

TEST(RasterHider, finds_what_is_seen_before_shading) {
    Statistics statistics;
    RasterHider hider(gl_thread(), make_frame(pixel_projection(),
                                              make_raster_filter(4, 2.0, mitchell), &statistics));
    Grid front = make_rectangle(3, 0, 0, 8, 8, 2, 4, 4);
    Grid hidden = make_rectangle(2, 1, 1, 7, 7, 3, 4, 4);
    Grid peeping = make_rectangle(1, 4, 4, 8.5f, 8, 4, 4, 4);
    Grid in_the_margin = make_rectangle(4, 20.5f, 0, 23, 1, 2);
    Grid beyond_it = make_rectangle(5, 22, 0, 25, 1, 2);
    for (Grid* grid : {&front, &hidden, &peeping, &in_the_margin, &beyond_it})
        grid->radiance.clear();
    auto bucket =
        hider.open({0, 0, 20, 20}, {&front, &hidden, &peeping, &in_the_margin, &beyond_it});
    // The margin is two pixels.
    EXPECT_EQ(bucket->find_seen(), (std::vector<bool>{true, false, true, true, false}));
    EXPECT_GT(statistics.get(Counter::GlPrimitives), 0u);
    EXPECT_EQ(statistics.get(Counter::SampleTestsStatic), 0u);

    // A grid that is seen but not shaded is a fault of the caller; one that is not seen is none.
    front.radiance.assign(25, Vec3f(1.0f));
    EXPECT_THROW(bucket->render(), InternalError);
    peeping.radiance.assign(25, Vec3f(1.0f));
    in_the_margin.radiance.assign(4, Vec3f(1.0f));
    EXPECT_EQ(bucket->render().combined.size(), 400u);
}

TEST(RasterHider, holdouts_cut_coverage_and_background) {
    RasterFrame frame = make_frame(pixel_projection(), box_filter(2));
    frame.film_transparent = false;
    RasterBackground background;
    background.constant = {0.2f, 0.3f, 0.4f, 1.0f};
    RasterHider hider(gl_thread(), frame);
    Grid holdout = make_rectangle(1, 0, 0, 2, 2, 1);
    holdout.holdout = true;
    const Grid behind = make_rectangle(2, 0, 0, 3, 2, 2);
    const RasterImage image = hider.open({0, 0, 4, 1}, {&holdout, &behind})->render(background);
    EXPECT_EQ(image.combined[1], Vec4f(0.0f));
    EXPECT_EQ(image.combined[2], Vec4f(1.0f));
    EXPECT_EQ(image.combined[3], background.constant);
}

TEST(RasterHider, non_finite_micropolygons_are_dropped_and_counted) {
    Statistics statistics;
    RasterHider hider(gl_thread(), make_frame(pixel_projection(), box_filter(2), &statistics));
    Grid grid = make_rectangle(1, 0, 0, 4, 4, 1, 4, 4);
    grid.positions[2 * 5 + 2].y = NAN;  // the middle: four micropolygons share it
    const RasterImage image = hider.open({0, 0, 4, 4}, {&grid})->render();
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) {
            const bool dropped = x >= 1 && x < 3 && y >= 1 && y < 3;
            EXPECT_EQ(image.combined[y * 4 + x].w, dropped ? 0.0f : 1.0f) << x << ", " << y;
        }
    EXPECT_EQ(statistics.get(Counter::MicropolygonsDropped), 4u);
    EXPECT_EQ(statistics.get(Counter::Micropolygons), 12u);
}

TEST(RasterHider, opacity_that_varies_must_be_there) {
    RasterHider hider(gl_thread(), make_frame(pixel_projection(), box_filter(2)));
    Grid grid = make_rectangle(1, 0, 0, 4, 4, 1);
    grid.opacity_varies = true;
    EXPECT_THROW(hider.open({0, 0, 4, 4}, {&grid}), InternalError);
}

}  // namespace
}  // namespace granita::raster_test
