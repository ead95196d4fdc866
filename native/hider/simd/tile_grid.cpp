// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd/tile_grid.h"

#include <algorithm>
#include <cmath>

#include "hider/simd/project_vertices.h"

namespace granita {

TileGrid::TileGrid(const Projection& projection, const LensShape& lens) : m_projection(projection) {
    m_simd.inverse_focus = static_cast<float>(1.0 / projection.focus);
    m_simd.inverse_farthest = static_cast<float>(1.0 / projection.farthest_focus());
    if (!projection.has_lens()) return;
    const double radius = projection.lens_radius * (1.0 + 1e-6);
    m_simd.lens_x = static_cast<float>(std::fabs(projection.scale.x) * radius * lens.extent().x);
    m_simd.lens_y = static_cast<float>(std::fabs(projection.scale.y) * radius * lens.extent().y);
}

void TileGrid::load(const GridSweep& sweep) {
    const Grid& grid = sweep.grid();
    const GridClasses& classes = sweep.classes();
    m_sweep = &sweep;
    SimdGrid& out = m_simd;
    out.n_u = grid.n_u;
    out.n_v = grid.n_v;
    out.right = grid.right();
    out.up = grid.up();
    out.vertices = grid.vertex_count();
    out.segments = sweep.segments();
    out.finite = classes.dropped == 0;
    out.lifespan = grid.lifespan;
    out.classes = classes.classes.data();
    out.common = classes.common;
    out.occurring = classes.occurring;
    const std::size_t count =
        static_cast<std::size_t>(out.vertices) * (static_cast<std::size_t>(out.segments) + 1);
    for (auto* a : {&m_px, &m_py, &m_z, &m_x, &m_y, &m_w}) a->resize(count + kLanePadding);
    for (std::size_t i = 0; i < count; ++i) {
        m_px[i] = grid.positions[i].x;
        m_py[i] = grid.positions[i].y;
        m_z[i] = grid.positions[i].z;
    }
    out.x = m_x.data();
    out.y = m_y.data();
    out.w = m_w.data();
    out.z = m_z.data();
    out.corners = nullptr;
    if (out.segments > 0 || m_projection.has_lens()) {
        m_corners.resize(4 * (count + kLanePadding));
        out.corners = m_corners.data();
    }
    m_needed.resize(count / kLanePadding + 1);
}

void TileGrid::need(std::size_t first, std::size_t count) {
    const std::size_t end = (first + count - 1) / kLanePadding + 1;
    for (std::size_t v = first / kLanePadding; v < end; ++v) m_needed[v] = 1;
}

template <class Visit>
void TileGrid::for_each_needed(Visit visit) const {
    const auto begin = m_needed.begin(), end = m_needed.end();
    for (auto first = std::find(begin, end, 1); first != end;) {
        const auto last = std::find(first, end, 0);
        visit(static_cast<std::size_t>(first - begin) * kLanePadding,
              static_cast<std::size_t>(last - first) * kLanePadding);
        first = std::find(last, end, 1);
    }
}

void TileGrid::find_parts(const Vec2d& origin) {
    m_over.clear();
    std::fill(m_needed.begin(), m_needed.end(), 0);
    const auto x0 = static_cast<float>(origin.x), x1 = x0 + kTileSize;
    const auto y0 = static_cast<float>(origin.y), y1 = y0 + kTileSize;
    const int segments = m_sweep->segments();
    for (std::size_t p = 0; p < m_sweep->parts().size(); ++p) {
        const GridPart& part = m_sweep->parts()[p];
        for (int segment = 0; segment < std::max(1, segments); ++segment) {
            const RasterBounds& b = m_sweep->bounds(p, segment);
            if (!(b.visible && b.x0 < x1 && b.x1 >= x0 && b.y0 < y1 && b.y1 >= y0)) continue;
            m_over.push_back({part, segment});
            for (int knot = segment; knot <= segment + (segments > 0); ++knot)
                part.for_each_run(m_sweep->grid(), [&](int vertex, int count) {
                    need(static_cast<std::size_t>(knot) * m_simd.vertices + vertex,
                         static_cast<std::size_t>(count));
                });
        }
    }
    m_simd.parts = m_over;
}

SimdGrid TileGrid::project(const Vec2d& origin) {
    find_parts(origin);
    for_each_needed([&](std::size_t first, std::size_t count) {
        project_vertices(m_projection, origin, count, {&m_px[first], &m_py[first], &m_z[first]},
                         {&m_x[first], &m_y[first], &m_w[first]});
        if (m_simd.corners) interleave_corners(m_simd, first, count, m_corners.data());
    });
    return m_simd;
}

}  // namespace granita
