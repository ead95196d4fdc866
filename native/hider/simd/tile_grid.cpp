// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd/tile_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace granita {

TileGrid::TileGrid(const Projection& projection, const LensShape& lens)
    : m_projection(projection),
      m_inverse_focus(static_cast<float>(1.0 / projection.focus)),
      m_inverse_farthest(static_cast<float>(1.0 / projection.farthest_focus())) {
    if (!projection.has_lens()) return;
    const double radius = projection.lens_radius * (1.0 + 1e-6);
    m_lens_x = static_cast<float>(std::fabs(projection.scale.x) * radius * lens.extent_u());
    m_lens_y = static_cast<float>(std::fabs(projection.scale.y) * radius * lens.extent_v());
}

void TileGrid::load(const Grid& grid) {
    m_grid = &grid;
    m_parts.clear();
    m_together = Segments::kMost;
    SimdGrid& out = m_simd;
    out.n_u = grid.n_u;
    out.n_v = grid.n_v;
    out.right = grid.right();
    out.up = grid.up();
    out.vertices = grid.vertex_count();
    out.segments = grid.motion ? grid.knots - 1 : 0;
    out.together = &m_together;
    out.lifespan = grid.lifespan;
    out.inverse_focus = m_inverse_focus;
    out.inverse_farthest = m_inverse_farthest;
    out.lens_x = m_lens_x;
    out.lens_y = m_lens_y;
    const auto vertices = static_cast<std::size_t>(out.vertices);
    const std::size_t count = vertices * (static_cast<std::size_t>(out.segments) + 1);
    const std::size_t bounds = vertices * static_cast<std::size_t>(std::max(1, out.segments));
    for (auto* a : {&m_px, &m_py, &m_z, &m_x, &m_y, &m_w}) a->resize(count + kLanePadding);
    for (auto* a : {&m_x_lo, &m_x_hi, &m_y_lo, &m_y_hi, &m_nearest})
        a->resize(bounds + kLanePadding);
    for (std::size_t i = 0; i < count; ++i) {
        m_px[i] = grid.positions[i].x;
        m_py[i] = grid.positions[i].y;
        m_z[i] = grid.positions[i].z;
    }
    out.x = m_x.data();
    out.y = m_y.data();
    out.w = m_w.data();
    out.z = m_z.data();
    out.x_lo = m_x_lo.data();
    out.x_hi = m_x_hi.data();
    out.y_lo = m_y_lo.data();
    out.y_hi = m_y_hi.data();
    out.nearest = m_nearest.data();
    out.corners = nullptr;
    if (out.segments > 0 || m_projection.has_lens()) {
        m_corners.resize(4 * (count + kLanePadding));
        out.corners = m_corners.data();
    }
    m_needed.resize((count / kLanePadding + 64) / 64);
}

void TileGrid::bound() {
    const auto vertices = static_cast<std::size_t>(m_simd.vertices);
    const int segments = std::max(1, m_simd.segments);
    const std::size_t count = vertices * (static_cast<std::size_t>(m_simd.segments) + 1);
    project_vertices(m_projection, Vec2d(0.0), count, {m_px.data(), m_py.data(), m_z.data()},
                     {m_x.data(), m_y.data(), m_w.data()});
    const bool narrow = m_simd.n_v <= GridPart::kNarrow, swept = m_simd.corners;
    const int wide = narrow  ? GridPart::kMostInRows / m_simd.n_v
                     : swept ? GridPart::kSwept
                             : GridPart::kStill;
    for (int segment = 0; segment < segments; ++segment) {
        const std::size_t to = static_cast<std::size_t>(segment) * vertices;
        bound_vertices(m_simd, segment, m_projection.perspective,
                       {&m_x_lo[to], &m_x_hi[to], &m_y_lo[to], &m_y_hi[to], &m_nearest[to]});
    }
    for (int j = 0; j < m_simd.n_v; j += GridPart::kHigh)
        for (int i = 0; i < m_simd.n_u; i += wide) {
            const Patch patch{i, j, std::min(wide, m_simd.n_u - i),
                              std::min(GridPart::kHigh, m_simd.n_v - j)};
            for (int segment = 0; segment < segments; ++segment)
                m_parts.push_back({patch, bound_part(m_simd, patch, segment)});
        }
}

void TileGrid::need(std::size_t first, std::size_t count) {
    constexpr std::size_t kVector = kLanePadding;
    for (std::size_t v = first / kVector; v <= (first + count - 1) / kVector; ++v)
        m_needed[v / 64] |= std::uint64_t{1} << (v % 64);
}

