// SPDX-License-Identifier: GPL-3.0-or-later
// One grid against the samples of one tile, compiled for every SIMD target and chosen at run time
// (Highway).  All targets give the same bits: no fused operations, no sums over lanes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "hider/micropolygon.h"
#include "hider/sample_store.h"
#include "hider/simd/depth_blocks.h"
#include "scene/lifespan.h"

namespace granita {

/// Arrays that are read in whole vectors end in this many spare elements.
inline constexpr int kLanePadding = 16;

/// Samples of a tile in the order of SampleOrder.  A slot without sample has NaN for a place.
struct SimdTile {
    const float *x = nullptr, *y = nullptr, *t = nullptr;
    const float *u = nullptr, *v = nullptr;  ///< times lens radius and scale: pixels per unit shear
    const float* inverse_focus = nullptr;    ///< where SimdGrid::refocuses()
    float* key = nullptr;
    SurfaceId* id = nullptr;
    bool ranked = false;
    int blocks_wide = 0, ranks = 0;          ///< blocks in a row of the tile; slots of a block
    int rank_stride = 0;                     ///< SampleOrder::rank_stride
    const std::uint32_t* packets = nullptr;  ///< SampleOrder::packets
    const RankBounds* bounds = nullptr;
    // Hierarchical depth (DepthBlocks), maybe out of date.
    const float* farthest_of_packets = nullptr;
    const float* farthest_of_ranks = nullptr;
    float nearest_of_ranks = 0.0f;
    int square_shift = 0, squares_wide = 0;
};

/// A rectangle of micropolygons of a grid.
struct Patch {
    int i, j, n_u, n_v;  ///< the first, and how many
};

/// Segments of a grid's motion, one after the other.
struct Segments {
    static constexpr int kMost = 4;  ///< that something may be looked at together during
    int first, count;
};

/// What is looked at together of a grid, during some segments.
struct GridPart {
    /// Of grids of up to kNarrow rows all rows, kMostInRows micropolygons at most.  Of others kHigh
    /// rows: what is swept in squares, what is still as wide as vectors.
    static constexpr int kNarrow = 2, kMostInRows = 64, kHigh = 8, kSwept = kHigh, kStill = 16;
    Patch patch;
    Segments segments;
    float nearest;  ///< no sample sees a nearer key
};

/// A grid in a tile's homogeneous raster space: the vertices of `parts`, others are anything.
struct SimdGrid {
    const float *x = nullptr, *y = nullptr, *w = nullptr, *z = nullptr;  ///< [knots][vertices]
    const float* corners = nullptr;  ///< [knots][vertices][x, y, w, z]; none of what is still
    /// [max(1, knots - 1)][vertices] bounds of a vertex over the segment and the lens in the
    /// frame's raster, and its nearest key; of all vertices.
    const float *x_lo = nullptr, *x_hi = nullptr, *y_lo = nullptr, *y_hi = nullptr;
    const float* nearest = nullptr;
    float origin_x = 0.0f, origin_y = 0.0f;  ///< of the tile
    std::span<const GridPart> parts;         ///< those that may touch the tile
    int n_u = 0, n_v = 0, vertices = 0;
    int right = 1, up = 0;    ///< Grid::right(), Grid::up()
    int segments = 0;         ///< knots - 1; 0 = static
    int* together = nullptr;  ///< segments that its way has turned out to be straight enough for
    bool finite = true;       ///< all vertices, at all knots
    Lifespan lifespan;        ///< Grid::lifespan
    const std::uint8_t* classes = nullptr;
    std::uint8_t common = 0, occurring = 0;  ///< bits that all classes have, and that any has
    SurfaceId base = 0;
    const GridPool* pool = nullptr;
    DepthRange range;
    float inverse_focus = 0.0f,
          inverse_farthest = 0.0f;       ///< 1 / the nearest and the farthest focus
    float lens_x = 0.0f, lens_y = 0.0f;  ///< largest |u|, |v| of SimdTile; 0 = no lens

    /// Calls visit(first, count) for the runs of vertices that the corners of a part are.
    template <class Visit>
    void for_each_run(const Patch& part, Visit visit) const {
        if (right > 1) {  // separate micropolygons: four runs of corners
            for (int corner = 0; corner < 4; ++corner) visit(corner * right + part.i, part.n_u);
        } else if (part.n_u == n_u) {
            visit(part.j * up, (part.n_v + 1) * up);
        } else {
            for (int j = part.j; j <= part.j + part.n_v; ++j) visit(j * up + part.i, part.n_u + 1);
        }
    }

    bool refocuses() const { return inverse_farthest < inverse_focus; }
    /// Largest |z / focus - 1|.
    float most_shear(float z) const {
        const float near = std::fabs(z * inverse_focus - 1.0f);
        return refocuses() ? std::max(near, std::fabs(z * inverse_farthest - 1.0f)) : near;
    }
};

/// What a kernel is compiled for: a pinhole; a lens whose focus stands still (it may open and
/// close: samples know); one whose samples have a focus each.
enum class Lens { None, Still, Refocused };

struct SimdCounts {
    std::uint64_t tests = 0, hits = 0, writes = 0, fragments = 0;
};

/// Opaque hits go into the tile's key and id; transparent ones that are not behind them into
/// `lists`, whose slots are the tile's.
void hide_grid_in_tile(const SimdGrid& grid, const SimdTile& tile, FragmentLists& lists,
                       SimdCounts& counts);

}  // namespace granita
