// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/face_triangles.h"

#include <algorithm>
#include <array>

#include "dice/grid_attributes.h"
#include "dice/triangle_grid.h"
#include "geometry/limit_vertices.h"

namespace granita {
namespace {

std::array<Vec2d, 3> corner_places(const FaceTriangle& triangle) {
    const Vec2d a(0.0, 0.0), b(1.0, 0.0), c(1.0, 1.0), d(0.0, 1.0);
    if (triangle.patch.kind == PatchKind::Triangle) return {a, b, d};
    return triangle.of.second ? std::array{a, c, d} : std::array{a, b, c};
}

/// How many times further a neighbour at the dicing rate would be than the face is long.
float stretch_of(const OpenedMesh& mesh, const Vec3f& p, const Vec3d& su, const Vec3d& sv) {
    const Projection& projection = mesh.view().projection;
    const double by = projection.perspective ? std::max(std::abs(double(p.z)), 1e-30) : 1.0;
    const auto pixels = [&](const Vec3d& step) {
        return glm::length(Vec2d(projection.scale) * Vec2d(step)) / by;
    };
    const double longest = std::max(pixels(su), pixels(sv));
    const double rate = mesh.rate().shading_rate();
    return longest > 0.0 ? static_cast<float>(std::max(rate / longest, 1.0)) : 1.0f;
}

/// The shading state at three corners of each.
struct CornerState {
    std::vector<Vec3f> normal, geometric_normal, dp_du, dp_dv, ray_offset, rise;
    std::vector<CornerBlend> normal_corners;
};

}  // namespace

Grid face_triangles(const OpenedMesh& mesh, const Grid& batch,
                    std::span<const FaceTriangle> wanted) {
    const std::size_t count = wanted.size();
    Grid grid = triangle_grid(batch, mesh.knots(), count,
                              [&](std::size_t t) -> const GridTriangle& { return wanted[t].of; });
    grid.terminator_offset = mesh.instance().terminator_offset;
    grid.knot_normals = mesh.knot_normals();
    CornerState at;
    std::vector<float> stretches;
    for (std::size_t t = 0; t < count; ++t) {
        const FaceTriangle& triangle = wanted[t];
        const FrameFace face = mesh.small_face(triangle.patch);
        const Vec3f& p = grid.shading_p()[t];
        for (const Vec2d& uv : corner_places(triangle)) {
            const CornerWeights weights(triangle.patch.kind, uv);
            const TangentFrame frame = face.frame(weights);
            if (stretches.size() == t) stretches.push_back(stretch_of(mesh, p, frame.su, frame.sv));
            at.geometric_normal.emplace_back(frame.geometric_normal);
            at.normal.emplace_back(frame.normal);
            at.dp_du.emplace_back(frame.su * double(stretches[t]));
            at.dp_dv.emplace_back(frame.sv * double(stretches[t]));
            if (grid.knot_normals)
                at.normal_corners.push_back(mesh.normal_corners(triangle.patch, weights));
            if (mesh.rises()) at.rise.push_back(mesh.rise(face, weights, frame.geometric_normal));
            if (!mesh.shared().subdivision()) continue;
            // The limit, which rays meet, may stand above the micropolygon.
            const float height = mesh.shared().limit()->heights[triangle.patch.face];
            at.ray_offset.push_back(mesh.seen_side(p, at.geometric_normal.back()) *
                                    (height * mesh.frame_scale()));
        }
    }
    spread_corners(1, at.normal, grid.normal);
    spread_corners(1, at.geometric_normal, grid.geometric_normal);
    spread_corners(1, at.dp_du, grid.dp_du);
    spread_corners(1, at.dp_dv, grid.dp_dv);
    spread_corners(1, at.normal_corners, grid.normal_corners);
    if (!at.rise.empty()) spread_corners(1, at.rise, grid.rise);
    if (!at.ray_offset.empty()) spread_corners(1, at.ray_offset, grid.ray_offset);
    std::vector<std::uint32_t> faces;
    for (const FaceTriangle& triangle : wanted) faces.push_back(triangle.patch.face);
    repeat_runs(faces, grid.shading_positions.faces);

    const auto fill = [&](const AttributeRequest& request, GridAttribute& out) {
        const auto width = static_cast<std::size_t>(out.width);
        std::vector<float> values, du, dv, all, all_du, all_dv;
        for (std::size_t t = 0; t < count; ++t) {
            const std::array<Vec2d, 3> places = corner_places(wanted[t]);
            mesh.attribute(wanted[t].patch, request, places, values, du, dv);
            mesh.displace(wanted[t].patch, wanted[t].patch.kind, request, places, values, du, dv);
            all.insert(all.end(), values.begin(), values.end());
            if (!request.derivatives) continue;
            for (const float step : du) all_du.push_back(step * stretches[t]);
            for (const float step : dv) all_dv.push_back(step * stretches[t]);
        }
        spread_corners(width, all, out.values);
        if (!request.derivatives) return;
        spread_corners(width, all_du, out.du);
        spread_corners(width, all_dv, out.dv);
    };
    make_attributes(grid, mesh.view().requests_of(grid.material), fill);
    return grid;
}

}  // namespace granita
