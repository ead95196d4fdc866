// SPDX-License-Identifier: GPL-3.0-or-later
// Boxes.  An empty box has lo > hi.
#pragma once

#include <limits>

#include "math/vec.h"

namespace granita {

struct Bounds3f {
    Vec3f lo{std::numeric_limits<float>::infinity()};
    Vec3f hi{-std::numeric_limits<float>::infinity()};

    bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
    void add(const Vec3f& p) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    void add(const Bounds3f& b) {
        lo = glm::min(lo, b.lo);
        hi = glm::max(hi, b.hi);
    }
    bool holds(const Vec3f& p) const {
        return glm::all(glm::greaterThanEqual(p, lo)) && glm::all(glm::lessThanEqual(p, hi));
    }
    void grow(float d) {
        lo -= Vec3f(d);
        hi += Vec3f(d);
    }
    /// By a part of the largest coordinate: what rounding may move.
    void grow_relative(float part) {
        if (empty()) return;
        const Vec3f largest = glm::max(glm::abs(lo), glm::abs(hi));
        grow(part * glm::max(largest.x, glm::max(largest.y, largest.z)));
    }
};

/// Half-open rectangle of whole pixels (or tiles, or buckets) in the frame; lower-left origin, may
/// be negative (the filter's margin reaches outside the frame).
struct Rect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool empty() const { return x0 >= x1 || y0 >= y1; }
    bool holds(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
    Rect intersect(const Rect& r) const {
        return {x0 > r.x0 ? x0 : r.x0, y0 > r.y0 ? y0 : r.y0, x1 < r.x1 ? x1 : r.x1,
                y1 < r.y1 ? y1 : r.y1};
    }
    bool operator==(const Rect&) const = default;
};

/// Where a thing can be seen: its swept raster bound over the whole shutter and lens, and its
/// nearest depth key.
struct RasterBounds {
    float x0 = 0, y0 = 0, x1 = 0,
          y1 = 0;  ///< pixels, frame raster space; +-inf on the sides that the eye plane unbounds
    float nearest_key = 0;  ///< largest depth key it can produce (see Projection::depth_key)
    bool visible = false;   ///< false: wholly behind the near clip, beyond the far clip or empty
};

}  // namespace granita
