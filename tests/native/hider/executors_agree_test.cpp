// SPDX-License-Identifier: GPL-3.0-or-later
// One table, several ways to loop over it: SIMD against reference sample by sample, SIMD targets
// against each other, buckets against each other.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <list>
#include <random>

#include "busy_scene.h"

namespace granita::test {
namespace {

class ExecutorsAgree : public testing::TestWithParam<Blur> {};
INSTANTIATE_TEST_SUITE_P(Blurs, ExecutorsAgree,
                         testing::Values(kStatic, kMoving, kLens, kBoth, kRackFocus, kAllMoves));

TEST_P(ExecutorsAgree, SampleBySample) {
    Shot shot;
    make_busy(shot, GetParam());
    const Seen a = look(make_reference_hider, shot, shot.tiles);
    const Seen b = look(make_simd_hider, shot, shot.tiles);
    const auto [compared, other_surface, other_fragments, unexplained, far_keys] =
        compare(shot, a, b);
    EXPECT_EQ(unexplained, 0);
    EXPECT_EQ(far_keys, 0);
    // Within 2^-12 pixel of an edge lies a share of about 4 edges a pixel times 2^-11.
    EXPECT_LT(other_surface + other_fragments, compared * 4.0 * 8 / 2048);
    RecordProperty("compared", compared);
    RecordProperty("other_surface", other_surface);
    RecordProperty("other_fragments", other_fragments);
    expect_busy(b, compared);
}

TEST_P(ExecutorsAgree, FastAndThroughTheEye) {
    // Paths of a hundred pixels and more, bent by perspective: the depth grows fourfold, shrinks to
    // a quarter, or passes the eye.
    for (const auto& [z0, z1] : {std::pair{4.0f, 16.0f}, {12.0f, 3.0f}, {5.0f, -1.0f}}) {
        Shot shot;
        shot.options.samples = 64;
        shot.tiles = {0, 0, 2, 2};
        shot.camera = pinhole_camera(120);
        shot.camera.projection.lens_radius = has_lens(GetParam()) ? .1 : 0;
        shot.camera.projection.focus = 7;
        if (GetParam() == kRackFocus || GetParam() == kAllMoves)
            shot.camera.lens = LensKnots({{.1, 7}, {.05, 3}}, shot.camera.projection);
        const int knots = moves(GetParam()) ? 2 : 1;
        for (int g = 0; g < 3; ++g)
            shot.grids.push_back(make_grid(9, 9, knots, [&](float u, float v, int k) {
                const float z = k ? z1 : z0;
                return Vec3f(2 * u - 2.5f + g + 1.5f * static_cast<float>(k), 2 * v - 1.2f,
                             z + u * (g - 1) + v);
            }));
        const Seen a = look(make_reference_hider, shot, shot.tiles);
        const Seen b = look(make_simd_hider, shot, shot.tiles);
        const auto [compared, other_surface, other_fragments, unexplained, far_keys] =
            compare(shot, a, b);
        EXPECT_EQ(unexplained, 0) << z0;
        // At the eye a depth is a difference of depths: an ulp of those is many of its own.
        if (z1 > 0) {
            EXPECT_EQ(far_keys, 0) << z0;
        }
        EXPECT_LT(other_surface, compared * 4.0 * 8 / 2048) << z0;
        std::size_t hits = 0;
        for (const SeenTile& store : b.stores)
            for (const SurfaceId id : store.id) hits += id != kNoSurface;
        EXPECT_GT(hits, static_cast<std::size_t>(compared) / 20) << z0;
    }
}

/// The same micropolygons without a common vertex.
Grid take_apart(const Grid& grid) {
    Grid apart = grid;
    apart.n_u = grid.micropolygon_count();
    apart.n_v = 1;
    apart.disjoint = true;
    apart.positions.clear();
    apart.opacity.clear();
    for (int knot = 0; knot < grid.knots; ++knot)
        for (const auto corner :
             {&Grid::Corners::v0, &Grid::Corners::v1, &Grid::Corners::v3, &Grid::Corners::v2})
            for (int m = 0; m < grid.micropolygon_count(); ++m) {
                const int vertex = grid.corners(m).*corner;
                apart.positions.push_back(grid.positions[knot * grid.vertex_count() + vertex]);
                if (knot == 0 && grid.opacity_varies) apart.opacity.push_back(grid.opacity[vertex]);
            }
    apart.radiance.assign(apart.vertex_count(), Vec3f(1.0f));
    return apart;
}

TEST_P(ExecutorsAgree, TogetherAndApart) {
    for (const float spread : {1.0f, 0.3f, 4.0f}) {
        Shot together, apart;
        for (Shot* shot : {&together, &apart}) {
            make_busy(*shot, GetParam(), 5);
            for (Grid& grid : shot->grids)  // smaller and larger micropolygons, slower and faster
                for (Vec3f& p : grid.positions) p *= Vec3f(spread, spread, 1);
        }
        for (Grid& grid : apart.grids) grid = take_apart(grid);
        const Seen a = look(make_simd_hider, together, together.tiles);
        const Seen b = look(make_simd_hider, apart, apart.tiles);
        for (std::size_t i = 0; i < a.stores.size(); ++i) expect_equal(a.stores[i], b.stores[i]);
        // The smallest bend by more than half of one, and are looked for one by one anyway.
        if (GetParam() == kStatic || spread < 1.0f) continue;
        EXPECT_NE(together.statistics.get(Counter::SampleTestsMoving),
                  apart.statistics.get(Counter::SampleTestsMoving))
            << "they were to be found in two ways, spread " << spread;
    }
}

/// The last micropolygon of a grid that is apart is nowhere: a point or, not being a number, left
/// out, which has the others looked for one by one.
void remove_last(Grid& grid, bool has_place) {
    const int vertices = grid.vertex_count();
    for (int knot = 0; knot < grid.knots; ++knot)
        for (int corner = 1; corner <= 4; ++corner)
            grid.positions[knot * vertices + corner * grid.n_u - 1] =
                has_place ? grid.positions[knot * vertices] : Vec3f(NAN);
}

TEST_P(ExecutorsAgree, ClustersAndOneByOne) {
    for (const float spread : {1.0f, 0.3f, 4.0f}) {
        Shot clusters, alone;
        for (Shot* shot : {&clusters, &alone}) {
            make_busy(*shot, GetParam(), 5);
            shot->options.samples = 8;  // few: without a lens more do not pay for clusters
            for (Grid& grid : shot->grids) {
                for (Vec3f& p : grid.positions) p *= Vec3f(spread, spread, 1);
                grid = take_apart(grid);
                remove_last(grid, shot == &clusters);
            }
        }
        const Seen a = look(make_simd_hider, clusters, clusters.tiles);
        const Seen b = look(make_simd_hider, alone, alone.tiles);
        for (std::size_t i = 0; i < a.stores.size(); ++i) expect_equal(a.stores[i], b.stores[i]);
        if (GetParam() == kStatic) continue;
        EXPECT_NE(clusters.statistics.get(Counter::SampleTestsMoving),
                  alone.statistics.get(Counter::SampleTestsMoving))
            << "they were to be found in two ways, spread " << spread;
    }
}

/// Flat, on an arc.
void bend_way(Grid& grid) {
    const auto vertices = static_cast<std::size_t>(grid.vertex_count());
    for (std::size_t i = 0; i < grid.positions.size(); ++i) {
        const float t = static_cast<float>(i / vertices) / static_cast<float>(grid.knots - 1);
        grid.positions[i].y += .6f * t * (1 - t);
        grid.positions[i].z = grid.positions[0].z;
    }
}

TEST_P(ExecutorsAgree, TurnsOfManySegmentsTogetherAndOneByOne) {
    if (!moves(GetParam())) GTEST_SKIP() << "nothing moves";
    // Few samples see each of 16 segments.
    for (const float swing : {0.0f, 0.25f, 1.0f}) {
        Shot patches, clusters, all_but_one, alone;
        for (Shot* shot : {&patches, &clusters, &all_but_one, &alone}) {
            make_busy(*shot, GetParam(), 5, 16, swing);
            shot->options.samples = 4;
            for (Grid& grid : shot->grids) {
                bend_way(grid);
                if (shot == &patches) continue;
                grid = take_apart(grid);
                if (shot != &clusters) remove_last(grid, shot == &all_but_one);
            }
        }
        for (const auto& [one, other] : {std::pair{&patches, &clusters}, {&all_but_one, &alone}}) {
            const Seen a = look(make_simd_hider, *one, one->tiles);
            const Seen b = look(make_simd_hider, *other, other->tiles);
            for (std::size_t i = 0; i < a.stores.size(); ++i)
                expect_equal(a.stores[i], b.stores[i]);
            EXPECT_NE(one->statistics.get(Counter::SampleTestsMoving),
                      other->statistics.get(Counter::SampleTestsMoving))
                << "they were to be found in two ways";
        }
    }
}

TEST_P(ExecutorsAgree, AllSimdTargetsMakeTheSameBits) {
    Shot shot;
    make_busy(shot, GetParam(), 8);
    shot.options.samples = 9;  // no multiple of any vector
    const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
    ASSERT_FALSE(targets.empty());
    std::vector<Seen> seen;
    std::vector<Picture> pictures;
    for (const std::int64_t target : targets) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        seen.push_back(look(make_simd_hider, shot, shot.tiles));
        pictures.push_back(render(make_simd_hider, shot));
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    for (std::size_t target = 1; target < seen.size(); ++target)
        for (std::size_t i = 0; i < seen[0].stores.size(); ++i)
            expect_equal(seen[0].stores[i], seen[target].stores[i]);
    for (const Picture& picture : pictures) EXPECT_EQ(picture.combined, pictures[0].combined);
    RecordProperty("targets", static_cast<int>(targets.size()));
}

TEST_P(ExecutorsAgree, BucketsChangeNoBit) {
    for (const HiderMaker make : {make_reference_hider, make_simd_hider}) {
        Shot shot;
        make_busy(shot, GetParam());
        const Seen whole = look(make, shot, shot.tiles);
        std::size_t i = 0;
        for (int y = shot.tiles.y0; y < shot.tiles.y1; ++y)
            for (int x = shot.tiles.x0; x < shot.tiles.x1; ++x, ++i)
                expect_equal(whole.stores[i], look(make, shot, {x, y, x + 1, y + 1}).stores[0]);
    }
}

TEST_P(ExecutorsAgree, OrderOfArrivalChangesNoPixel) {
    for (const HiderMaker make : {make_reference_hider, make_simd_hider}) {
        Shot shot;
        make_busy(shot, GetParam());
        const Picture before = render(make, shot);
        std::shuffle(shot.grids.begin(), shot.grids.end(), std::mt19937(4));
        const Picture after = render(make, shot);
        for (std::size_t i = 0; i < before.combined.size(); ++i)
            ASSERT_EQ(before.combined[i], after.combined[i]);
    }
}

TEST(Occlusion, CullsWhatIsHiddenAndNothingElse) {
    Shot shot;
    std::list<Grid> grids;  // a hider refers to what it has hidden
    const auto keep = [&](Grid grid) -> const Grid& { return grids.emplace_back(std::move(grid)); };
    const SampleTable table(shot.options, shot.camera);
    const HiderFrame frame{&table, shot.camera.projection};
    const auto hider = make_simd_hider(frame, {0, 0, 2, 2}, {0, 0, 32, 32});
    const RasterBounds behind{3, 3, 20, 20, -9, true}, before{3, 3, 20, 20, -4, true};
    const RasterBounds outside{-20, 3, -4, 20, -4, true};
    EXPECT_FALSE(hider->occluded(behind));
    hider->hide(keep(rectangle(-1, -1, 33, 33, 5, 32, 32)));
    EXPECT_TRUE(hider->occluded(behind));
    EXPECT_FALSE(hider->occluded(before));
    EXPECT_TRUE(hider->occluded(outside));
    // A wall with a hole of one pixel hides nothing that covers the hole.
    const auto holed = make_simd_hider(frame, {0, 0, 2, 2}, {0, 0, 32, 32});
    holed->hide(keep(rectangle(-1, -1, 33, 10, 5, 32, 32)));
    holed->hide(keep(rectangle(-1, 11, 33, 33, 5, 32, 32)));
    holed->hide(keep(rectangle(-1, 10, 10, 11, 5, 32, 2)));
    holed->hide(keep(rectangle(11, 10, 33, 11, 5, 32, 2)));
    EXPECT_FALSE(holed->occluded(behind));
    EXPECT_TRUE(holed->occluded(RasterBounds{16, 16, 30, 30, -9, true}));
    // A moving wall that leaves its pixels hides nothing; transparent ones neither.
    const auto moving = make_simd_hider(frame, {0, 0, 2, 2}, {0, 0, 32, 32});
    moving->hide(keep(moving_rectangle(-1, -1, 33, 33, 5, 40, 0, 32, 32)));
    Grid glass = rectangle(-1, -1, 33, 33, 5, 32, 32);
    set_color(glass, Vec3f(1), Vec3f(.9f));
    moving->hide(keep(glass));
    EXPECT_FALSE(moving->occluded(behind));
}

TEST(Statistics, CountsWhatItSays) {
    Shot shot;
    shot.grids.push_back(rectangle(2, 2, 10, 10, 5, 8, 8));
    render(make_simd_hider, shot);
    EXPECT_EQ(shot.statistics.get(Counter::Micropolygons), 64u);
    EXPECT_EQ(shot.statistics.get(Counter::SampleHits), 64u * 64);  // every sample inside, once
    EXPECT_GE(shot.statistics.get(Counter::SampleTestsStatic), 64u * 64);
    EXPECT_LE(shot.statistics.get(Counter::SampleTestsStatic), 9u * 64 * 64);
    EXPECT_EQ(shot.statistics.get(Counter::SampleTestsMoving), 0u);
    EXPECT_EQ(shot.statistics.get(Counter::FragmentsStored), 0u);
}

}  // namespace
}  // namespace granita::test