template <class Visit>
void TileGrid::for_each_needed(Visit visit) const {
    constexpr std::size_t kVector = kLanePadding;
    const std::size_t end = m_needed.size() * 64;
    const auto find = [&](std::size_t v, bool needed) {
        while (v < end) {
            const std::uint64_t word = m_needed[v / 64];
            const std::uint64_t rest = (needed ? word : ~word) >> (v % 64);
            if (rest != 0) return v + static_cast<std::size_t>(std::countr_zero(rest));
            v = (v / 64 + 1) * 64;
        }
        return end;
    };
    for (std::size_t first = find(0, true); first < end;) {
        const std::size_t last = find(first, false);
        visit(first * kVector, (last - first) * kVector);
        first = find(last, true);
    }
}

void TileGrid::find_parts() {
    m_over.clear();
    std::fill(m_needed.begin(), m_needed.end(), 0);
    const float x0 = m_simd.origin_x, x1 = x0 + kTileSize;
    const float y0 = m_simd.origin_y, y1 = y0 + kTileSize;
    const auto touches = [&](const PartBounds& b) {
        return b.x_lo < x1 && b.x_hi >= x0 && b.y_lo < y1 && b.y_hi >= y0;
    };
    const int segments = std::max(1, m_simd.segments);
    for (std::size_t first = 0; first < m_parts.size(); first += segments) {
        const Patch& patch = m_parts[first].patch;
        for (int segment = 0; segment < segments; ++segment) {
            if (!touches(m_parts[first + segment].bounds)) continue;
            Segments run{segment, 0};
            float nearest = -INFINITY;
            for (; segment < segments && touches(m_parts[first + segment].bounds); ++segment) {
                nearest = std::max(nearest, m_parts[first + segment].bounds.nearest);
                ++run.count;
            }
            m_over.push_back({patch, run, nearest});
            for (int knot = run.first; knot <= run.first + (m_simd.segments ? run.count : 0);
                 ++knot)
                m_simd.for_each_run(patch, [&](int vertex, int count) {
                    need(static_cast<std::size_t>(knot) * m_simd.vertices + vertex,
                         static_cast<std::size_t>(count));
                });
        }
    }
    m_simd.parts = m_over;
}

SimdGrid TileGrid::project(const Vec2d& origin) {
    if (m_parts.empty()) bound();
    m_simd.origin_x = static_cast<float>(origin.x);
    m_simd.origin_y = static_cast<float>(origin.y);
    find_parts();
    for_each_needed([&](std::size_t first, std::size_t count) {
        project_vertices(m_projection, origin, count, {&m_px[first], &m_py[first], &m_z[first]},
                         {&m_x[first], &m_y[first], &m_w[first]});
        if (m_simd.corners) interleave_corners(m_simd, first, count, m_corners.data());
    });
    return m_simd;
}

Sweep TileGrid::sweep() const {
    const Grid& grid = *m_grid;
    const auto vertices = static_cast<std::size_t>(grid.vertex_count());
    Sweep sweep;
    // First, middle and last vertex stand for all: this decides how fast, not what is seen.
    for (const std::size_t v : {std::size_t{0}, vertices / 2, vertices - 1}) {
        Vec2f place(0.0f), length(0.0f);
        for (int k = 0; k < (grid.motion ? grid.knots : 1); ++k) {
            const Vec3f& p = grid.positions[static_cast<std::size_t>(k) * vertices + v];
            const Vec3f h = m_projection.homogeneous(p, Vec2d(0.0));
            const Vec2f now = Vec2f(h) / h.z;
            if (k > 0) length += glm::abs(now - place);
            place = now;
            const float shear = 2.0f *
                                std::max(std::fabs(p.z * m_inverse_focus - 1.0f),
                                         std::fabs(p.z * m_inverse_farthest - 1.0f)) /
                                std::fabs(h.z);
            sweep.lens = glm::max(sweep.lens, shear * Vec2f(m_lens_x, m_lens_y));
        }
        sweep.motion = glm::max(sweep.motion, length);
    }
    for (int axis = 0; axis < 2; ++axis) {
        // Not a number, at the eye plane: as far as can be.
        sweep.motion[axis] = sweep.motion[axis] < 1e4f ? sweep.motion[axis] : 1e4f;
        sweep.lens[axis] = sweep.lens[axis] < 1e4f ? sweep.lens[axis] : 1e4f;
        // Never quite still: then every order would be as good as any.
        if (grid.motion) sweep.motion[axis] = std::max(sweep.motion[axis], 0.1f);
        if (m_projection.has_lens()) sweep.lens[axis] = std::max(sweep.lens[axis], 0.1f);
    }
    return sweep;
}

}  // namespace granita
