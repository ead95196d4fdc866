// SPDX-License-Identifier: GPL-3.0-or-later
// One grid against the samples of one tile, compiled for every SIMD target and chosen at run time
// (Highway).  All targets give the same bits: no fused operations, no sums over lanes.
#pragma once

#include <cstdint>
#include <vector>

#include "hider/micropolygon.h"
#include "hider/sample_store.h"
#include "math/bounds.h"

namespace granita {

/// Arrays that are read in whole vectors end in this many spare elements.
inline constexpr int kLanePadding = 16;

/// What a tile's samples are sorted by inside each pixel, so that a micropolygon finds those that
/// can see it: time where anything moves, else the lens coordinate u where there is a lens.
enum class SortedBy { Table, Time, Lens };

/// Samples of a tile, pixel by pixel.
struct SimdTile {
    int samples = 0;  ///< a pixel
    const float *x = nullptr, *y = nullptr, *t = nullptr;
    const float *u = nullptr, *v = nullptr;  ///< times lens radius and scale: pixels per unit shear
    float* key = nullptr;
    SurfaceId* id = nullptr;
    SortedBy sorted_by = SortedBy::Table;
    /// [256][cells + 1]: first of the pixel's samples in each cell of time or of u, which run from
    /// the shutter's opening, and from -SimdGrid::lens_x.
    const std::uint32_t* cell_start = nullptr;
    int cells = 0;
    Rect pixels;  ///< that count, relative to the tile
};

/// A grid in a tile's homogeneous raster space.
struct SimdGrid {
    const float *x = nullptr, *y = nullptr, *w = nullptr, *z = nullptr;  ///< [knots][vertices]
    /// [max(1, knots - 1)][vertices] raster bounds of a vertex over the segment and the lens.
    const float *x_lo = nullptr, *x_hi = nullptr, *y_lo = nullptr, *y_hi = nullptr;
    int n_u = 0, n_v = 0, vertices = 0;
    int segments = 0;  ///< knots - 1; 0 = static
    const std::uint8_t* classes = nullptr;
    SurfaceId base = 0;
    const GridPool* pool = nullptr;
    DepthRange range;
    float inverse_focus = 0.0f;
    float lens_x = 0.0f, lens_y = 0.0f;  ///< largest |u|, |v| of SimdTile; 0 = no lens
};

struct SimdCounts {
    std::uint64_t tests = 0, hits = 0, writes = 0;
};

/// Opaque hits go into the tile's key and id; transparent ones that are not behind them into
/// `fragments`, whose sample counts in the tile's order.
void hide_grid_in_tile(const SimdGrid& grid, const SimdTile& tile, std::vector<Fragment>& fragments,
                       SimdCounts& counts);

}  // namespace granita
