// SPDX-License-Identifier: GPL-3.0-or-later
// Compute shaders against the SIMD executor sample by sample, and against themselves under other
// limits, buckets and orders.
#include <gtest/gtest.h>

#include <array>
#include <list>

#include "base/error.h"
#include "compute_executor.h"
#include "hider/busy_scene.h"

namespace granita::test {
namespace {

class ComputeAgrees : public testing::TestWithParam<Blur> {};
INSTANTIATE_TEST_SUITE_P(Blurs, ComputeAgrees,
                         testing::Values(kStatic, kMoving, kLens, kBoth, kRackFocus, kAllMoves));

TEST_P(ComputeAgrees, SampleBySampleWithSimd) {
    Shot shot;
    make_busy(shot, GetParam());
    const Seen simd = look(make_simd_hider, shot, shot.tiles);
    const Seen compute = look(make_device_hider, shot, shot.tiles);
    const Differences d = compare(shot, simd, compute);
    EXPECT_EQ(d.unexplained, 0);
    EXPECT_EQ(d.far_keys, 0);
    // Coverage is the same arithmetic: only depths within an ulp of each other, where surfaces
    // meet, may fall differently.
    EXPECT_LE(d.other_surface, d.compared / 10000);
    EXPECT_LE(d.other_fragments, d.compared / 10000);
    RecordProperty("compared", d.compared);
    RecordProperty("other_surface", d.other_surface);
    RecordProperty("other_fragments", d.other_fragments);
    expect_busy(compute, d.compared);
}

TEST_P(ComputeAgrees, SplitWorkChangesNoBit) {
    Shot shot;
    make_busy(shot, GetParam());
    const Seen whole = look(make_device_hider, shot, shot.tiles);
    const std::uint64_t dispatches = shot.statistics.get(Counter::GlDispatches);
    const Seen split = look(make_small_device_hider, shot, shot.tiles);
    for (std::size_t i = 0; i < whole.stores.size(); ++i)
        expect_equal(whole.stores[i], split.stores[i]);
    EXPECT_GT(shot.statistics.get(Counter::GlDispatches), 5 * dispatches);
}

TEST_P(ComputeAgrees, BucketsAndOrderChangeNoBit) {
    Shot shot;
    make_busy(shot, GetParam());
    const Seen whole = look(make_device_hider, shot, shot.tiles);
    for (const std::size_t i : {0u, 4u, 8u}) {
        const Vec2i tile = whole.stores[i].tile;
        expect_equal(
            whole.stores[i],
            look(make_device_hider, shot, {tile.x, tile.y, tile.x + 1, tile.y + 1}).stores[0]);
    }
    const Picture before = render(make_device_hider, shot);
    std::shuffle(shot.grids.begin(), shot.grids.end(), std::mt19937(4));
    EXPECT_EQ(render(make_device_hider, shot).combined, before.combined);
}

TEST(Compute, StillAndMovingGridsMeetInOneBatch) {
    Shot shot, moving;
    make_busy(shot, kLens);
    make_busy(moving, kBoth, 5);
    shot.grids.insert(shot.grids.end(), moving.grids.begin(), moving.grids.end());
    const Seen simd = look(make_simd_hider, shot, shot.tiles);
    for (const HiderMaker make : {make_device_hider, make_small_device_hider}) {
        const Differences d = compare(shot, simd, look(make, shot, shot.tiles));
        EXPECT_EQ(d.unexplained, 0);
        EXPECT_EQ(d.far_keys, 0);
        EXPECT_LE(d.other_surface + d.other_fragments, d.compared / 10000);
    }
}

TEST(Compute, MovesThroughTheEyePlane) {
    // Corners on both sides of the eye: the intervals of time must hold for w of either sign.
    for (const bool lens : {false, true}) {
        int hits = 0, different = 0;
        for (unsigned seed = 1; seed <= 20; ++seed) {
            std::mt19937 random(seed);
            std::uniform_real_distribution<float> uniform(-1, 1);
            Shot shot;
            shot.options.samples = 16;
            shot.tiles = {-1, -1, 1, 1};
            shot.camera = pinhole_camera(20);
            if (lens) {
                shot.camera.projection.lens_radius = .05;
                shot.camera.projection.focus = 3;
            }
            shot.grids.push_back(make_grid(1, 1, 2, [&](float, float, int) {
                const float x = 4 * uniform(random), y = 4 * uniform(random);
                return Vec3f(x, y, 2 + 5 * uniform(random));
            }));
            const Seen reference = look(make_reference_hider, shot, shot.tiles);
            const Seen compute = look(make_device_hider, shot, shot.tiles);
            for (std::size_t tile = 0; tile < reference.stores.size(); ++tile)
                for (std::size_t i = 0; i < reference.stores[tile].id.size(); ++i) {
                    const SurfaceId expected = reference.stores[tile].id[i];
                    hits += expected != kNoSurface;
                    different += compute.stores[tile].id[i] != expected;
                }
        }
        EXPECT_GT(hits, 50000);
        // Reference tests in double; float offsets move an edge by less than 2^-12 pixel.
        EXPECT_LE(different, hits / 10000);
    }
}

TEST(Compute, TheCpuTestsNoSample) {
    Shot shot;
    make_busy(shot, kBoth);
    look(make_device_hider, shot, shot.tiles);
    EXPECT_GT(shot.statistics.get(Counter::GlDispatches), 0u);
    EXPECT_GT(shot.statistics.get(Counter::FragmentsStored), 0u);
    EXPECT_EQ(shot.statistics.get(Counter::SampleTestsStatic), 0u);
    EXPECT_EQ(shot.statistics.get(Counter::SampleTestsMoving), 0u);
}

TEST(Compute, TiesGoToTheSmallerKeyWhateverArrivesFirst) {
    // Four coincident sheets; equal keys in batches of their own and together.
    for (const HiderMaker make : {make_device_hider, make_small_device_hider}) {
        Shot shot;
        shot.options.samples = 16;
        for (int i = 0; i < 4; ++i) shot.grids.push_back(rectangle(-1, -1, 17, 17, 5, 9, 9));
        const GridKey least = shot.grids[0].key;
        for (const auto& order : {std::array{0, 1, 2, 3}, {3, 2, 1, 0}, {2, 0, 3, 1}}) {
            const SampleTable table(shot.options, shot.camera);
            const HiderFrame frame{&table, shot.camera.projection};
            const auto hider = make(frame, shot.tiles, {0, 0, 16, 16});
            for (const int i : order) hider->hide(shot.grids[i]);
            for (const SurfaceId id : hider->finish()[0].id) {
                ASSERT_NE(id, kNoSurface);
                ASSERT_TRUE(hider->pool().locate(id).grid->key == least);
            }
        }
    }
}

TEST(Compute, NoFragmentIsLostWhereTheyFillSeveralBuffers) {
    Shot shot;
    shot.options.samples = 16;
    for (int i = 0; i < 8; ++i) {
        shot.grids.push_back(rectangle(-1, -1, 17, 17, 5.0f + static_cast<float>(i), 2, 2));
        set_color(shot.grids.back(), Vec3f(1), Vec3f(.5f));
    }
    const auto layers = layers_per_sample(make_small_device_hider, shot);
    EXPECT_EQ(layers, std::vector<int>(256 * 16, 8));
    // Counted once and filled in four parts of at most 100,000 / 12 fragments; no farthest keys,
    // since nothing comes after them that they could hide.
    EXPECT_EQ(shot.statistics.get(Counter::GlDispatches), 5u);
}

TEST(Compute, ListsOfTheLastBatchAreHeldToTheirMemoryToo) {
    Shot shot;
    shot.options.samples = 16;
    std::list<Grid> grids;
    for (int i = 0; i < 8; ++i) {
        grids.push_back(rectangle(-1, -1, 17, 17, 5.0f + static_cast<float>(i), 2, 2));
        set_color(grids.back(), Vec3f(1), Vec3f(.5f));
    }
    const SampleTable table(shot.options, shot.camera);
    HiderFrame frame{&table, shot.camera.projection};
    frame.statistics = &shot.statistics;
    frame.list_bytes = 1;
    const auto hider = make_device_hider(frame, {0, 0, 1, 1}, {0, 0, 16, 16});
    for (const Grid& grid : grids) hider->hide(grid);
    const auto& stores = hider->finish();
    EXPECT_TRUE(hider->overflowed());
    EXPECT_TRUE(stores[0].lists.empty());
    EXPECT_GT(shot.statistics.peak_list_bytes(), 0u);
}

TEST(Compute, CullsWhatIsHiddenAndNothingElse) {
    Shot shot;
    shot.options.samples = 16;
    std::list<Grid> grids;  // a hider refers to what it has hidden
    const auto keep = [&](Grid grid) -> const Grid& { return grids.emplace_back(std::move(grid)); };
    const SampleTable table(shot.options, shot.camera);
    const HiderFrame frame{&table, shot.camera.projection};
    const Rect tiles{0, 0, 2, 2}, pixels{0, 0, 32, 32};
    const RasterBounds behind{3, 3, 20, 20, -9, true}, before{3, 3, 20, 20, -4, true};
    const RasterBounds outside{-20, 3, -4, 20, -4, true};
    // Small batches: what is still on its way hides nothing.
    const auto hider = make_small_device_hider(frame, tiles, pixels);
    EXPECT_FALSE(hider->occluded(behind));
    hider->hide(keep(rectangle(-1, -1, 33, 33, 5, 32, 32)));
    hider->hide(keep(rectangle(-1, -1, 33, 33, 6, 32, 32)));
    EXPECT_TRUE(hider->occluded(behind));
    EXPECT_FALSE(hider->occluded(before));
    EXPECT_TRUE(hider->occluded(outside));
    // A wall with a hole of one pixel hides nothing that covers the hole.
    const auto holed = make_small_device_hider(frame, tiles, pixels);
    for (const float z : {5.0f, 6.0f}) {
        holed->hide(keep(rectangle(-1, -1, 33, 10, z, 32, 32)));
        holed->hide(keep(rectangle(-1, 11, 33, 33, z, 32, 32)));
        holed->hide(keep(rectangle(-1, 10, 10, 11, z, 32, 2)));
        holed->hide(keep(rectangle(11, 10, 33, 11, z, 32, 2)));
    }
    EXPECT_FALSE(holed->occluded(behind));
    EXPECT_TRUE(holed->occluded(RasterBounds{16, 16, 30, 30, -9, true}));
    // A moving wall that leaves its pixels hides nothing; transparent ones neither.
    const auto moving = make_small_device_hider(frame, tiles, pixels);
    for (const float z : {5.0f, 6.0f})
        moving->hide(keep(moving_rectangle(-1, -1, 33, 33, z, 40, 0, 32, 32)));
    for (int i = 0; i < 2; ++i) {
        Grid glass = rectangle(-1, -1, 33, 33, 5, 32, 32);
        set_color(glass, Vec3f(1), Vec3f(.9f));
        moving->hide(keep(glass));
    }
    EXPECT_FALSE(moving->occluded(behind));
}

TEST(Compute, TooManySamplesAreRefusedByName) {
    Shot shot;
    shot.options.samples = 4096;
    const SampleTable table(shot.options, shot.camera);
    const HiderFrame frame{&table, shot.camera.projection};
    EXPECT_THROW(make_small_device_hider(frame, shot.tiles, {0, 0, 16, 16}), GlError);
}

}  // namespace
}  // namespace granita::test
