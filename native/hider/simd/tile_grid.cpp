// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd/tile_grid.h"

#include <algorithm>
#include <cmath>

#include "hider/simd/project_vertices.h"

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
    const auto vertices = static_cast<std::size_t>(grid.vertex_count());
    const std::size_t knots = grid.motion ? static_cast<std::size_t>(grid.knots) : 1;
    const std::size_t count = vertices * knots;
    const std::size_t bounds = vertices * std::max<std::size_t>(1, knots - 1);
    for (auto* a : {&m_px, &m_py, &m_z, &m_x, &m_y, &m_w}) a->resize(count + kLanePadding);
    for (auto* a : {&m_x_lo, &m_x_hi, &m_y_lo, &m_y_hi, &m_nearest})
        a->resize(bounds + kLanePadding);
    for (std::size_t i = 0; i < count; ++i) {
        m_px[i] = grid.positions[i].x;
        m_py[i] = grid.positions[i].y;
        m_z[i] = grid.positions[i].z;
    }
}

void TileGrid::project(const Vec2d& origin, SimdGrid& out) {
    const Grid& grid = *m_grid;
    out.n_u = grid.n_u;
    out.n_v = grid.n_v;
    out.right = grid.right();
    out.up = grid.up();
    out.vertices = grid.vertex_count();
    out.segments = grid.motion ? grid.knots - 1 : 0;
    out.lifespan = grid.lifespan;
    out.inverse_focus = m_inverse_focus;
    out.inverse_farthest = m_inverse_farthest;
    out.lens_x = m_lens_x;
    out.lens_y = m_lens_y;
    out.x = m_x.data();
    out.y = m_y.data();
    out.w = m_w.data();
    out.z = m_z.data();
    out.x_lo = m_x_lo.data();
    out.x_hi = m_x_hi.data();
    out.y_lo = m_y_lo.data();
    out.y_hi = m_y_hi.data();
    out.nearest = m_nearest.data();
    const auto vertices = static_cast<std::size_t>(grid.vertex_count());
    const std::size_t count = vertices * (static_cast<std::size_t>(out.segments) + 1);
    project_vertices(m_projection, origin, count, {m_px.data(), m_py.data(), m_z.data()},
                     {m_x.data(), m_y.data(), m_w.data()});
    if (out.segments > 0 || m_projection.has_lens()) {
        m_corners.resize(4 * (count + kLanePadding));
        interleave_corners(out, count, m_corners.data());
        out.corners = m_corners.data();
    }
    for (int segment = 0; segment < std::max(1, out.segments); ++segment) {
        const std::size_t to = static_cast<std::size_t>(segment) * vertices;
        const VertexBounds bounds{&m_x_lo[to], &m_x_hi[to], &m_y_lo[to], &m_y_hi[to],
                                  &m_nearest[to]};
        bound_vertices(out, segment, m_projection.perspective, bounds);
    }
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
