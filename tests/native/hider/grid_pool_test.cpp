// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <memory>

#include "hider/grid_builder.h"
#include "hider/sample_store.h"

namespace granita {
namespace {

Grid row(int micropolygons) {
    return test::make_grid(micropolygons, 1, 1,
                           [](float u, float v, int) { return Vec3f(u, v, 1); });
}

/// A picture that is kept has no more of its grids than samples see.
TEST(GridPool, KnowsItsIdsWhenGridsAreGone) {
    GridPool pool;
    const Grid seen = row(3);
    auto unseen = std::make_unique<Grid>(row(4));
    pool.add(seen);
    pool.add(*unseen);
    *unseen = row(90);  // what its memory is used for
    unseen.reset();
    EXPECT_EQ(pool.id_end(), 7u);
    EXPECT_EQ(pool.locate(2).grid, &seen);
    EXPECT_EQ(pool.slot(3), 1u);
}

}  // namespace
}  // namespace granita
