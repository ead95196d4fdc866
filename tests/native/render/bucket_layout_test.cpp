// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/bucket_layout.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <set>

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

RasterBounds box(float x0, float y0, float x1, float y1) {
    RasterBounds b;
    b.x0 = x0, b.y0 = y0, b.x1 = x1, b.y1 = y1;
    b.visible = true;
    return b;
}

TEST(BucketLayout, pixels_of_all_buckets_tile_the_needed_pixels) {
    const Rect needed{-3, -2, 131, 70};
    const BucketLayout layout(needed, 32);
    std::set<std::pair<int, int>> seen;
    for (int i = 0; i < layout.count(); ++i) {
        const Rect r = layout.pixels(i);
        for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x) EXPECT_TRUE(seen.emplace(x, y).second);
    }
    EXPECT_EQ(seen.size(), static_cast<std::size_t>(needed.width() * needed.height()));
    EXPECT_TRUE(seen.count({-3, -2}));
}

TEST(BucketLayout, buckets_are_aligned_to_the_frame_whatever_is_needed) {
    const BucketLayout layout({37, 5, 70, 60}, 16);
    for (int i = 0; i < layout.count(); ++i) {
        const Rect t = layout.tiles(i), p = layout.pixels(i);
        EXPECT_EQ(t.width(), 1);
        EXPECT_LE(t.x0 * 16, p.x0);
        EXPECT_GE(t.x1 * 16, p.x1);
    }
}

TEST(BucketLayout, spiral_visits_every_bucket_once_from_the_centre_outwards) {
    const BucketLayout layout({0, 0, 7 * 16, 4 * 16}, 16);
    const auto order = layout.spiral();
    EXPECT_EQ(std::set<int>(order.begin(), order.end()).size(), 28u);
    EXPECT_EQ(order.size(), 28u);
    EXPECT_EQ(order.front(), layout.index(3, 1));
    int ring = 0;
    for (const int i : order) {
        const int distance = std::max(std::abs(i % 7 - 3), std::abs(i / 7 - 1));
        EXPECT_GE(distance, ring - 1);
        ring = std::max(ring, distance);
    }
}

TEST(BucketLayout, the_aprons_of_all_neighbours_are_in_range) {
    // A box within one bucket, 2 pixels from a border that an margin of 3 reaches over.
    const BucketLayout layout({0, 0, 96, 96}, 32, 3);
    EXPECT_EQ(layout.range(box(40, 40, 50, 50)), (Rect{1, 1, 2, 2}));
    EXPECT_EQ(layout.range(box(34, 40, 50, 50)), (Rect{0, 1, 2, 2}));
    EXPECT_EQ(layout.range(box(40, 34, 50, 50)), (Rect{1, 0, 2, 2}));
    EXPECT_EQ(layout.range(box(40, 40, 62, 50)), (Rect{1, 1, 3, 2}));
    EXPECT_EQ(layout.range(box(40, 40, 50, 62)), (Rect{1, 1, 2, 3}));
}

TEST(BucketLayout, range_covers_infinite_and_clamps_to_the_layout) {
    const BucketLayout layout({-2, -2, 66, 34}, 32);
    EXPECT_EQ(layout.range(box(-kInfinity, -kInfinity, kInfinity, kInfinity)), layout.buckets());
    EXPECT_EQ(layout.range(box(1, 1, 31, 31)), (Rect{0, 0, 1, 1}));
    EXPECT_EQ(layout.range(box(1, 1, 32, 31)), (Rect{0, 0, 2, 1}));
    EXPECT_TRUE(layout.range(box(70, 0, 80, 10)).empty());
    EXPECT_TRUE(layout.range(box(std::numeric_limits<float>::quiet_NaN(), 0, 10, 10)).empty());
    RasterBounds hidden = box(0, 0, 10, 10);
    hidden.visible = false;
    EXPECT_TRUE(layout.range(hidden).empty());
}

}  // namespace
}  // namespace granita
