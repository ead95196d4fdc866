// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/compute/compute_sweep.h"

#include <algorithm>
#include <cmath>

namespace granita {
namespace {

/// Grows the interval by the part of [0, 1] where the linear function with these end values is not
/// negative.
void extend(float f0, float f1, Interval& to) {
    if (f0 < 0.0f && f1 < 0.0f) return;
    const float root = f0 / (f0 - f1);
    to.from = std::min(to.from, f0 >= 0.0f ? 0.0f : root);
    to.to = std::max(to.to, f1 >= 0.0f ? 1.0f : root);
}

}  // namespace

MicropolygonSweep::MicropolygonSweep(const SimdGrid& grid, const int vertex[4], int segment) {
    const bool moving = grid.segments > 0;
    for (int k = 0; k < 4; ++k) {
        const std::size_t a = static_cast<std::size_t>(segment) * grid.vertices + vertex[k];
        const std::size_t b = moving ? a + grid.vertices : a;
        const float shear = std::max(grid.most_shear(grid.z[a]), grid.most_shear(grid.z[b]));
        // 1/256 pixel and a few ulp of far positions: more than rounding can move an offset.
        const float w_margin = std::max(std::fabs(grid.w[a]), std::fabs(grid.w[b])) / 256;
        const float x_margin = std::max(std::fabs(grid.x[a]), std::fabs(grid.x[b])) * 0x1p-21f;
        const float y_margin = std::max(std::fabs(grid.y[a]), std::fabs(grid.y[b])) * 0x1p-21f;
        m_x[k] = {grid.x[a], grid.x[b], grid.w[a], grid.w[b], w_margin + x_margin};
        m_y[k] = {grid.y[a], grid.y[b], grid.w[a], grid.w[b],
                  w_margin + y_margin + grid.lens_y * shear};
        if (moving) {
            m_x[k].margin += grid.lens_x * shear;
        } else {
            // At a focus x + u shear is linear in u, as it is in time above; other focuses are
            // within the margin of that in the middle.
            const float middle = 0.5f * (grid.inverse_focus + grid.inverse_farthest);
            const float sheared = grid.lens_x * (grid.z[a] * middle - 1.0f);
            m_x[k].p0 -= sheared;
            m_x[k].p1 += sheared;
            m_x[k].margin += grid.lens_x * std::fabs(grid.z[a]) * 0.5f *
                             (grid.inverse_focus - grid.inverse_farthest);
        }
    }
    if (moving) {
        m_scale = 1.0f / static_cast<float>(grid.segments);
        m_first = static_cast<float>(segment) * m_scale;
    } else {
        m_scale = 2.0f * grid.lens_x;
        m_first = -grid.lens_x;
    }
}

// A sample is inside a triangle only if the offsets p - x w of its corners do not all have one sign
// (2-D homogeneous rasterization).  An offset is linear in the parameter, and in x, whose extremes
// over [low, high] lie at either end, as w's sign says (Laine, Aila, Karras and Lehtinen 2011).
Interval MicropolygonSweep::over(const Path paths[4], float low, float high) const {
    Interval above{INFINITY, -INFINITY}, below{INFINITY, -INFINITY};
    for (int k = 0; k < 4; ++k) {
        const Path& c = paths[k];
        for (const float x : {low, high}) {
            const float d0 = c.p0 - x * c.w0, d1 = c.p1 - x * c.w1;
            extend(d0 + c.margin, d1 + c.margin, above);
            extend(c.margin - d0, c.margin - d1, below);
        }
    }
    return {std::max(above.from, below.from), std::min(above.to, below.to)};
}

Rect MicropolygonSweep::pixels(const Rect& within) const {
    float x0 = INFINITY, y0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
    const auto add = [](const Path& path, float p, float w, float& lo, float& hi) {
        lo = std::min(lo, (p - path.margin) / w);
        hi = std::max(hi, (p + path.margin) / w);
    };
    for (int k = 0; k < 4; ++k) {
        if (!(m_x[k].w0 > 0.0f && m_x[k].w1 > 0.0f)) return within;
        add(m_x[k], m_x[k].p0, m_x[k].w0, x0, x1);
        add(m_x[k], m_x[k].p1, m_x[k].w1, x0, x1);
        add(m_y[k], m_y[k].p0, m_y[k].w0, y0, y1);
        add(m_y[k], m_y[k].p1, m_y[k].w1, y0, y1);
    }
    // Clamped before the conversion, which overflows otherwise.
    const auto pixel = [](float x) {
        return static_cast<int>(std::floor(std::min(std::max(x, -1.0f), 32.0f)));
    };
    return within.intersect({pixel(x0), pixel(y0), pixel(x1) + 1, pixel(y1) + 1});
}

Interval MicropolygonSweep::over(const Rect& pixels) const {
    if (m_scale == 0.0f) return {};
    const auto edge = [](int pixel) { return static_cast<float>(pixel); };
    const Interval in_x = over(m_x, edge(pixels.x0), edge(pixels.x1));
    const Interval in_y = over(m_y, edge(pixels.y0), edge(pixels.y1));
    const float from = std::max(in_x.from, in_y.from), to = std::min(in_x.to, in_y.to);
    // The parameter is exact to a few ulp of 1.
    const float wider = 0x1p-20f;
    if (from > to + 2.0f * wider) return {INFINITY, -INFINITY};
    const float margin = std::fabs(m_first) * 0x1p-20f;
    return {m_first + (from - wider) * m_scale - margin, m_first + (to + wider) * m_scale + margin};
}

}  // namespace granita
