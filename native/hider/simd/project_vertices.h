// SPDX-License-Identifier: GPL-3.0-or-later
// A grid's vertices to a tile, compiled for every SIMD target; the same bits on all.
#pragma once

#include <cstddef>

#include "hider/simd/simd_kernel.h"
#include "math/projection.h"

namespace granita {

struct CameraPoints {
    const float *x, *y, *z;
};
struct HomogeneousPoints {
    float *x, *y, *w;
};
/// Arrays of one segment.
struct VertexBounds {
    float *x_lo, *x_hi, *y_lo, *y_hi, *nearest;
};

/// Projection::homogeneous of `count` points, bit for bit.
void project_vertices(const Projection& projection, const Vec2d& origin, std::size_t count,
                      const CameraPoints& from, const HomogeneousPoints& to);

/// Raster bounds of every vertex over a segment and the lens, and its nearest depth key.  A vertex
/// at or behind the eye plane may be anywhere.
void bound_vertices(const SimdGrid& grid, int segment, bool perspective, const VertexBounds& to);

/// Of a part of the grid during a segment, by the bounds of its vertices.
struct PartBounds {
    float x_lo, x_hi, y_lo, y_hi, nearest;
};
PartBounds bound_part(const SimdGrid& grid, const Patch& part, int segment);

/// The corners as SimdGrid::corners, `count` of them from `first` on.
void interleave_corners(const SimdGrid& grid, std::size_t first, std::size_t count, float* corners);

}  // namespace granita
