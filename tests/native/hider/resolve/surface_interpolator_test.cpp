// SPDX-License-Identifier: GPL-3.0-or-later
// Sixteen samples at a time give the bits of one at a time.
#include "hider/resolve/surface_interpolator.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <set>

#include "hider/grid_builder.h"

namespace granita {
namespace {

using test::make_grid;

bool same(const SurfacePoint& a, const SurfacePoint& b) {
    return a.grid == b.grid && std::equal(a.vertex, a.vertex + 3, b.vertex) &&
           std::equal(a.weight, a.weight + 3, b.weight);
}

/// Every sample against a micropolygon of its own choice, hit or not: nearest points, folds and
/// samples on edges are among them.
void expect_runs_equal_singles(const Camera& camera, const Grid& grid, bool on_lattice) {
    GridPool pool;
    pool.add(grid);
    Options options;
    options.samples = 16;
    options.sampling = on_lattice ? Sampling::Regular : Sampling::Independent;
    TileSamples samples;
    SampleTable(options, camera).fill_tile({0, 0}, {true, camera.projection.has_lens()}, samples);
    std::mt19937 random(5);
    std::vector<SurfaceId> ids;
    for (std::size_t i = 0; i < samples.x.size(); ++i) {
        const int x = std::clamp(static_cast<int>(samples.x[i]), 0, grid.n_u - 1);
        const int y = std::clamp(static_cast<int>(samples.y[i]), 0, grid.n_v - 1);
        const unsigned what = random() % 8;
        ids.push_back(what == 0   ? kNoSurface
                      : what == 1 ? random() % grid.micropolygon_count()
                                  : static_cast<SurfaceId>(y * grid.n_u + x));
    }
    SurfaceInterpolator one(camera.projection, {0, 0}, samples, pool);
    SurfaceInterpolator many(camera.projection, {0, 0}, samples, pool);
    std::size_t located = 0;
    for (std::uint32_t first = 0; first < ids.size(); first += SurfaceRun::kCount) {
        SurfaceRun run;
        many.locate_run(first, &ids[first], true, run);
        for (std::uint32_t i = 0; i < SurfaceRun::kCount; ++i) {
            if (!(run.plain >> i & 1u)) continue;
            ++located;
            const SurfacePoint point = one.locate(first + i, ids[first + i]);
            ASSERT_TRUE(same(run.point(static_cast<int>(i)), point)) << first + i;
            const Vec3f color = point(grid.radiance);
            for (int channel = 0; channel < 3; ++channel)
                ASSERT_EQ(run.color[channel][i], color[channel]) << first + i;
        }
    }
    EXPECT_GT(located, ids.size() / 8);  // jitter folds and misplaces the others
    // Colours alone: of a micropolygon with one colour they are known without a place, and the
    // same.
    std::size_t constant = 0;
    for (std::uint32_t first = 0; first < ids.size(); first += SurfaceRun::kCount) {
        SurfaceRun run;
        many.locate_run(first, &ids[first], false, run);
        for (std::uint32_t i = 0; i < SurfaceRun::kCount; ++i) {
            if (!(run.plain >> i & 1u)) continue;
            const Vec3f color = one.locate(first + i, ids[first + i])(grid.radiance);
            for (int channel = 0; channel < 3; ++channel)
                ASSERT_EQ(run.color[channel][i], color[channel]) << first + i;
            if (static_cast<int>(ids[first + i]) % grid.n_u >= grid.n_u / 2) continue;
            ++constant;
            ASSERT_EQ(run.color[0][i], 0.1f);
        }
    }
    EXPECT_GT(constant, ids.size() / 4);
    // Surface by surface: the same samples, the same colours.
    SurfaceGroups groups;
    SampleColors colors(ids.size());
    std::vector<std::uint8_t> done(ids.size(), 0);
    ASSERT_TRUE(groups.sort(ids, done));
    groups.take_samples(samples);
    many.color_groups(groups, colors, done);
    for (std::uint32_t first = 0; first < ids.size(); first += SurfaceRun::kCount) {
        SurfaceRun run;
        one.locate_run(first, &ids[first], false, run);
        for (std::uint32_t i = 0; i < SurfaceRun::kCount; ++i) {
            ASSERT_EQ(done[first + i], (run.plain & run.colored) >> i & 1u) << first + i;
            if (!done[first + i]) continue;
            ASSERT_EQ(colors[first + i].color,
                      Vec3f(run.color[0][i], run.color[1][i], run.color[2][i]))
                << first + i;
        }
    }
}

TEST(SurfaceGroups, hold_every_sample_once_under_its_surface) {
    std::mt19937 random(8);
    std::vector<SurfaceId> ids;
    for (int i = 0; i < 5000; ++i)
        ids.push_back(random() % 5 == 0 ? kNoSurface : random() % 700 * 8192);
    std::vector<std::uint8_t> done(ids.size(), 0);
    for (std::size_t s = 0; s < done.size(); s += 7) done[s] = 1;
    SurfaceGroups groups;
    for (int round = 0; round < 2; ++round) {  // again with what the first left in it
        ASSERT_TRUE(groups.sort(ids, done));
        std::vector<SurfaceId> found(ids.size(), kNoSurface);
        std::set<SurfaceId> surfaces;
        for (std::size_t g = 0; g < groups.size(); ++g) {
            EXPECT_TRUE(surfaces.insert(groups.id(g)).second);
            EXPECT_TRUE(std::ranges::is_sorted(groups.samples(g)));
            for (const std::int32_t s : groups.samples(g))
                found[static_cast<std::size_t>(s)] = groups.id(g);
        }
        for (std::size_t s = 0; s < ids.size(); ++s)
            EXPECT_EQ(found[s], done[s] ? kNoSurface : ids[s]) << s;
        ids.resize(300);
    }
    ids.resize(5000);
    std::iota(ids.begin(), ids.end(), 0u);
    std::ranges::fill(done, 0);
    EXPECT_FALSE(groups.sort(ids, done));
}

Grid jittered(int knots, float jitter, float z) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> at(-jitter, jitter);
    Grid grid = make_grid(16, 16, knots, [&](float u, float v, int) {
        return Vec3f(u * 16 + at(random), v * 16 + at(random), z + at(random));
    });
    // The left half has one colour.
    std::uniform_real_distribution<float> light(0.0f, 3.0f);
    for (int vertex = 0; vertex < grid.vertex_count(); ++vertex)
        grid.radiance[vertex] = vertex % (grid.n_u + 1) <= grid.n_u / 2
                                    ? Vec3f(0.1f, 0.7f, 3.3f)
                                    : Vec3f(light(random), light(random), light(random));
    return grid;
}

TEST(SurfaceInterpolator, RunsEqualSingles) {
    expect_runs_equal_singles(test::pixel_camera(), jittered(1, 0.9f, 5), false);
}

TEST(SurfaceInterpolator, RunsEqualSinglesOnEdges) {
    // Lattice samples at odd eighths; corners on whole pixels: diagonals hit samples exactly.
    expect_runs_equal_singles(test::pixel_camera(), jittered(1, 0.0f, 5), true);
}

TEST(SurfaceInterpolator, RunsEqualSinglesInMotion) {
    expect_runs_equal_singles(test::pixel_camera(), jittered(3, 0.9f, 5), false);
}

TEST(SurfaceInterpolator, RunsEqualSinglesThroughALens) {
    Camera camera = test::pinhole_camera(10);
    camera.projection.lens_radius = 0.3;
    camera.projection.focus = 7.0;
    expect_runs_equal_singles(camera, jittered(2, 0.9f, 10), false);
}

}  // namespace
}  // namespace granita
