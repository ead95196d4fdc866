// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_motion.h"

#include <algorithm>

#include "geometry/anchor.h"
#include "scene/knot_time.h"
#include "shade/lights/leaving_rays.h"
#include "shade/lights/vertex_paths.h"

namespace granita {
namespace {

/// Of `place(vertex)`.
template <class Place>
Anchor anchor_of(const Grid& grid, std::size_t vertex, const Place& place) {
    if (!grid.shades_faces()) return {place(vertex)};
    const Grid::Corners c = grid.corners(static_cast<int>(vertex) % grid.n_u);
    const Vec3f a = place(c.v0), b = place(c.v1), d = place(c.v2);
    const Vec3f e = place(c.v3);
    if (d == e) return {(a + b + d) / 3.0f, b - a, d - a};
    return {0.5f * (a + d), d - a, e - b};
}

/// From the neighbours in the grid: deformation turns a surface as well as a transform does.
/// `places` [vertices]; the point's side is the one that is seen of it.
Vec3f normal_at(const Grid& grid, const std::vector<Vec3f>& places, std::size_t vertex,
                const ShadingPoints& points, std::size_t point) {
    const int v = static_cast<int>(vertex);
    Vec3f across;
    if (grid.disjoint) {
        const Grid::Corners c = grid.corners(v % grid.n_u);
        across = glm::cross(places[c.v2] - places[c.v0], places[c.v3] - places[c.v1]);
    } else {
        const int i = v % grid.up(), j = v / grid.up();
        const auto p = [&](int x, int y) { return places[y * grid.up() + x]; };
        across = glm::cross(p(std::min(i + 1, grid.n_u), j) - p(std::max(i - 1, 0), j),
                            p(i, std::min(j + 1, grid.n_v)) - p(i, std::max(j - 1, 0)));
    }
    const float length = glm::length(across);
    const Vec3f& seen = points.geometric_normal[point];
    const bool same = glm::dot(glm::cross(points.dp_du[point], points.dp_dv[point]), seen) > 0.0f;
    // Vertices that coincide have no neighbours to tell their normal.
    return length > 0.0f ? across * ((same ? 1.0f : -1.0f) / length) : seen;
}

/// inwards(), as far as the vertex lies on the grid's border.
Vec3f inwards_from(const Grid& grid, const std::vector<Vec3f>& places, std::size_t vertex) {
    const int v = static_cast<int>(vertex), i = v % grid.up(), j = v / grid.up();
    const auto step = [&](int x, int y) {
        return kInwards * (places[y * grid.up() + x] - places[vertex]);
    };
    Vec3f sum(0.0f);
    if (i == 0) sum += step(1, j);
    if (i == grid.n_u) sum += step(i - 1, j);
    if (j == 0) sum += step(i, 1);
    if (j == grid.n_v) sum += step(i, j - 1);
    return sum;
}

}  // namespace

PointPaths::PointPaths(const Grid& grid, const Scene& scene, const ShadingPoints& points)
    : m_lifespan(grid.lifespan) {
    const VertexPaths paths(grid, scene);
    if (!paths.moves()) return;
    m_knots = static_cast<int>(paths.knots());
    m_count = points.count;
    m_places.reserve(paths.knots() * m_count);
    const auto vertices = static_cast<std::size_t>(grid.vertex_count());
    const std::vector<std::uint32_t>& anchors = grid.shading_positions.anchors;
    const auto anchor = [&](std::size_t i, const auto& place) {
        return anchor_of(grid, anchors.empty() ? i : anchors[i], place);
    };
    std::vector<Anchor> at_frame;
    for (std::size_t i = 0; i < m_count; ++i)
        at_frame.push_back(anchor(i, [&](std::size_t v) { return paths.at_frame(v); }));
    for (std::size_t knot = 0; knot < paths.knots(); ++knot) {
        std::vector<Vec3f> places(vertices);
        for (std::size_t v = 0; v < vertices; ++v) places[v] = paths.at_knot(v, knot);
        for (std::size_t i = 0; i < m_count; ++i) {
            const Anchor at = anchor(i, [&](std::size_t v) { return places[v]; });
            Place place{at.place, {}, {}};
            if (!anchors.empty()) {
                const Vec3f beside = points.p[i] - at_frame[i].place;
                place.p += carried(at_frame[i], at) * beside;
            }
            if (points.edges)
                place.p += inwards_from(grid, places, anchors.empty() ? i : anchors[i]);
            place.start = place.p;
            if (!points.ray_offset.empty() && !grid.disjoint) place.start += points.ray_offset[i];
            place.normal = normal_at(grid, places, anchors.empty() ? i : anchors[i], points, i);
            m_places.push_back(place);
        }
        if (grid.shades_faces()) rise(grid, places, m_places.size() - m_count);
    }
    for (std::size_t i = 0; paths.is_bent() && i + m_count < m_places.size(); ++i)
        m_bends.push_back(paths.bend(i / m_count, m_places[i].p, m_places[i + m_count].p));
}

/// Starts of rays above all of the faces that a point stands for, as these are at a knot.
void PointPaths::rise(const Grid& grid, const std::vector<Vec3f>& places, std::size_t first) {
    std::vector<float> heights(m_count, 0.0f);
    for (std::size_t v = 0; v < places.size(); ++v) {
        const std::size_t i = grid.shading_positions.point_of[v];
        const Place& place = m_places[first + i];
        heights[i] = std::max(heights[i], glm::dot(places[v] - place.p, place.normal));
    }
    for (std::size_t i = 0; i < m_count; ++i)
        m_places[first + i].start += m_places[first + i].normal * heights[i];
}

PointPaths::Place PointPaths::at(std::size_t point, float time) const {
    const KnotTime t = knot_time(static_cast<double>(time), m_knots);
    const Place& before = m_places[t.knot * m_count + point];
    if (t.fraction == 0.0) return before;
    const Place& after = m_places[(t.knot + 1) * m_count + point];
    const auto mix = [&](const Vec3f& a, const Vec3f& b) {
        return a + (b - a) * static_cast<float>(t.fraction);
    };
    Place place{mix(before.p, after.p), mix(before.start, after.start),
                mix(before.normal, after.normal)};
    if (!m_bends.empty()) {
        const auto f = static_cast<float>(t.fraction);
        const Vec3f off = m_bends[t.knot * m_count + point] * (f * (1.0f - f));
        place.p += off;
        place.start += off;
    }
    const float length = glm::length(place.normal);
    place.normal = length > 0.0f ? place.normal / length : m_places[point].normal;
    return place;
}

Bounds3f PointPaths::reach(std::size_t point) const {
    Bounds3f box;
    for (std::size_t i = point; i < m_places.size(); i += m_count) box.add(m_places[i].p);
    return box;
}

}  // namespace granita
