// SPDX-License-Identifier: GPL-3.0-or-later
// Grids and filters for the tests of the raster executor.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "dice/grid.h"
#include "gl/gl_thread.h"
#include "hider/raster/raster_hider.h"
#include "hider/samples/sample_table.h"
#include "math/projection.h"
#include "measured.h"

namespace granita::raster_test {

/// One context for the whole program.
inline gl::GlThread& gl_thread() {
    static gl::GlThread thread({.debug = true});
    return thread;
}

/// Camera space is raster space: 1 m = 1 pixel, z is the depth.
inline Projection pixel_projection() {
    Projection p;
    p.perspective = false;
    p.near_clip = 0.1;
    p.far_clip = 100.0;
    return p;
}

/// 90 degrees over `width` pixels.
inline Projection perspective_projection(int width, int height) {
    Projection p;
    p.scale = Vec2d(0.5 * width);
    p.center = {0.5 * width, 0.5 * height};
    p.near_clip = 0.1;
    p.far_clip = 100.0;
    return p;
}

using Surface = std::function<Vec3f(float u, float v)>;

/// A grid over [0, 1]^2 of a surface in camera space, white unless `color` says else.
inline Grid make_grid(
    std::uint32_t key, int n_u, int n_v, const Surface& surface,
    const Surface& color = [](float, float) { return Vec3f(1.0f); }) {
    Grid grid;
    grid.key.instance = key;
    grid.n_u = n_u;
    grid.n_v = n_v;
    for (int j = 0; j <= n_v; ++j)
        for (int i = 0; i <= n_u; ++i) {
            const float u = static_cast<float>(i) / n_u, v = static_cast<float>(j) / n_v;
            grid.positions.push_back(surface(u, v));
            grid.radiance.push_back(color(u, v));
        }
    // Bounds only cull: the whole plane is always right.
    const float inf = std::numeric_limits<float>::infinity();
    grid.bounds = {-inf, -inf, inf, inf, inf, true};
    return grid;
}

/// The rectangle [x0, x1] x [y0, y1] at depth z.
inline Grid make_rectangle(std::uint32_t key, float x0, float y0, float x1, float y1, float z,
                           int n_u = 1, int n_v = 1, const Vec3f& color = Vec3f(1.0f)) {
    // Written so that 0 and 1 give the corners exactly.
    return make_grid(
        key, n_u, n_v,
        [=](float u, float v) { return Vec3f(x0 * (1 - u) + x1 * u, y0 * (1 - v) + y1 * v, z); },
        [=](float, float) { return color; });
}

/// Radiance stays what it is: it is premultiplied.
inline void set_opacity(Grid& grid, const Vec3f& opacity) {
    grid.opacity_varies = true;
    grid.opacity.assign(static_cast<std::size_t>(grid.vertex_count()), opacity);
}

/// Adds knots: the whole grid shifted by each of `shifts` after the first knot.
inline void set_motion(Grid& grid, const std::vector<Vec3f>& shifts) {
    const std::vector<Vec3f> still = grid.positions;
    for (const Vec3f& shift : shifts)
        for (const Vec3f& p : still) grid.positions.push_back(p + shift);
    grid.p = still;
    grid.knots = 1 + static_cast<int>(shifts.size());
    grid.motion = true;
}

inline std::vector<const Grid*> pointers(const std::vector<Grid>& grids) {
    std::vector<const Grid*> list;
    for (const Grid& grid : grids) list.push_back(&grid);
    return list;
}

inline RasterFilter box_filter(RegularLattice lattice) {
    return make_raster_filter(lattice, 0.5,
                              [](double d) { return std::abs(d) <= 0.5 ? 1.0 : 0.0; });
}

inline double mitchell(double d) {
    const double x = std::abs(d), b = 1.0 / 3.0, c = 1.0 / 3.0;
    if (x >= 2.0) return 0.0;
    if (x >= 1.0)
        return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x +
                (8 * b + 24 * c)) /
               6.0;
    return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6.0;
}

}  // namespace granita::raster_test
