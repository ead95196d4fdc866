// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes on which executors are held against each other sample by sample, and the comparison.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <random>

#include "grid_builder.h"

namespace granita::test {

enum Blur { kStatic, kMoving, kLens, kBoth, kRackFocus, kAllMoves };

inline bool moves(Blur blur) {
    return blur == kMoving || blur == kBoth || blur == kAllMoves;
}
inline bool has_lens(Blur blur) {
    return blur != kStatic && blur != kMoving;
}

/// Eight bent, overlapping, partly transparent grids in front of a perspective camera; where they
/// move they turn by `swing` radians in so many segments.
inline void make_busy(Shot& shot, Blur blur, unsigned seed = 3, int segments = 2,
                      float swing = 1.0f) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    shot.options.samples = 16;
    shot.tiles = {-1, -1, 2, 2};
    shot.camera = pinhole_camera(120);
    if (has_lens(blur)) {
        shot.camera.projection.lens_radius = .15;
        shot.camera.projection.focus = 11;
    }
    if (blur == kRackFocus || blur == kAllMoves)
        shot.camera.lens = LensKnots({{.05, 14}, {.15, 11}, {.2, 8}}, shot.camera.projection);
    for (int g = 0; g < 8; ++g) {
        const float x = -2 + 3 * uniform(random), y = -2 + 3 * uniform(random);
        const float z = 8 + 6 * uniform(random), turn = 6 * uniform(random);
        const float dx = uniform(random) - .5f, dz = 2 * uniform(random) - 1;
        const int knots = moves(blur) ? segments + 1 : 1;
        shot.grids.push_back(make_grid(17, 13, knots, [=](float u, float v, int k) {
            const float t = static_cast<float>(k) / static_cast<float>(segments);
            const float a = 3 * (u - .5f), b = 2.4f * (v - .5f), angle = turn + swing * t;
            return Vec3f(x + a * std::cos(angle) - b * std::sin(angle) + 1.5f * dx * t,
                         y + a * std::sin(angle) + b * std::cos(angle) + dx * t * t,
                         z + a * .6f + std::sin(4 * u + 3 * v) * .4f + dz * t);
        }));
        Grid& grid = shot.grids.back();
        set_color(grid, Vec3f(uniform(random)), g % 2 ? Vec3f(.4f) : Vec3f(1.0f));
    }
}

/// A tile of a TileStore, its lists by sample.
struct SeenTile {
    Vec2i tile;
    std::vector<float> key;
    std::vector<SurfaceId> id;
    std::vector<std::vector<Fragment>> lists;
};

struct Seen {
    std::vector<SeenTile> stores;
    std::vector<TileSamples> samples;
};

inline Seen look(HiderMaker make, Shot& shot, const Rect& tiles) {
    const SampleTable table(shot.options, shot.camera);
    const HiderFrame frame{&table, shot.camera.projection, &shot.statistics};
    const auto hider =
        make(frame, tiles, {tiles.x0 * 16, tiles.y0 * 16, tiles.x1 * 16, tiles.y1 * 16});
    for (const Grid& grid : shot.grids) hider->hide(grid);
    Seen seen;
    for (TileStore& store : hider->finish())
        seen.stores.push_back({store.tile, store.key, store.id, lists_of(store)});
    for (std::size_t i = 0; i < seen.stores.size(); ++i)
        seen.samples.push_back(hider->tile_samples(i));
    return seen;
}

inline int ulps(float a, float b) {
    if (!std::isfinite(a) || !std::isfinite(b)) return a == b ? 0 : 1 << 30;
    return std::abs(std::bit_cast<int>(a) - std::bit_cast<int>(b));
}

/// Distance in pixels from the sample to the nearest edge of the micropolygon, in double.
inline double edge_distance(const Shot& shot, const TileSamples& samples, Vec2i tile,
                            std::uint32_t i, SurfaceId id) {
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
        if (projection.has_lens()) {
            const double focus =
                samples.inverse_focus.empty() ? projection.focus : 1.0 / samples.inverse_focus[i];
            lens = projection.lens_radius * (q.z / focus - 1) * Vec2d(samples.u[i], samples.v[i]);
        }
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

struct Differences {
    int compared = 0, other_surface = 0, other_fragments = 0;
    int unexplained = 0;  ///< not within 2^-12 pixel of an edge, nor within 4 ulp of each other
    int far_keys = 0;     ///< the same surface more than 4 ulp apart
};

inline std::vector<Fragment> by_id(std::vector<Fragment> out) {
    std::sort(out.begin(), out.end(), [](auto& a, auto& b) { return a.id < b.id; });
    return out;
}

inline Differences compare(const Shot& shot, const Seen& a, const Seen& b) {
    // A sample may differ where it lies within 2^-12 pixel of an edge of what either has seen.
    const double margin = 0x1p-12;
    Differences d;
    for (std::size_t tile = 0; tile < a.stores.size(); ++tile) {
        const SeenTile &p = a.stores[tile], &q = b.stores[tile];
        const auto near_edge = [&](std::uint32_t i, SurfaceId id) {
            return id != kNoSurface && edge_distance(shot, b.samples[tile], p.tile, i, id) < margin;
        };
        for (std::uint32_t i = 0; i < p.key.size(); ++i) {
            ++d.compared;
            const bool same_surface = p.id[i] == q.id[i];
            if (!same_surface) {
                ++d.other_surface;
                d.unexplained += !near_edge(i, p.id[i]) && !near_edge(i, q.id[i]) &&
                                 ulps(p.key[i], q.key[i]) > 4;
            } else {
                d.far_keys += ulps(p.key[i], q.key[i]) > 4;
            }
            const std::vector<Fragment> in_p = by_id(p.lists[i]), in_q = by_id(q.lists[i]);
            auto f = in_p.begin(), g = in_q.begin();
            while (f != in_p.end() || g != in_q.end()) {
                if (f != in_p.end() && g != in_q.end() && f->id == g->id) {
                    d.far_keys += ulps((f++)->key, (g++)->key) > 4;
                    continue;
                }
                const bool take_p = g == in_q.end() || (f != in_p.end() && f->id < g->id);
                const SurfaceId id = take_p ? (f++)->id : (g++)->id;
                ++d.other_fragments;
                d.unexplained += !near_edge(i, id) && same_surface;
            }
        }
    }
    return d;
}

/// A quarter as many hits and as many fragments as samples: there was something to compare.
inline void expect_busy(const Seen& seen, int samples) {
    std::size_t hits = 0, fragments = 0;
    for (const SeenTile& store : seen.stores) {
        for (const SurfaceId id : store.id) hits += id != kNoSurface;
        for (const auto& list : store.lists) fragments += list.size();
    }
    EXPECT_GT(hits, static_cast<std::size_t>(samples) / 4);
    EXPECT_GT(fragments, static_cast<std::size_t>(samples) / 4);
}

/// Bit for bit, fragments in their order too.
inline void expect_equal(const SeenTile& a, const SeenTile& b) {
    ASSERT_EQ(a.key, b.key);
    ASSERT_EQ(a.id, b.id);
    for (std::size_t i = 0; i < a.lists.size(); ++i) {
        ASSERT_EQ(a.lists[i].size(), b.lists[i].size());
        for (std::size_t k = 0; k < a.lists[i].size(); ++k) {
            const Fragment &f = a.lists[i][k], &g = b.lists[i][k];
            ASSERT_EQ(f.key, g.key);
            ASSERT_EQ(f.id, g.id);
            ASSERT_EQ(f.signed_b1, g.signed_b1);
            ASSERT_EQ(f.b2, g.b2);
        }
    }
}

}  // namespace granita::test
