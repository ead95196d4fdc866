// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/light_paths.h"

#include <algorithm>
#include <numeric>

#include "dice/knots.h"
#include "shade/shading_points.h"

namespace granita {
namespace {

/// In the world; part of a mesh that deforms may.
bool stands_still(const Scene& scene, const Grid& grid) {
    if (grid.knots == 1 && is_static(scene.camera.world_from_camera)) return true;
    const Instance& instance = scene.instances[grid.instance];
    return scene.geometries[static_cast<std::size_t>(instance.geometry)].knots == 1 &&
           is_static(instance.world_from_object);
}

/// Of the grid in camera space, at a time.
Vec3f position_at(const Grid& grid, std::size_t vertex, const KnotTime& t) {
    const auto count = static_cast<std::size_t>(grid.vertex_count());
    const Vec3f& before = grid.positions[t.knot * count + vertex];
    if (t.fraction == 0.0) return before;
    const Vec3f& after = grid.positions[(t.knot + 1) * count + vertex];
    return before + (after - before) * static_cast<float>(t.fraction);
}

/// What a point goes along with: a vertex, or the middle of its separate face and how that face is
/// turned, as neither a corner nor a distance kept to it would follow a body that rotates.
struct Anchor {
    Vec3f place{0.0f};
    Mat3f turned{1.0f};
};

/// Of `place(vertex)`.
template <class Place>
Anchor anchor_of(const Grid& grid, std::size_t vertex, const Place& place) {
    if (!grid.apart) return {place(vertex)};
    const Grid::Corners c = grid.corners(static_cast<int>(vertex) % grid.n_u);
    const Vec3f a = place(c.v0), b = place(c.v1), d = place(c.v2);
    Anchor anchor{d == place(c.v3) ? (a + b + d) / 3.0f : 0.5f * (a + d)};
    const Vec3f along = d - a, out = glm::cross(b - a, along);
    const float length = glm::length(along), area = glm::length(out);
    if (length > 0.0f && area > 0.0f)
        anchor.turned = {along / length, glm::cross(out / area, along / length), out / area};
    return anchor;
}

/// From the neighbours in the grid: deformation turns a surface as well as a transform does.
/// `places` [vertices]; the point's side is the one that is seen of it.
Vec3f normal_at(const Grid& grid, const std::vector<Vec3f>& places, std::size_t vertex,
                const ShadingPoints& points, std::size_t point) {
    const int v = static_cast<int>(vertex);
    Vec3f across;
    if (grid.apart) {
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

}  // namespace

PointPaths::PointPaths(const Grid& grid, const Scene& scene, const ShadingPoints& points)
    : m_lifespan(grid.lifespan) {
    if (stands_still(scene, grid)) return;
    // What moves with the camera has one knot in its space: the camera's own count too.
    const auto& camera = scene.camera.world_from_camera;
    const int segments = static_cast<int>(
        std::lcm(std::max(1, grid.knots - 1), std::max(1, static_cast<int>(camera.size()) - 1)));
    m_knots = std::min(segments, kMaxKnots - 1) + 1;
    m_count = points.count;
    const Vec3d origin(matrix_at(camera, scene.options.frame_time)[3]);
    const auto knots = static_cast<std::size_t>(m_knots);
    m_places.reserve(knots * m_count);
    const auto vertices = static_cast<std::size_t>(grid.vertex_count());
    // As the anchor sees it: where a point is beside it, and its rays' offset.
    const std::vector<std::uint32_t>& anchors = grid.places.anchors;
    const auto anchor = [&](std::size_t i, const auto& place) {
        return anchor_of(grid, anchors.empty() ? i : anchors[i], place);
    };
    const KnotTime frame = knot_time(static_cast<double>(scene.options.frame_time), grid.knots);
    const Mat3f frame_rotation{Mat3d(matrix_at(camera, scene.options.frame_time))};
    std::vector<Vec3f> beside, offsets;
    for (std::size_t i = 0; i < m_count; ++i) {
        const Anchor at =
            anchor(i, [&](std::size_t v) { return frame_rotation * position_at(grid, v, frame); });
        if (!anchors.empty()) beside.push_back((frame_rotation * grid.p[i] - at.place) * at.turned);
        if (!points.ray_offset.empty()) offsets.push_back(points.ray_offset[i] * at.turned);
    }
    for (std::size_t knot = 0; knot < knots; ++knot) {
        const double time = static_cast<double>(knot) / (m_knots - 1);
        const Mat4d m = matrix_at(camera, time);
        const Mat3f rotation{Mat3d(m)};
        const Vec3f offset(Vec3d(m[3]) - origin);
        const KnotTime t = knot_time(static_cast<int>(knot), m_knots - 1, grid.knots);
        std::vector<Vec3f> places(vertices);
        for (std::size_t v = 0; v < vertices; ++v)
            places[v] = rotation * position_at(grid, v, t) + offset;
        for (std::size_t i = 0; i < m_count; ++i) {
            const Anchor at = anchor(i, [&](std::size_t v) { return places[v]; });
            Place place;
            place.p = anchors.empty() ? at.place : at.place + at.turned * beside[i];
            place.start = offsets.empty() ? place.p : place.p + at.turned * offsets[i];
            place.normal = normal_at(grid, places, anchors.empty() ? i : anchors[i], points, i);
            m_places.push_back(place);
        }
    }
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
    const float length = glm::length(place.normal);
    place.normal = length > 0.0f ? place.normal / length : m_places[point].normal;
    return place;
}

}  // namespace granita
