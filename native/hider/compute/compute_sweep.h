// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hider/simd/simd_kernel.h"

namespace granita {

/// Empty where from > to.
struct Interval {
    float from = -INFINITY, to = INFINITY;
};

/// A micropolygon over one segment of its motion, or over the lens.
class MicropolygonSweep {
  public:
    MicropolygonSweep(const SimdGrid& grid, const int vertex[4], int segment);
    /// When a sample in the pixels (relative to the tile) may be inside: shutter time where the
    /// grid moves; else the lens coordinate u, pixels per unit shear; else always.
    Interval over(const Rect& pixels) const;
    /// Those of `within` that samples may be inside of it in, at any time and lens coordinate.
    Rect pixels(const Rect& within) const;

  private:
    /// One raster coordinate and w of a corner at both ends of the parameter.
    struct Path {
        float p0, p1, w0, w1, margin;
    };
    Interval over(const Path paths[4], float low, float high) const;

    Path m_x[4], m_y[4];
    float m_first = 0.0f, m_scale = 0.0f;  ///< the coordinate at parameter 0, and its range; 0: any
};

}  // namespace granita
