// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/vertex_paths.h"

#include <algorithm>
#include <numeric>

#include "dice/knots.h"
#include "scene/camera_path.h"

namespace granita {
namespace {

/// In the world; part of a mesh that deforms may.
bool stands_still(const Scene& scene, const Grid& grid) {
    if (grid.knots == 1 && is_static(scene.camera.world_from_camera)) return true;
    const Instance& instance = scene.instances[grid.instance];
    return scene.geometry_of(instance).knots == 1 && is_static(instance.world_from_object);
}

/// Of the grid in camera space, at a time.
Vec3f position_at(const Grid& grid, std::size_t vertex, const KnotTime& t) {
    const auto count = static_cast<std::size_t>(grid.vertex_count());
    const Vec3f& before = grid.positions[t.knot * count + vertex];
    if (t.fraction == 0.0) return before;
    const Vec3f& after = grid.positions[(t.knot + 1) * count + vertex];
    return before + (after - before) * static_cast<float>(t.fraction);
}

}  // namespace

VertexPaths::VertexPaths(const Grid& grid, const Scene& scene)
    : m_grid(grid), m_frame_time(scene.options.frame_time) {
    const auto& camera = scene.camera.world_from_camera;
    const CameraPath path(scene.camera);
    const Mat4d at_frame = path.world_from_camera(m_frame_time);
    m_frame_rotation = Mat3f(Mat3d(at_frame));
    m_cameras.resize(1);
    if (stands_still(scene, grid)) return;
    // What moves with the camera has one knot in its space: the camera's own count too.
    const int segments = static_cast<int>(
        std::lcm(std::max(1, grid.knots - 1), std::max(1, static_cast<int>(camera.size()) - 1)));
    m_cameras.resize(static_cast<std::size_t>(std::min(segments, kMaxKnots - 1)) + 1);
    const Vec3d origin(at_frame[3]);
    for (std::size_t knot = 0; knot < knots(); ++knot) {
        const Mat4d m =
            path.world_from_camera(static_cast<double>(knot) / static_cast<double>(knots() - 1));
        m_cameras[knot] = {Mat3f(Mat3d(m)), Vec3f(Vec3d(m[3]) - origin)};
    }
    const Instance& instance = scene.instances[grid.instance];
    if (scene.geometry_of(instance).knots > 1 && !is_static(instance.world_from_object))
        add_turns(instance, origin);
}

void VertexPaths::add_turns(const Instance& instance, const Vec3d& origin) {
    for (std::size_t knot = 0; knot < knots(); ++knot) {
        Mat4d m = matrix_at(instance.world_from_object,
                            static_cast<double>(knot) / static_cast<double>(knots() - 1));
        m[3] -= glm::dvec4(origin, 0.0);
        if (glm::determinant(Mat3d(m)) == 0.0) {
            m_turns.clear();
            return;
        }
        m_turns.push_back({Mat3d(m), glm::inverse(m)});
    }
}

Vec3f VertexPaths::bend(std::size_t knot, const Vec3f& before, const Vec3f& after) const {
    if (m_turns.empty()) return Vec3f(0.0f);
    const Turn &from = m_turns[knot], &to = m_turns[knot + 1];
    const Vec3d deformed = transform_point(to.object_from_shading, Vec3d(after)) -
                           transform_point(from.object_from_shading, Vec3d(before));
    return Vec3f((from.axes - to.axes) * deformed);
}

Vec3f VertexPaths::at_frame(std::size_t vertex) const {
    const KnotTime frame = knot_time(static_cast<double>(m_frame_time), m_grid.knots);
    return m_frame_rotation * position_at(m_grid, vertex, frame);
}

Vec3f VertexPaths::at_knot(std::size_t vertex, std::size_t knot) const {
    const KnotTime t =
        knot_time(static_cast<int>(knot), static_cast<int>(knots()) - 1, m_grid.knots);
    return m_cameras[knot].rotation * position_at(m_grid, vertex, t) + m_cameras[knot].offset;
}

Vec3f VertexPaths::at(std::size_t vertex, float time) const {
    if (!moves()) return at_frame(vertex);
    const KnotTime t = knot_time(static_cast<double>(time), static_cast<int>(knots()));
    const Vec3f before = at_knot(vertex, t.knot);
    if (t.fraction == 0.0) return before;
    const Vec3f after = at_knot(vertex, t.knot + 1);
    const auto f = static_cast<float>(t.fraction);
    const Vec3f straight = before + (after - before) * f;
    return is_bent() ? straight + bend(t.knot, before, after) * (f * (1.0f - f)) : straight;
}

}  // namespace granita
