// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/vertex_normals.h"

#include <cmath>

#include "geometry/triangulate.h"

namespace granita {
namespace {

Vec3d unit_or_zero(const Vec3d& v) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? v / length : Vec3d(0.0);
}

}  // namespace

std::vector<Vec3f> vertex_normals(const GeometryData& data, std::span<const Vec3f> points) {
    std::vector<Vec3d> sum(points.size(), Vec3d(0.0));
    std::vector<Vec3f> polygon;
    std::size_t first = 0;
    for (const std::int32_t size : data.face_sizes) {
        const std::int32_t* verts = &data.corner_verts[first];
        first += static_cast<std::size_t>(size);
        polygon.clear();
        bool finite = true;
        for (int i = 0; i < size; ++i) {
            polygon.push_back(points[static_cast<std::size_t>(verts[i])]);
            finite = finite && is_finite(polygon.back());
        }
        if (!finite) continue;
        const Vec3d normal = unit_or_zero(newell_normal(polygon));
        for (int i = 0; i < size; ++i) {
            const Vec3d here(polygon[i]);
            const Vec3d back = unit_or_zero(Vec3d(polygon[(i + size - 1) % size]) - here);
            const Vec3d ahead = unit_or_zero(Vec3d(polygon[(i + 1) % size]) - here);
            const double angle = std::acos(glm::clamp(glm::dot(back, ahead), -1.0, 1.0));
            sum[static_cast<std::size_t>(verts[i])] += angle * normal;
        }
    }
    std::vector<Vec3f> normals(points.size());
    for (std::size_t v = 0; v < points.size(); ++v) normals[v] = Vec3f(unit_or_zero(sum[v]));
    return normals;
}

}  // namespace granita
