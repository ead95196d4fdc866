// SPDX-License-Identifier: GPL-3.0-or-later
// One table, several ways to loop over it: SIMD against reference sample by sample, SIMD targets
// against each other, buckets against each other.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <list>
#include <random>

#include "grid_builder.h"

namespace granita::test {
namespace {

enum Blur { kStatic, kMoving, kLens, kBoth };

/// Eight bent, overlapping, partly transparent grids with three knots in front of a perspective
/// camera;
void make_busy(Shot& shot, Blur blur, unsigned seed = 3) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    shot.options.samples = 16;
    shot.tiles = {-1, -1, 2, 2};
    shot.camera = pinhole_camera(120);
    if (blur == kLens || blur == kBoth) {
        shot.camera.projection.lens_radius = .15;
        shot.camera.projection.focus = 11;
    }
    for (int g = 0; g < 8; ++g) {
        const float x = -2 + 3 * uniform(random), y = -2 + 3 * uniform(random);
        const float z = 8 + 6 * uniform(random), turn = 6 * uniform(random);
        const float dx = uniform(random) - .5f, dz = 2 * uniform(random) - 1;
        const int knots = blur == kMoving || blur == kBoth ? 3 : 1;
        shot.grids.push_back(make_grid(17, 13, knots, [=](float u, float v, int k) {
            const auto t = static_cast<float>(k) / 2;
            const float a = 3 * (u - .5f), b = 2.4f * (v - .5f), angle = turn + t;
            return Vec3f(x + a * std::cos(angle) - b * std::sin(angle) + 1.5f * dx * t,
                         y + a * std::sin(angle) + b * std::cos(angle) + dx * t * t,
                         z + a * .6f + std::sin(4 * u + 3 * v) * .4f + dz * t);
        }));
        Grid& grid = shot.grids.back();
        set_color(grid, Vec3f(uniform(random)), g % 2 ? Vec3f(.4f) : Vec3f(1.0f));
    }
}

struct Seen {
    std::vector<TileStore> stores;
    std::vector<TileSamples> samples;
};

Seen look(HiderMaker make, Shot& shot, const Rect& tiles) {
    const SampleTable table(shot.options, shot.camera);
    const HiderFrame frame{&table, shot.camera.projection, &shot.statistics};
    const auto hider =
        make(frame, tiles, {tiles.x0 * 16, tiles.y0 * 16, tiles.x1 * 16, tiles.y1 * 16});
    for (const Grid& grid : shot.grids) hider->hide(grid);
    Seen seen;
    seen.stores = hider->finish();
    for (std::size_t i = 0; i < seen.stores.size(); ++i)
        seen.samples.push_back(hider->tile_samples(i));
    for (TileStore& store : seen.stores)
        std::sort(store.fragments.begin(), store.fragments.end(),
                  [](const Fragment& a, const Fragment& b) {
                      return a.sample != b.sample ? a.sample < b.sample : a.id < b.id;
                  });
    return seen;
}

int ulps(float a, float b) {
    if (!std::isfinite(a) || !std::isfinite(b)) return a == b ? 0 : 1 << 30;
    return std::abs(std::bit_cast<int>(a) - std::bit_cast<int>(b));
}

/// Distance in pixels from the sample to the nearest edge of the micropolygon, in double.
double edge_distance(const Shot& shot, const TileSamples& samples, Vec2i tile, std::uint32_t i,
                     SurfaceId id) {
    const int per_grid = shot.grids[0].micropolygon_count();
    const Grid& grid = shot.grids[id / per_grid];
    const Grid::Corners c = grid.corners(static_cast<int>(id % per_grid));
    const Projection& projection = shot.camera.projection;
    const int vertex[4] = {c.v0, c.v1, c.v2, c.v3};
    Vec2d p[4];
    for (int k = 0; k < 4; ++k) {
        Vec3d q = grid.positions[vertex[k]];
        if (grid.motion) {
            const double place = static_cast<double>(samples.t[i]) * (grid.knots - 1);
            const int segment = std::min(static_cast<int>(place), grid.knots - 2);
            const Vec3d a = grid.positions[segment * grid.vertex_count() + vertex[k]];
            const Vec3d b = grid.positions[(segment + 1) * grid.vertex_count() + vertex[k]];
            q = a + (place - segment) * (b - a);
        }
        Vec2d lens(0);
        if (projection.has_lens())
            lens = projection.lens_radius * (q.z / projection.focus - 1) *
                   Vec2d(samples.u[i], samples.v[i]);
        p[k] = projection.center + projection.scale * (Vec2d(q) + lens) / q.z - Vec2d(tile * 16);
    }
    const Vec2d s(samples.x[i], samples.y[i]);
    double least = INFINITY;
    for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}}) {
        const Vec2d along = p[b] - p[a];
        const double t = glm::clamp(glm::dot(s - p[a], along) / glm::dot(along, along), 0.0, 1.0);
        least = std::min(least, glm::length(s - p[a] - t * along));
    }
    return least;
}

