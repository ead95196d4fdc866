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

/// Projection::homogeneous of `count` points, bit for bit.
void project_vertices(const Projection& projection, const Vec2d& origin, std::size_t count,
                      const CameraPoints& from, const HomogeneousPoints& to);

/// The corners as SimdGrid::corners, `count` of them from `first` on.
void interleave_corners(const SimdGrid& grid, std::size_t first, std::size_t count, float* corners);

}  // namespace granita
