// SPDX-License-Identifier: GPL-3.0-or-later
// The hierarchical depth in time: what hides and what is hidden move (docs/hard_cases.md, case 22).
#include "hider/time_slabs.h"

#include <gtest/gtest.h>

#include "grid_builder.h"

namespace granita::test {
namespace {

/// Covers nothing of the tile when the shutter opens and when it closes.
Grid passing_by() {
    return moving_rectangle(-30, -2, 0, 18, 5, 46, 0, 8, 8);
}

TEST(TimeSlabs, WhatMovesBehindAnEquallyFastOccluderIsNotTested) {
    Shot alone, both;
    alone.grids = {passing_by()};
    render(make_simd_hider, alone);
    both.grids = {passing_by(), moving_rectangle(-18, 4, -12, 12, 9, 46, 0)};
    render(make_simd_hider, both);
    EXPECT_EQ(both.statistics.get(Counter::SampleTestsMoving),
              alone.statistics.get(Counter::SampleTestsMoving));
    EXPECT_EQ(both.statistics.get(Counter::GridsCulled), 1u);
    EXPECT_EQ(alone.statistics.get(Counter::GridsCulled), 0u);
    EXPECT_GT(alone.statistics.get(Counter::SampleHits), 0u);
}

TEST(TimeSlabs, WhatShowsForAMomentIsSeen) {
    // In front of the tile when the shutter opens and closes, away around the middle.
    Grid occluder = make_grid(8, 8, 3, [](float u, float v, int k) {
        return Vec3f(-4 + 24 * u + (k == 1 ? 40.0f : 0.0f), -4 + 24 * v, 5);
    });
    set_color(occluder, Vec3f(0.0f));
    Grid behind = moving_rectangle(4, 4, 12, 12, 9, 0.5f, 0);
    Shot shot;
    shot.options.samples = 64;
    shot.grids = {occluder, behind};
    const Picture picture = render(make_simd_hider, shot);
    // The occluder's left edge moves from -4 to 36 and back: it covers x until t = (x + 4) / 80 and
    // from 1 less that on.
    for (int x = 5; x < 11; ++x) {
        const double covered = 2 * (x + 0.5 + 4) / 80;
        // Four times the error of the worst pixel (docs/sampling_error.md).
        EXPECT_WITHIN(picture.at(x, 8).x, 1 - covered, 4 * .0111);
    }
}

TEST(TimeSlabs, CoverTheShutterAndTheirGrid) {
    const Grid grid = moving_rectangle(0, 0, 4, 2, 5, 40, 8);
    const GridSweep sweep(grid, pixel_camera().projection, LensShape(0, 0.0f, Vec2f(1.0f)));
    const auto& slabs = sweep.slabs();
    ASSERT_GE(slabs.size(), 8u);
    float time = 0;
    for (const TimeSlab& slab : slabs) {
        EXPECT_EQ(slab.t0, time);
        time = slab.t1;
        // A hundredth of a pixel for what bounds may grow.
        EXPECT_WITHIN(slab.bounds.x0, 40 * slab.t0, .01);
        EXPECT_WITHIN(slab.bounds.x1, 4 + 40 * slab.t1, .01);
        EXPECT_WITHIN(slab.bounds.y1, 2 + 8 * slab.t1, .01);
        EXPECT_LE(slab.bounds.x0, 40 * slab.t0);
        EXPECT_GE(slab.bounds.x1, 4 + 40 * slab.t1);
    }
    EXPECT_EQ(time, 1);
}

}  // namespace
}  // namespace granita::test
