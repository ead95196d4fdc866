// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/hierarchical_grid.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "render/frame_geometry.h"

namespace granita {
namespace {

/// Ranges of all sizes, some empty, within the area.
std::vector<Rect> random_ranges(const Rect& area, int count) {
    std::mt19937 random(7);
    const auto between = [&](int lo, int hi) {
        return std::uniform_int_distribution<int>(lo, hi)(random);
    };
    std::vector<Rect> ranges;
    for (int i = 0; i < count; ++i) {
        const int x = between(area.x0, area.x1 - 1), y = between(area.y0, area.y1 - 1);
        ranges.push_back({x, y, between(x, area.x1), between(y, area.y1)});
    }
    return ranges;
}

TEST(HierarchicalGrid, every_bucket_meets_each_thing_that_touches_it_once) {
    for (const Rect area : {Rect{0, 0, 1, 1}, Rect{-1, -1, 23, 14}, Rect{3, 5, 90, 6}})
        for (const int count : {0, 1, 5, 300}) {
            const std::vector<Rect> ranges = random_ranges(area, count);
            const HierarchicalGrid grid(area, ranges);
            for (int y = area.y0; y < area.y1; ++y)
                for (int x = area.x0; x < area.x1; ++x) {
                    std::map<std::uint32_t, int> met;
                    grid.for_each(x, y, [&](std::uint32_t thing) { ++met[thing]; });
                    for (const auto& [thing, times] : met) EXPECT_EQ(times, 1);
                    for (std::uint32_t i = 0; i < ranges.size(); ++i) {
                        const Rect& r = ranges[i];
                        const bool touches = x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1;
                        EXPECT_TRUE(!touches || met.count(i) == 1);
                    }
                }
        }
}

TEST(HierarchicalGrid, a_bucket_is_shown_no_more_than_three_times_what_touches_it) {
    // Things of one size at random places: 2.8 times is the most on average.  There are enough of
    // them for cells of one bucket.
    constexpr int kCount = 10'000;
    std::mt19937 random(3);
    for (const int size : {1, 2, 4, 5, 9, 17}) {
        std::vector<Rect> ranges;
        for (int i = 0; i < kCount; ++i) {
            const int x = static_cast<int>(random() % (200u - static_cast<unsigned>(size)));
            const int y = static_cast<int>(random() % (200u - static_cast<unsigned>(size)));
            ranges.push_back({x, y, x + size, y + size});
        }
        const HierarchicalGrid grid({0, 0, 200, 200}, ranges);
        double shown = 0;
        for (int y = 0; y < 200; ++y)
            for (int x = 0; x < 200; ++x) grid.for_each(x, y, [&](std::uint32_t) { ++shown; });
        EXPECT_LE(shown, 3.0 * kCount * size * size) << size;
    }
}

TEST(HierarchicalGrid, memory_follows_the_things_not_things_times_buckets) {
    const Rect area{0, 0, 240, 135};  // 4K in buckets of 16 pixels
    for (const int count : {1, 10, 1000}) {
        const auto n = static_cast<std::size_t>(count);
        const std::vector<Rect> quarters(n, Rect{60, 30, 180, 98}), small(n, Rect{7, 7, 8, 8});
        EXPECT_LE(HierarchicalGrid(area, quarters).entries(), 24 * n + 90);
        EXPECT_LE(HierarchicalGrid(area, small).entries(), 24 * n + 90);
        EXPECT_LE(HierarchicalGrid(area, random_ranges(area, count)).entries(), 24 * n + 90);
    }
}

/// Sheets of one unit that cross half the frame in both directions.
Scene crossing_scene(int count) {
    Scene scene;
    scene.options.width = 3840;
    scene.options.height = 2160;
    scene.camera.world_from_camera = {Mat4d(1.0)};
    Projection& p = scene.camera.projection;
    p.perspective = false;
    p.scale = {1.0, 1.0};
    p.near_clip = 0.01;
    p.far_clip = 100.0;
    GeometryData sheet;
    sheet.points = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    sheet.face_sizes = {4};
    sheet.corner_verts = {0, 1, 2, 3};
    scene.geometries.push_back(sheet);
    for (int i = 0; i < count; ++i) {
        Instance instance;
        instance.key = static_cast<std::uint32_t>(i);
        Mat4d end(1.0);
        end[3] = {1900.0, 1000.0 + i % 60, 0.0, 1.0};
        instance.world_from_object = {Mat4d(1.0), end};
        scene.instances.push_back(instance);
    }
    return scene;
}

TEST(FrameGeometry, lists_of_moving_instances_do_not_multiply_with_buckets) {
    const Scene scene = crossing_scene(500);
    Statistics statistics;
    Report report;
    View view;
    view.scene = &scene;
    view.statistics = &statistics;
    view.projection = scene.camera.projection;
    for (const int bucket_size : {16, 64}) {
        const BucketLayout layout({0, 0, 3840, 2160}, bucket_size);
        FrameGeometry geometry(view, layout, report, report);
        EXPECT_LE(geometry.list_entries(), 24u * 500 + 90);
        int instances = 0, faces = 0;
        const int bucket = layout.index(3, 2);
        geometry.for_each_instance(bucket, [&](std::uint32_t i) {
            ++instances;
            geometry.for_each_face(*geometry.open(i), bucket, [&](std::uint32_t) { ++faces; });
        });
        EXPECT_EQ(instances, 500);
        EXPECT_EQ(faces, 500);
        for (int i = 0; i < layout.count(); ++i) geometry.release(i);
    }
}

}  // namespace
}  // namespace granita
