// SPDX-License-Identifier: GPL-3.0-or-later
// Normals and tangents at the corners of a polygon's patches.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "geometry/shared_geometry.h"
#include "geometry/tangents.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

/// Longitude and latitude of a place around the origin.
Vec2f around_origin(const Vec3f& p) {
    constexpr float kPi = std::numbers::pi_v<float>;
    const float length = glm::length(p);
    if (!(length > 0.0f)) return Vec2f(0.0f);
    const float u = p.x == 0.0f && p.y == 0.0f ? 0.0f : 0.5f - std::atan2(p.x, p.y) / (2.0f * kPi);
    return {u, 1.0f - std::acos(glm::clamp(p.z / length, -1.0f, 1.0f)) / kPi};
}

}  // namespace

std::array<Vec3f, 4> SharedGeometry::corner_normals(const BasePatch& patch) const {
    std::array<Vec3f, 4> normals;
    const auto vertex = [&](std::size_t i) {
        return static_cast<std::size_t>(m_data->corner_verts[patch.corner[i]]);
    };
    const auto point = [&](std::size_t i) { return Vec3d(m_frame_points[vertex(i)]); };
    if (is_smooth(patch.face)) {
        for (std::size_t i = 0; i < 4; ++i)
            normals[i] = normalize_or(smooth_normal(patch.corner[i]), Vec3f(0.0f));
        return normals;
    }
    const Vec3d across = patch.kind == PatchKind::Triangle
                             ? glm::cross(point(1) - point(0), point(2) - point(0))
                             : glm::cross(point(2) - point(0), point(3) - point(1));
    normals.fill(Vec3f(normalize_or(across, Vec3d(0.0))));
    return normals;
}

std::vector<Vec4f> SharedGeometry::make_tangents(const std::string& uv_map) const {
    const Attribute* map = uv_map.empty() ? m_data->default_uv() : m_data->find_attribute(uv_map);
    std::vector<Vec4f> found(4 * m_patches.size(), Vec4f(0.0f));
    // Cycles falls back on places only where it is asked for no map in particular.
    const bool usable = map && map->domain == Domain::Corner && map->width >= 2;
    if (m_subdivision || (!usable && !uv_map.empty())) return found;
    const auto width = usable ? static_cast<std::size_t>(map->width) : 0;

    std::vector<TangentCorner> corners;
    for (const BasePatch& patch : m_patches) {
        const std::array<Vec3f, 4> normals = corner_normals(patch);
        const auto add = [&](std::size_t i) {
            const std::uint32_t corner = patch.corner[i];
            const Vec3f p = m_frame_points[static_cast<std::size_t>(m_data->corner_verts[corner])];
            const Vec2f uv =
                usable ? Vec2f(map->values[corner * width], map->values[corner * width + 1])
                       : around_origin(p);
            corners.push_back({p, normals[i], uv});
        };
        for (const std::size_t i : {0, 1, 2}) add(i);
        if (patch.kind == PatchKind::TrianglePair)
            for (const std::size_t i : {0, 2, 3}) add(i);
    }
    const std::vector<Vec4f> of_corners = granita::tangents(corners);
    std::size_t next = 0;
    for (std::size_t k = 0; k < m_patches.size(); ++k) {
        for (std::size_t i = 0; i < 3; ++i) found[4 * k + i] = of_corners[next++];
        found[4 * k + 3] = found[4 * k + 2];
        if (m_patches[k].kind != PatchKind::TrianglePair) continue;
        found[4 * k + 3] = of_corners[next + 2];
        next += 3;
    }
    return found;
}

std::array<Vec4f, 4> SharedGeometry::corner_tangents(const BasePatch& patch,
                                                     const std::string& uv_map) const {
    const auto known = [&]() -> const std::vector<Vec4f>* {
        const std::shared_lock lock(m_tangent_mutex);
        const auto entry = m_tangents.find(uv_map);
        return entry == m_tangents.end() ? nullptr : &entry->second;
    };
    const std::vector<Vec4f>* all = known();
    if (!all) {
        const std::unique_lock lock(m_tangent_mutex);
        auto entry = m_tangents.find(uv_map);
        if (entry == m_tangents.end())
            entry = m_tangents.emplace(uv_map, make_tangents(uv_map)).first;
        all = &entry->second;
    }
    // A half (BasePatch::half) is looked for in its pair, which is the only patch of its face.
    const std::size_t first = m_first_patch[patch.face];
    const bool is_paired = m_patches[first].kind == PatchKind::TrianglePair;
    const std::size_t k = is_paired ? first : first + static_cast<std::size_t>(patch.sub);
    const auto& corners = m_patches[k].corner;
    std::array<Vec4f, 4> found;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto at = std::ranges::find(corners, patch.corner[i]) - std::begin(corners);
        found[i] = (*all)[4 * k + static_cast<std::size_t>(at)];
    }
    return found;
}

}  // namespace granita
