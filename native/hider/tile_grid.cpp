// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/tile_grid.h"

#include <algorithm>
#include <cmath>

namespace granita {
namespace {

/// Bounds grow by this much: more than the offsets of hit tests can round by.
constexpr float kMargin = 1.0f / 1024;

}  // namespace

TileGrid::TileGrid(const Projection& projection, const LensShape& lens)
    : m_projection(projection), m_inverse_focus(static_cast<float>(1.0 / projection.focus)) {
    if (!projection.has_lens()) return;
    const double radius = projection.lens_radius * (1.0 + 1e-6);
    m_lens_x = static_cast<float>(std::fabs(projection.scale.x) * radius * lens.extent_u());
    m_lens_y = static_cast<float>(std::fabs(projection.scale.y) * radius * lens.extent_v());
}

void TileGrid::project(const Grid& grid, const Vec2d& origin, SimdGrid& out) {
    const auto vertices = static_cast<std::size_t>(grid.vertex_count());
    const std::size_t knots = grid.motion ? static_cast<std::size_t>(grid.knots) : 1;
    const std::size_t count = vertices * knots;
    for (auto* a : {&m_x, &m_y, &m_w, &m_z}) a->resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3f h = m_projection.homogeneous(grid.positions[i], origin);
        m_x[i] = h.x;
        m_y[i] = h.y;
        m_w[i] = h.z;
        m_z[i] = grid.positions[i].z;
    }
    bound_vertices(vertices, knots);
    out.x = m_x.data();
    out.y = m_y.data();
    out.w = m_w.data();
    out.z = m_z.data();
    out.x_lo = m_x_lo.data();
    out.x_hi = m_x_hi.data();
    out.y_lo = m_y_lo.data();
    out.y_hi = m_y_hi.data();
    out.n_u = grid.n_u;
    out.n_v = grid.n_v;
    out.vertices = grid.vertex_count();
    out.segments = static_cast<int>(knots) - 1;
    out.inverse_focus = m_inverse_focus;
    out.lens_x = m_lens_x;
    out.lens_y = m_lens_y;
}

void TileGrid::bound_vertices(std::size_t vertices, std::size_t knots) {
    const std::size_t segments = std::max<std::size_t>(1, knots - 1);
    for (auto* a : {&m_x_lo, &m_y_lo}) a->assign(segments * vertices, INFINITY);
    for (auto* a : {&m_x_hi, &m_y_hi}) a->assign(segments * vertices, -INFINITY);
    for (std::size_t segment = 0; segment < segments; ++segment)
        for (std::size_t knot = segment; knot < std::min(segment + 2, knots); ++knot)
            for (std::size_t v = 0; v < vertices; ++v) {
                const std::size_t to = segment * vertices + v, from = knot * vertices + v;
                const float x = m_x[from] / m_w[from], y = m_y[from] / m_w[from];
                if (!(m_w[from] > 0.0f) || !std::isfinite(x) || !std::isfinite(y)) {
                    // At or behind the eye plane: anywhere.
                    m_x_lo[to] = m_y_lo[to] = -INFINITY;
                    m_x_hi[to] = m_y_hi[to] = INFINITY;
                    continue;
                }
                const float shear = std::fabs(m_z[from] * m_inverse_focus - 1.0f) / m_w[from];
                const float more_x =
                    kMargin + std::fabs(x) * 0x1p-21f + m_lens_x * shear * (1.0f + 1e-5f);
                const float more_y =
                    kMargin + std::fabs(y) * 0x1p-21f + m_lens_y * shear * (1.0f + 1e-5f);
                m_x_lo[to] = std::min(m_x_lo[to], x - more_x);
                m_x_hi[to] = std::max(m_x_hi[to], x + more_x);
                m_y_lo[to] = std::min(m_y_lo[to], y - more_y);
                m_y_hi[to] = std::max(m_y_hi[to], y + more_y);
            }
}

}  // namespace granita
