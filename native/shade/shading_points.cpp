// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shading_points.h"

#include <cmath>

namespace granita {

ShadingPoints shading_points(const Grid& grid, const ShadingCamera& camera) {
    const std::size_t n = grid.point_count();
    const Mat3f rotation(camera.world_from_camera);
    ShadingPoints points;
    points.count = n;
    (camera.perspective ? points.pixel_slope : points.pixel_width) = camera.pixel;
    points.share = grid.point_share;
    points.faces = grid.shading_positions.faces;
    points.whole_faces = grid.shades_faces();
    if (!grid.disjoint)
        points.columns = static_cast<std::size_t>(grid.n_u / grid.shading_positions.step_u) + 1;
    points.edges = points.columns > 0 && grid.ray_offset.empty();
    points.p.resize(n);
    points.normal.resize(n);
    points.geometric_normal.resize(n);
    points.view.resize(n);
    points.dp_du.resize(n);
    points.dp_dv.resize(n);
    points.backfacing.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f& p = grid.shading_p()[i];
        const float length = glm::length(p);
        const Vec3f view = camera.perspective && length > 0.0f ? -p / length : Vec3f(0, 0, -1);
        // The surface itself decides which side is seen; the shading normal follows (Cycles).
        const float side = glm::dot(grid.geometric_normal[i], view) < 0.0f ? -1.0f : 1.0f;
        points.p[i] = rotation * p;
        points.normal[i] = rotation * grid.normal[i] * side;
        points.geometric_normal[i] = rotation * grid.geometric_normal[i] * side;
        points.view[i] = rotation * view;
        points.dp_du[i] = rotation * grid.dp_du[i];
        points.dp_dv[i] = rotation * grid.dp_dv[i];
        points.backfacing[i] = side < 0.0f;
    }
    points.terminator_offset = grid.terminator_offset;
    for (const Vec3f& rise : grid.rise) points.rise.push_back(rotation * rise);
    for (const Vec3f& offset : grid.ray_offset) points.ray_offset.push_back(rotation * offset);
    return points;
}

ShadingPoints painted_points(std::size_t count) {
    ShadingPoints points;
    points.count = count;
    return points;
}

void show_other_side(ShadingPoints& points, std::span<const std::size_t> which) {
    for (const std::size_t i : which) {
        points.normal[i] = -points.normal[i];
        Vec3f& outward = points.geometric_normal[i];
        outward = -outward;
        // Mirrored, so that it is on that side as well.
        points.view[i] -= 2.0f * glm::dot(points.view[i], outward) * outward;
        points.backfacing[i] ^= 1;
        // That of the smooth surface is known of the side alone that is seen at the frame time.
        if (!points.rise.empty()) points.rise[i] = Vec3f(0.0f);
    }
}

}  // namespace granita
