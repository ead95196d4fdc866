// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/micropolygon_class.h"

#include <algorithm>

#include "hider/micropolygon.h"
#include "math/point_span.h"
#include "math/saturate.h"

namespace granita {
namespace {

std::uint8_t opacity_class(const Grid& grid, const Grid::Corners& c) {
    bool opaque = true, clear = true;
    for (const int v : {c.v0, c.v1, c.v2, c.v3})
        for (int channel = 0; channel < 3; ++channel) {
            opaque = opaque && grid.opacity[v][channel] >= 1.0f;
            clear = clear && grid.opacity[v][channel] <= 0.0f;
        }
    if (opaque) return kTriangleA | kTriangleB;
    if (clear && !grid.additive) return 0;
    return kTriangleA | kTriangleB | kTransparent;
}

OpacityBounds opacity_bounds(const Grid& grid, const Grid::Corners& c) {
    // Interpolation may round this far past a corner.
    constexpr float kRounding = 0x1p-20f;
    OpacityBounds bounds{1.0f, 0.0f};
    for (const int v : {c.v0, c.v1, c.v2, c.v3}) {
        float sum = 0.0f;
        for (int channel = 0; channel < 3; ++channel) {
            const float x = grid.opacity[v][channel];
            const float a = saturate(x);
            bounds.least = std::min(bounds.least, a);
            sum += a;
        }
        bounds.most = std::max(bounds.most, sum / 3.0f);
    }
    return {bounds.least * (1.0f - kRounding), bounds.most * (1.0f + kRounding)};
}

}  // namespace

GridClasses classify(const Grid& grid) {
    const int vertices = grid.vertex_count(), up = grid.up();
    const int knots = grid.motion ? grid.knots : 1;
    const bool all_finite =
        are_finite({grid.positions.data(),
                    static_cast<std::size_t>(knots) * static_cast<std::size_t>(vertices)});
    const auto finite = [&](int v) {
        for (int k = 0; k < knots; ++k)
            if (!is_finite(grid.positions[k * vertices + v])) return false;
        return true;
    };
    const auto coincide = [&](int a, int b) {
        for (int k = 0; k < knots; ++k)
            if (grid.positions[k * vertices + a] != grid.positions[k * vertices + b]) return false;
        return true;
    };

    GridClasses out;
    out.classes.resize(grid.micropolygon_count());
    for (int j = 0, m = 0; j < grid.n_v; ++j)
        for (int i = 0; i < grid.n_u; ++i, ++m) {
            const int v0 = j * up + i;
            const Grid::Corners c{v0, v0 + grid.right(), v0 + grid.right() + up, v0 + up};
            if (!all_finite && !(finite(c.v0) && finite(c.v1) && finite(c.v2) && finite(c.v3))) {
                ++out.dropped;
                out.common = 0;
                continue;
            }
            const bool unsettled =
                !grid.unsettled_opacity.empty() && grid.unsettled_opacity[m] != 0;
            std::uint8_t kind = kTriangleA | kTriangleB;
            if (unsettled)
                kind |= kTransparent;
            else if (grid.opacity_varies)
                kind = opacity_class(grid, c);
            const bool diagonal = coincide(c.v0, c.v2);
            if (diagonal || coincide(c.v0, c.v1) || coincide(c.v1, c.v2)) kind &= ~kTriangleA;
            if (diagonal || coincide(c.v2, c.v3) || coincide(c.v3, c.v0)) kind &= ~kTriangleB;
            if ((kind & (kTriangleA | kTriangleB)) == 0) kind = 0;
            out.classes[m] = kind;
            out.common &= kind;
            out.occurring |= kind;
            if (!(kind & kTransparent)) continue;
            if (out.opacity.empty()) out.opacity.resize(out.classes.size());
            out.opacity[m] = unsettled ? OpacityBounds{} : opacity_bounds(grid, c);
        }
    return out;
}

}  // namespace granita
