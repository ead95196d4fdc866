// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/surface_interpolator.h"

#include <algorithm>

#include "hider/locate_kernel.h"

namespace granita {
namespace {

Corner<float> corner(const Projection& projection, const Vec3f& p, const Vec2d& origin) {
    const Vec3f h = projection.homogeneous(p, origin);
    return {h.x, h.y, h.z, p.z};
}

int segment_of(float time, int knots) {
    return std::min(static_cast<int>(time * static_cast<float>(knots - 1)), knots - 2);
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

SurfacePoint point_of(const Grid* grid, const int vertex[4], bool second, double b1, double b2) {
    SurfacePoint point;
    point.grid = grid;
    point.vertex[0] = vertex[0];
    point.vertex[1] = vertex[second ? 2 : 1];
    point.vertex[2] = vertex[second ? 3 : 2];
    point.weight[0] = static_cast<float>(1.0 - b1 - b2);
    point.weight[1] = static_cast<float>(b1);
    point.weight[2] = static_cast<float>(b2);
    return point;
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
      m_lens_y(static_cast<float>(projection.lens_radius * projection.scale.y)),
      m_cache(256) {}

const SurfaceInterpolator::Loaded& SurfaceInterpolator::load(SurfaceId id, float time) {
    Loaded& entry = m_cache[id % m_cache.size()];
    if (entry.id != id) {
        const GridPool::Place place = m_pool.locate(id);
        const Grid::Corners c = place.grid->corners(place.micropolygon);
        entry.id = id;
        entry.segment = -1;
        entry.grid = place.grid;
        entry.vertex[0] = c.v0;
        entry.vertex[1] = c.v1;
        entry.vertex[2] = c.v2;
        entry.vertex[3] = c.v3;
    }
    const Grid& grid = *entry.grid;
    const int segment = grid.motion ? segment_of(time, grid.knots) : 0;
    if (entry.segment == segment) return entry;
    entry.segment = segment;
    const Vec3f* const knot = grid.positions.data() + segment * grid.vertex_count();
    for (int i = 0; i < 4; ++i) {
        const Corner<float> a = corner(m_projection, knot[entry.vertex[i]], m_origin);
        entry.begin[i] = a;
        if (!grid.motion) continue;
        const Corner<float> b =
            corner(m_projection, knot[grid.vertex_count() + entry.vertex[i]], m_origin);
        entry.delta[i] = {b.x - a.x, b.y - a.y, b.w - a.w, b.z - a.z};
    }
    return entry;
}

SurfaceInterpolator::Seen SurfaceInterpolator::see(std::uint32_t sample, SurfaceId id) {
    const float time = m_samples.t.empty() ? 0.0f : m_samples.t[sample];
    const Loaded& surface = load(id, time);
    Seen seen;
    seen.surface = &surface;
    const float local = surface.grid->motion ? time * static_cast<float>(surface.grid->knots - 1) -
                                                   static_cast<float>(surface.segment)
                                             : 0.0f;
    const float x = m_samples.x[sample], y = m_samples.y[sample];
    for (int i = 0; i < 4; ++i) {
        Corner<float>& c = seen.corners[i];
        c = surface.grid->motion ? at_time(surface.begin[i], surface.delta[i], local)
                                 : surface.begin[i];
        seen.offsets[i] = m_projection.has_lens()
                              ? offset_lens(c, x, y, m_samples.u[sample] * m_lens_x,
                                            m_samples.v[sample] * m_lens_y, m_inverse_focus, 1.0f)
                              : offset_pinhole(c, x, y);
    }
    return seen;
}

SurfacePoint SurfaceInterpolator::locate(std::uint32_t sample, SurfaceId id) {
    const Seen seen = see(sample, id);
    Corner<double> corners[4];
    Offset<double> d[4];
    for (int i = 0; i < 4; ++i) {
        const Corner<float>& c = seen.corners[i];
        corners[i] = {c.x, c.y, c.w, c.z};
        d[i] = {seen.offsets[i].x, seen.offsets[i].y};
    }
    // The clip range is left out: the hider applied it.
    const DepthRange any{m_projection.perspective, -INFINITY, INFINITY};
    SurfaceHit hit = hit_micropolygon(corners, d, kTriangleA | kTriangleB, any);
    if (!hit.hit) hit = nearest_triangle(d);
    return point_of(seen.surface->grid, seen.surface->vertex, hit.second, hit.b1, hit.b2);
}

void SurfaceInterpolator::locate_run(std::uint32_t first, int count, const SurfaceId* ids,
                                     SurfacePoint* points) {
    LocateLanes lanes{};
    const Grid* grids[LocateLanes::kCount];
    int vertices[LocateLanes::kCount][4];
    bool any = false;
    for (int i = 0; i < count; ++i) {
        if (ids[i] == kNoSurface) continue;
        any = true;
        const Seen seen = see(first + static_cast<std::uint32_t>(i), ids[i]);
        for (int k = 0; k < 4; ++k) {
            lanes.x[k][i] = seen.offsets[k].x;
            lanes.y[k][i] = seen.offsets[k].y;
            vertices[i][k] = seen.surface->vertex[k];
        }
        grids[i] = seen.surface->grid;
    }
    if (!any) return;
    locate_lanes(lanes);
    for (int i = 0; i < count; ++i) {
        if (ids[i] == kNoSurface) continue;
        if (lanes.plain[i] == 0.0) {
            points[i] = locate(first + static_cast<std::uint32_t>(i), ids[i]);
            continue;
        }
        points[i] =
            point_of(grids[i], vertices[i], lanes.second[i] != 0.0, lanes.b1[i], lanes.b2[i]);
    }
}

}  // namespace granita
