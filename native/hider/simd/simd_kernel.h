// SPDX-License-Identifier: GPL-3.0-or-later
// One grid against the samples of one tile, compiled for every SIMD target and chosen at run time
// (Highway).  All targets give the same bits: no fused operations, no sums over lanes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "hider/grid_sweep.h"
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
    bool stratified = false;
    int blocks_wide = 0, strata = 0;         ///< blocks in a row of the tile; slots of a block
    int stratum_stride = 0;                  ///< SampleOrder::stratum_stride
    const std::uint32_t* packets = nullptr;  ///< SampleOrder::packets
    const StratumBounds* bounds = nullptr;
    // Hierarchical depth (DepthBlocks), maybe out of date.
    const float* farthest_of_packets = nullptr;
    const float* farthest_of_strata = nullptr;
    float nearest_of_strata = 0.0f;
    int square_shift = 0, squares_wide = 0;
};

/// A part of a grid during a segment of its motion.
struct PartSegment {
    GridPart part;
    int segment;
};

/// A grid in a tile's homogeneous raster space: the vertices of `parts` at the knots of their
/// segments, others are anything.
struct SimdGrid {
    const float *x = nullptr, *y = nullptr, *w = nullptr, *z = nullptr;  ///< [knots][vertices]
    const float* corners = nullptr;      ///< [knots][vertices][x, y, w, z]; none of what is still
    std::span<const PartSegment> parts;  ///< those that may touch the tile
    int n_u = 0, n_v = 0, vertices = 0;
    int right = 1, up = 0;  ///< Grid::right(), Grid::up()
    int segments = 0;       ///< knots - 1; 0 = static
    bool finite = true;     ///< all vertices, at all knots
    Lifespan lifespan;      ///< Grid::lifespan
    const std::uint8_t* classes = nullptr;
    std::uint8_t common = 0, occurring = 0;  ///< bits that all classes have, and that any has
    SurfaceId base = 0;
    const GridPool* pool = nullptr;
    DepthRange range;
    float inverse_focus = 0.0f,
          inverse_farthest = 0.0f;       ///< 1 / the nearest and the farthest focus
    float lens_x = 0.0f, lens_y = 0.0f;  ///< largest |u|, |v| of SimdTile; 0 = no lens

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
