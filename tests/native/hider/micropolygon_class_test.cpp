// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/micropolygon_class.h"

#include <gtest/gtest.h>

#include "hider/grid_builder.h"

namespace granita {
namespace {

/// Four squares in a row: clear, half way to opaque, opaque, opaque.
Grid cut_out() {
    Grid grid = test::rectangle(0, 0, 4, 1, 1, 4, 1);
    grid.opacity_varies = true;
    for (int v = 0; v < grid.vertex_count(); ++v)
        grid.opacity.emplace_back(v % 5 < 2 ? 0.0f : 1.0f);
    return grid;
}

TEST(MicropolygonClass, corners_tell_what_is_clear_and_what_is_opaque) {
    const GridClasses found = classify(cut_out());
    EXPECT_EQ(found.classes[0], 0);
    EXPECT_EQ(found.classes[1] & kTransparent, kTransparent);
    EXPECT_EQ(found.classes[2] & kTransparent, 0);
    EXPECT_NE(found.classes[3], 0);
    EXPECT_EQ(found.opacity[1].least, 0.0f);
    EXPECT_GE(found.opacity[1].most, 1.0f);
}

// Whatever the corners say, in either direction: samples find holes and what fills them.
TEST(MicropolygonClass, where_samples_find_their_own_opacity_nothing_is_known) {
    Grid grid = cut_out();
    grid.unsettled_opacity = {1, 1, 1, 0};
    const GridClasses found = classify(grid);
    for (int m = 0; m < 3; ++m) {
        EXPECT_EQ(found.classes[m], kTriangleA | kTriangleB | kTransparent) << m;
        EXPECT_EQ(found.opacity[m].least, 0.0f) << m;
        EXPECT_EQ(found.opacity[m].most, 1.0f) << m;
    }
    EXPECT_EQ(found.classes[3] & kTransparent, 0);
}

}  // namespace
}  // namespace granita
