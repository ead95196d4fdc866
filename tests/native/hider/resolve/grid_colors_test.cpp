// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/grid_colors.h"

#include <gtest/gtest.h>

#include <numeric>

#include "hider/grid_builder.h"

namespace granita {
namespace {

const Vec3f kColor(0.1f, 0.7f, 3.3f);

/// Grids of one to four micropolygons, so that ids change grids at any place of the pool's pages.
class GridColorsTest : public testing::Test {
  protected:
    Grid grid(int width) {
        Grid made =
            test::make_grid(width, 1, 1, [](float u, float v, int) { return Vec3f(u, v, 1); });
        test::set_color(made, kColor);
        return made;
    }
    /// Colours a sample of each micropolygon, and one of none at the end.
    bool color() {
        GridPool pool;
        for (const Grid& g : grids) pool.add(g);
        ids.resize(pool.id_end());
        std::iota(ids.begin(), ids.end(), 0u);
        ids.push_back(kNoSurface);
        colors = SampleColors(ids.size());
        done.assign(ids.size(), 0);
        seen.resize(grids.size(), true);
        table.fill(pool, seen);
        return table.color(pool, ids, colors, done);
    }

    std::vector<Grid> grids;
    std::vector<bool> seen;  ///< [grids]; true where it is not set
    GridColors table;
    std::vector<SurfaceId> ids;
    SampleColors colors;
    std::vector<std::uint8_t> done;
};

TEST_F(GridColorsTest, samples_take_the_colour_of_the_grid_that_they_see) {
    std::vector<Vec3f> expected;
    for (int g = 0; g < 40; ++g) {
        grids.push_back(grid(1 + g % 4));
        const Vec3f own(static_cast<float>(g), -0.0f, 0.3f);
        test::set_color(grids.back(), own);
        expected.insert(expected.end(), 1 + g % 4, own);
    }
    EXPECT_FALSE(color());
    EXPECT_TRUE(table.any());
    for (std::size_t s = 0; s < expected.size(); ++s) {
        EXPECT_EQ(colors[s].color, expected[s]) << s;
        EXPECT_FALSE(std::signbit(colors.green[s]));
        EXPECT_EQ(colors.alpha[s], 1.0f);
        EXPECT_EQ(done[s], 1);
    }
    EXPECT_EQ(done.back(), 0);
}

TEST_F(GridColorsTest, leave_what_has_several_colours_or_is_seen_otherwise) {
    for (int i = 0; i < 6; ++i) grids.push_back(grid(3));
    grids[1].radiance.back().z += 1e-6f;
    grids[2].radiance.clear();  // not shaded
    grids[3].holdout = true;
    test::set_color(grids[4], kColor, Vec3f(0.5f));
    EXPECT_TRUE(color());
    EXPECT_TRUE(table.any());
    for (std::size_t s = 0; s < 18; ++s) EXPECT_EQ(done[s], s < 3 || s >= 15 ? 1 : 0) << s;
}

/// Another bucket's thread may be shading them.
TEST_F(GridColorsTest, grids_that_no_sample_sees_are_not_read) {
    for (int i = 0; i < 3; ++i) grids.push_back(grid(2));
    seen = {true, false, true};
    EXPECT_TRUE(color());
    for (std::size_t s = 0; s < 6; ++s) EXPECT_EQ(done[s], s / 2 == 1 ? 0 : 1) << s;
}

TEST_F(GridColorsTest, are_not_asked_where_there_are_none) {
    grids.push_back(grid(3));
    grids[0].radiance[1] = Vec3f(0.0f);
    EXPECT_TRUE(color());
    EXPECT_FALSE(table.any());
}

/// A moving rectangle of one colour in front of one of many, through samples of their own times.
TEST(GridColorsInATile, change_no_colour_beside_them) {
    test::Shot shot;
    shot.options.samples = 8;
    shot.grids.push_back(test::moving_rectangle(2, 2, 9, 9, 4, 5, 3));
    test::set_color(shot.grids[0], kColor);
    shot.grids.push_back(test::moving_rectangle(0, 0, 16, 16, 8, -2, 1));
    for (std::size_t v = 0; v < shot.grids[1].radiance.size(); ++v)
        shot.grids[1].radiance[v] = Vec3f(static_cast<float>(v), 1, 2);
    const test::Picture with = test::render(make_simd_hider, shot);
    shot.grids[0].radiance[0] = Vec3f(9);  // then it has no one colour; its first corner aside
    const test::Picture without = test::render(make_simd_hider, shot);
    int same = 0;
    for (std::size_t i = 0; i < with.combined.size(); ++i)
        same += with.combined[i] == without.combined[i];
    EXPECT_GT(same, 200);  // of 256: what the first micropolygon passes differs
}

}  // namespace
}  // namespace granita