class ExecutorsAgree : public testing::TestWithParam<Blur> {};
INSTANTIATE_TEST_SUITE_P(Blurs, ExecutorsAgree, testing::Values(kStatic, kMoving, kLens, kBoth));

TEST_P(ExecutorsAgree, SampleBySample) {
    Shot shot;
    make_busy(shot, GetParam());
    const Seen a = look(make_reference_hider, shot, shot.tiles);
    const Seen b = look(make_simd_hider, shot, shot.tiles);
    // A sample may differ where it lies within 2^-12 pixel of an edge of what either has seen.
    const double margin = 0x1p-12;
    int compared = 0, other_surface = 0, other_fragments = 0, unexplained = 0, far_keys = 0;
    for (std::size_t tile = 0; tile < a.stores.size(); ++tile) {
        const TileStore &p = a.stores[tile], &q = b.stores[tile];
        const auto near_edge = [&](std::uint32_t i, SurfaceId id) {
            return id != kNoSurface && edge_distance(shot, b.samples[tile], p.tile, i, id) < margin;
        };
        std::size_t f = 0, g = 0;
        for (std::uint32_t i = 0; i < p.key.size(); ++i) {
            ++compared;
            const bool same_surface = p.id[i] == q.id[i];
            if (!same_surface) {
                ++other_surface;
                unexplained += !near_edge(i, p.id[i]) && !near_edge(i, q.id[i]) &&
                               ulps(p.key[i], q.key[i]) > 4;
            } else {
                far_keys += ulps(p.key[i], q.key[i]) > 4;
            }
            while ((f < p.fragments.size() && p.fragments[f].sample == i) ||
                   (g < q.fragments.size() && q.fragments[g].sample == i)) {
                const bool in_p = f < p.fragments.size() && p.fragments[f].sample == i;
                const bool in_q = g < q.fragments.size() && q.fragments[g].sample == i;
                if (in_p && in_q && p.fragments[f].id == q.fragments[g].id) {
                    far_keys += ulps(p.fragments[f++].key, q.fragments[g++].key) > 4;
                    continue;
                }
                const bool take_p = in_p && (!in_q || p.fragments[f].id < q.fragments[g].id);
                const SurfaceId id = take_p ? p.fragments[f++].id : q.fragments[g++].id;
                ++other_fragments;
                unexplained += !near_edge(i, id) && same_surface;
            }
        }
    }
    EXPECT_EQ(unexplained, 0);
    EXPECT_EQ(far_keys, 0);
    // Within 2^-12 pixel of an edge lies a share of about 4 edges a pixel times 2^-11.
    EXPECT_LT(other_surface + other_fragments, compared * 4.0 * 8 / 2048);
    RecordProperty("compared", compared);
    RecordProperty("other_surface", other_surface);
    RecordProperty("other_fragments", other_fragments);
    std::size_t hits = 0, fragments = 0;  // the scene is not empty
    for (const TileStore& store : b.stores) {
        for (const SurfaceId id : store.id) hits += id != kNoSurface;
        fragments += store.fragments.size();
    }
    EXPECT_GT(hits, static_cast<std::size_t>(compared) / 4);
    EXPECT_GT(fragments, static_cast<std::size_t>(compared) / 4);
}

void expect_equal(const TileStore& a, const TileStore& b) {
    ASSERT_EQ(a.key, b.key);
    ASSERT_EQ(a.id, b.id);
    ASSERT_EQ(a.fragments.size(), b.fragments.size());
    for (std::size_t i = 0; i < a.fragments.size(); ++i) {
        ASSERT_EQ(a.fragments[i].key, b.fragments[i].key);
        ASSERT_EQ(a.fragments[i].sample, b.fragments[i].sample);
        ASSERT_EQ(a.fragments[i].id, b.fragments[i].id);
    }
}

TEST_P(ExecutorsAgree, AllSimdTargetsMakeTheSameBits) {
    Shot shot;
    make_busy(shot, GetParam(), 8);
    shot.options.samples = 9;  // no multiple of any vector
    const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
    ASSERT_FALSE(targets.empty());
    std::vector<Seen> seen;
    for (const std::int64_t target : targets) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        seen.push_back(look(make_simd_hider, shot, shot.tiles));
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    for (std::size_t target = 1; target < seen.size(); ++target)
        for (std::size_t i = 0; i < seen[0].stores.size(); ++i)
            expect_equal(seen[0].stores[i], seen[target].stores[i]);
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
    EXPECT_TRUE(holed->occluded({16, 16, 30, 30, -9, true}));
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
