// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/surface_interpolator.h"

#include <algorithm>

namespace granita {
namespace {

Corner<float> corner(const Projection& projection, const Vec3f& p, const Vec2d& origin) {
    const Vec3f h = projection.homogeneous(p, origin);
    return {h.x, h.y, h.z, p.z};
}

/// Weights of the triangle whose smallest weight is largest: the nearest guess for a sample that is
/// outside both by rounding.
SurfaceHit nearest_triangle(const Offset<double> d[4]) {
    SurfaceHit best;
    double best_least = -INFINITY;
    for (const bool second : {false, true}) {
        const int j = second ? 2 : 1, k = second ? 3 : 2;
        const double e[3] = {edge(d[j], d[k]), edge(d[k], d[0]), edge(d[0], d[j])};
        const double sum = e[0] + e[1] + e[2];
        if (sum == 0.0) continue;
        const double least = std::min({e[0] / sum, e[1] / sum, e[2] / sum});
        if (!(least > best_least)) continue;
        best_least = least;
        double w[3];
        for (int i = 0; i < 3; ++i) w[i] = std::max(0.0, e[i] / sum);
        const double total = w[0] + w[1] + w[2];
        best = {true, 0.0f, second, w[1] / total, w[2] / total};
    }
    return best;
}

}  // namespace

SurfaceInterpolator::SurfaceInterpolator(const Projection& projection, Vec2i tile,
                                         const TileSamples& samples, const GridPool& pool)
    : m_projection(projection),
      m_origin(tile * kTileSize),
      m_samples(samples),
      m_pool(pool),
      m_inverse_focus(static_cast<float>(1.0 / projection.focus)),
      m_lens_x(static_cast<float>(projection.lens_radius * projection.scale.x)),
      m_lens_y(static_cast<float>(projection.lens_radius * projection.scale.y)) {}

void SurfaceInterpolator::load(SurfaceId id) {
    const GridPool::Place place = m_pool.locate(id);
    const Grid::Corners c = place.grid->corners(place.micropolygon);
    const int vertex[4] = {c.v0, c.v1, c.v2, c.v3};
    m_grid = place.grid;
    for (int i = 0; i < 4; ++i) {
        m_vertex[i] = vertex[i];
        m_static[i] = corner(m_projection, m_grid->positions[vertex[i]], m_origin);
    }
    m_loaded = id;
}

SurfacePoint SurfaceInterpolator::locate(std::uint32_t sample, SurfaceId id) {
    if (id != m_loaded) load(id);
    Corner<float> c[4] = {m_static[0], m_static[1], m_static[2], m_static[3]};
    if (m_grid->motion) {
        const float place = m_samples.t[sample] * static_cast<float>(m_grid->knots - 1);
        const int segment = std::min(static_cast<int>(place), m_grid->knots - 2);
        const float local = place - static_cast<float>(segment);
        const Vec3f* begin = m_grid->positions.data() + segment * m_grid->vertex_count();
        for (int i = 0; i < 4; ++i) {
            const Corner<float> a = corner(m_projection, begin[m_vertex[i]], m_origin);
            const Corner<float> b =
                corner(m_projection, begin[m_grid->vertex_count() + m_vertex[i]], m_origin);
            c[i] = at_time(a, Corner<float>{b.x - a.x, b.y - a.y, b.w - a.w, b.z - a.z}, local);
        }
    }
    Corner<double> exact[4];
    Offset<double> d[4];
    for (int i = 0; i < 4; ++i) {
        const float x = m_samples.x[sample], y = m_samples.y[sample];
        const Offset<float> o =
            m_projection.has_lens()
                ? offset_lens(c[i], x, y, m_samples.u[sample] * m_lens_x,
                              m_samples.v[sample] * m_lens_y, m_inverse_focus, 1.0f)
                : offset_pinhole(c[i], x, y);
        d[i] = {o.x, o.y};
        exact[i] = {c[i].x, c[i].y, c[i].w, c[i].z};
    }
    // The clip range is left out: the hider applied it.
    const DepthRange any{m_projection.perspective, -INFINITY, INFINITY};
    SurfaceHit hit = hit_micropolygon(exact, d, kTriangleA | kTriangleB, any);
    if (!hit.hit) hit = nearest_triangle(d);
    SurfacePoint point;
    point.grid = m_grid;
    point.vertex[0] = m_vertex[0];
    point.vertex[1] = m_vertex[hit.second ? 2 : 1];
    point.vertex[2] = m_vertex[hit.second ? 3 : 2];
    point.weight[0] = static_cast<float>(1.0 - hit.b1 - hit.b2);
    point.weight[1] = static_cast<float>(hit.b1);
    point.weight[2] = static_cast<float>(hit.b2);
    return point;
}

}  // namespace granita
