// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_motion.h"

#include <algorithm>
#include <numeric>

#include "dice/knots.h"
#include "scene/knot_time.h"

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

/// Sine of the angle between a sliver's sides.
constexpr float kSliver = 0.1f;

/// Whether points stand for one or more small faces each (FaceBatch).
bool stands_for_faces(const Grid& grid) {
    return grid.apart && grid.shading_positions.faces.empty();
}

/// What a point goes along with: the vertex that it is, or, where it stands for whole faces, the
/// middle of one and how that is turned and stretched, as neither a corner nor a distance kept to
/// it would follow a body that rotates.
struct Anchor {
    Vec3f place{0.0f};
    Vec3f along{0.0f}, across{0.0f};  ///< edges or diagonals of the face
};

/// How what is beside an anchor goes along: as the face is stretched, or turned alone where it is a
/// sliver or has shrunk to one.
Mat3f carried(const Anchor& from, const Anchor& to) {
    const auto out = [](const Anchor& at) { return glm::cross(at.along, at.across); };
    const auto size = [](const Anchor& at) {
        return glm::length(at.along) * glm::length(at.across);
    };
    const float before = glm::length(out(from)), after = glm::length(out(to));
    if (!(before > 0.0f && after > 0.0f)) return Mat3f(1.0f);
    const bool sound = before > kSliver * size(from) && after > kSliver * size(to);
    const auto frame = [&](const Anchor& at, float area) {
        const Vec3f up = out(at) / area;
        if (sound) return Mat3f(at.along, at.across, up * std::sqrt(area));
        const Vec3f ahead = glm::normalize(at.along);
        return Mat3f(ahead, glm::cross(up, ahead), up);
    };
    return frame(to, after) * glm::inverse(frame(from, before));
}

/// Of `place(vertex)`.
template <class Place>
Anchor anchor_of(const Grid& grid, std::size_t vertex, const Place& place) {
    if (!stands_for_faces(grid)) return {place(vertex)};
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
    const std::vector<std::uint32_t>& anchors = grid.shading_positions.anchors;
    const auto anchor = [&](std::size_t i, const auto& place) {
        return anchor_of(grid, anchors.empty() ? i : anchors[i], place);
    };
    const KnotTime frame = knot_time(static_cast<double>(scene.options.frame_time), grid.knots);
    const Mat3f frame_rotation{Mat3d(matrix_at(camera, scene.options.frame_time))};
    std::vector<Anchor> at_frame;
    for (std::size_t i = 0; i < m_count; ++i)
        at_frame.push_back(
            anchor(i, [&](std::size_t v) { return frame_rotation * position_at(grid, v, frame); }));
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
            Place place{at.place, {}, {}};
            if (!anchors.empty()) {
                const Vec3f beside = frame_rotation * grid.p[i] - at_frame[i].place;
                place.p += carried(at_frame[i], at) * beside;
            }
            place.start = place.p;
            if (!points.ray_offset.empty() && !grid.apart) place.start += points.ray_offset[i];
            place.normal = normal_at(grid, places, anchors.empty() ? i : anchors[i], points, i);
            m_places.push_back(place);
        }
        if (stands_for_faces(grid)) rise(grid, places, m_places.size() - m_count);
    }
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
    const float length = glm::length(place.normal);
    place.normal = length > 0.0f ? place.normal / length : m_places[point].normal;
    return place;
}

}  // namespace granita
