// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of a grid before any tile looks at it holds whatever brute force finds in the
// tiles.
#include "hider/grid_sweep.h"

#include <gtest/gtest.h>

#include "busy_scene.h"

namespace granita::test {
namespace {

bool holds(const RasterBounds& bounds, const Vec2d& place, float key) {
    return bounds.visible && bounds.x0 <= place.x && place.x <= bounds.x1 && bounds.y0 <= place.y &&
           place.y <= bounds.y1 &&
           key <= bounds.nearest_key + 1e-6f * std::fabs(bounds.nearest_key);
}

/// Parts, by micropolygon; -1: in none, -2: in several.
std::vector<int> parts_of(const GridSweep& sweep) {
    std::vector<int> part(static_cast<std::size_t>(sweep.grid().micropolygon_count()), -1);
    for (std::size_t p = 0; p < sweep.parts().size(); ++p) {
        const GridPart& at = sweep.parts()[p];
        for (int j = at.j; j < at.j + at.n_v; ++j)
            for (int i = at.i; i < at.i + at.n_u; ++i) {
                int& of = part[static_cast<std::size_t>(j * sweep.grid().n_u + i)];
                of = of == -1 ? static_cast<int>(p) : -2;
            }
    }
    return part;
}

/// Tile by tile, every sample that the reference executor finds in the grid.
void expect_holds_brute_force(const Shot& shot, const Grid& grid) {
    const SampleTable table(shot.options, shot.camera);
    const GridSweep sweep(grid, shot.camera.projection, table.lens());
    const HiderFrame frame{&table, shot.camera.projection};
    const Rect& tiles = shot.tiles;
    const auto hider = make_reference_hider(
        frame, tiles, {tiles.x0 * 16, tiles.y0 * 16, tiles.x1 * 16, tiles.y1 * 16});
    hider->hide(sweep);
    const std::vector<int> part = parts_of(sweep);
    EXPECT_EQ(*std::min_element(part.begin(), part.end()), 0);
    int hits = 0, outside_part = 0, outside_slab = 0;
    const auto& stores = hider->finish();
    for (std::size_t tile = 0; tile < stores.size(); ++tile) {
        const TileSamples& samples = hider->tile_samples(tile);
        for (std::size_t s = 0; s < stores[tile].id.size(); ++s) {
            if (stores[tile].id[s] == kNoSurface) continue;
            ++hits;
            const int m = hider->pool().locate(stores[tile].id[s]).micropolygon;
            const Vec2d place = Vec2d(stores[tile].tile * 16) + Vec2d(samples.x[s], samples.y[s]);
            const float time = samples.t.empty() ? 0.0f : samples.t[s], key = stores[tile].key[s];
            const int segments = sweep.segments();
            const int segment = std::max(
                0, std::min(static_cast<int>(time * static_cast<float>(segments)), segments - 1));
            const auto p = static_cast<std::size_t>(part[static_cast<std::size_t>(m)]);
            outside_part += !holds(sweep.bounds(p, segment), place, key);
            for (const TimeSlab& slab : sweep.slabs())
                if (slab.t0 <= time && time <= slab.t1)
                    outside_slab += !holds(slab.bounds, place, key);
        }
    }
    EXPECT_GT(hits, 0);
    EXPECT_EQ(outside_part, 0) << "of " << hits;
    EXPECT_EQ(outside_slab, 0) << "of " << hits;
}

TEST(GridSweep, HoldsWhatBruteForceFindsInEachTile) {
    for (const Blur blur : {kStatic, kMoving, kLens, kBoth, kRackFocus, kAllMoves}) {
        Shot shot;
        make_busy(shot, blur, 3, 3);
        shot.options.samples = 4;
        for (Grid& grid : shot.grids) {
            set_color(grid, Vec3f(1));
            expect_holds_brute_force(shot, grid);
        }
    }
}

TEST(GridSweep, HoldsWhatPassesTheEye) {
    for (const double lens : {0.0, 0.05}) {
        Shot shot;
        shot.options.samples = 16;
        shot.tiles = {-1, -1, 1, 1};
        shot.camera = pinhole_camera(60);
        shot.camera.projection.lens_radius = lens;
        shot.camera.projection.focus = 3;
        // From before the camera to behind it, and a floor that always reaches behind it.
        expect_holds_brute_force(shot, make_grid(20, 20, 2, [](float u, float v, int k) {
                                     return Vec3f(u - .5f, v - .5f, k ? -1.0f : 3.0f + u);
                                 }));
        expect_holds_brute_force(shot, make_grid(24, 24, 1, [](float u, float v, int) {
                                     return Vec3f(8 * u - 4, -.5f, 20 * v - 4);
                                 }));
    }
}

TEST(GridSweep, HoldsFacesOfTheirOwnAndNarrowGrids) {
    for (const Blur blur : {kStatic, kAllMoves}) {
        Shot shot;
        make_busy(shot, blur);
        shot.options.samples = 4;
        const int knots = moves(blur) ? 3 : 1;
        const auto ribbon = [](float u, float v, int k) {
            return Vec3f(3 * u - 1.5f + .2f * static_cast<float>(k),
                         .2f * v + .5f * std::sin(5 * u + static_cast<float>(k)), 9 + u);
        };
        for (const int rows : {1, 2})
            expect_holds_brute_force(shot, make_grid(90, rows, knots, ribbon));
        // 100 squares that share no vertices (Grid::disjoint).
        Grid apart = make_grid(1, 1, 1, ribbon);
        apart.n_u = 100;
        apart.disjoint = true;
        apart.knots = knots;
        apart.motion = knots > 1;
        apart.positions.clear();
        for (int k = 0; k < knots; ++k)
            for (int corner = 0; corner < 4; ++corner)
                for (int m = 0; m < 100; ++m) {
                    const auto x = static_cast<float>(m % 10 + corner % 2);
                    const auto y = static_cast<float>(m / 10 + corner / 2);
                    apart.positions.emplace_back(.2f * x - 1 + .3f * static_cast<float>(k),
                                                 .2f * y - 1, 8 + .1f * static_cast<float>(m % 7));
                }
        apart.radiance.assign(static_cast<std::size_t>(apart.vertex_count()), Vec3f(1));
        expect_holds_brute_force(shot, apart);
    }
}

TEST(GridSweep, VerticesThatAreNotFiniteBoundNothing) {
    Shot shot;
    shot.options.samples = 4;
    Grid grid = rectangle(2, 2, 14, 14, 5, 12, 12);
    grid.positions[40] = Vec3f(NAN);
    grid.positions[100] = Vec3f(INFINITY);
    expect_holds_brute_force(shot, grid);
    const GridSweep sweep(grid, shot.camera.projection, LensShape(0, 0.0f, Vec2f(1.0f)));
    for (std::size_t p = 0; p < sweep.parts().size(); ++p) {
        // A hundredth of a pixel for what bounds may grow.
        EXPECT_GE(sweep.bounds(p, 0).x0, 1.99f);
        EXPECT_LE(sweep.bounds(p, 0).x1, 14.01f);
    }
}

}  // namespace
}  // namespace granita::test
