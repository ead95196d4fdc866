// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/face_triangles.h"

#include <algorithm>
#include <array>

#include "dice/grid_attributes.h"
#include "dice/motion_bounds.h"
#include "geometry/limit_vertices.h"

namespace granita {
namespace {

/// Of the corner in each of a grid's four runs of vertices: the last one repeats.
constexpr std::size_t kCornerOfRun[4] = {0, 1, 2, 2};

std::array<Vec2d, 3> corner_places(const FaceTriangle& triangle) {
    const Vec2d a(0.0, 0.0), b(1.0, 0.0), c(1.0, 1.0), d(0.0, 1.0);
    if (triangle.patch.kind == PatchKind::Triangle) return {a, b, d};
    return triangle.of.second ? std::array{a, c, d} : std::array{a, b, c};
}

/// [4 n] from [n]: values of a triangle's corners as vertices of the grid.
template <class Value>
void spread(std::size_t count, std::size_t width, const std::vector<Value>& of_corners,
            std::vector<Value>& out) {
    out.reserve(4 * count * width);
    for (const std::size_t corner : kCornerOfRun)
        for (std::size_t t = 0; t < count; ++t)
            for (std::size_t c = 0; c < width; ++c)
                out.push_back(of_corners[(3 * t + corner) * width + c]);
}

void place(const Grid& batch, std::span<const FaceTriangle> wanted, Grid& grid) {
    const auto stride = static_cast<std::size_t>(batch.vertex_count());
    grid.positions.reserve(4 * wanted.size() * static_cast<std::size_t>(grid.knots));
    for (std::size_t k = 0; k < static_cast<std::size_t>(grid.knots); ++k)
        for (const std::size_t corner : kCornerOfRun)
            for (const FaceTriangle& triangle : wanted) {
                const Grid::Corners c = batch.corners(static_cast<int>(triangle.of.micropolygon));
                const int first[3] = {c.v0, c.v1, c.v2}, second[3] = {c.v0, c.v2, c.v3};
                const int v = (triangle.of.second ? second : first)[corner];
                grid.positions.push_back(batch.positions[k * stride + static_cast<std::size_t>(v)]);
            }
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
    std::vector<Vec3f> normal, geometric_normal, dp_du, dp_dv, ray_offset;
    std::vector<Vec4f> rise;
};

}  // namespace

Grid face_triangles(const OpenedMesh& mesh, const Grid& batch,
                    std::span<const FaceTriangle> wanted) {
    const std::size_t count = wanted.size();
    Grid grid;
    grid.key = batch.key;
    grid.instance = batch.instance;
    grid.material = batch.material;
    grid.holdout = batch.holdout;
    grid.lifespan = batch.lifespan;
    grid.disjoint = true;
    grid.n_u = static_cast<int>(count);
    grid.n_v = 1;
    grid.knots = batch.knots;
    grid.motion = batch.motion;
    grid.terminator_offset = mesh.instance().terminator_offset;
    place(batch, wanted, grid);
    set_frame_positions(grid, mesh.knots());
    CornerState at;
    std::vector<float> stretches;
    for (std::size_t t = 0; t < count; ++t) {
        const FaceTriangle& triangle = wanted[t];
        const FrameFace face = mesh.frame_face(triangle.patch);
        const Vec3f& p = grid.shading_p()[t];
        for (const Vec2d& uv : corner_places(triangle)) {
            const CornerWeights weights(triangle.patch.kind, uv);
            const Vec3d su = face.by_u(weights), sv = face.by_v(weights);
            const Vec3d flat = face.geometric_normal(su, sv);
            if (stretches.size() == t) stretches.push_back(stretch_of(mesh, p, su, sv));
            at.geometric_normal.emplace_back(flat);
            at.normal.emplace_back(face.shading_normal(weights, flat));
            at.dp_du.emplace_back(su * double(stretches[t]));
            at.dp_dv.emplace_back(sv * double(stretches[t]));
            if (mesh.rises()) at.rise.push_back(mesh.rise(face, weights, flat));
            if (!mesh.shared().subdivision()) continue;
            // The limit, which rays meet, may stand above the micropolygon.
            const Vec3f view = mesh.view().projection.perspective ? p : Vec3f(0.0f, 0.0f, 1.0f);
            const Vec3f outward(flat);
            const Vec3f up = glm::dot(outward, view) > 0.0f ? -outward : outward;
            const float height = mesh.shared().limit()->heights[triangle.patch.face];
            at.ray_offset.push_back(up * (height * mesh.frame_scale()));
        }
    }
    spread(count, 1, at.normal, grid.normal);
    spread(count, 1, at.geometric_normal, grid.geometric_normal);
    spread(count, 1, at.dp_du, grid.dp_du);
    spread(count, 1, at.dp_dv, grid.dp_dv);
    if (!at.rise.empty()) spread(count, 1, at.rise, grid.rise);
    if (!at.ray_offset.empty()) spread(count, 1, at.ray_offset, grid.ray_offset);
    for (int run = 0; run < 4; ++run)
        for (const FaceTriangle& triangle : wanted)
            grid.shading_positions.faces.push_back(triangle.patch.face);

    const auto fill = [&](const AttributeRequest& request, GridAttribute& out) {
        const auto width = static_cast<std::size_t>(out.width);
        std::vector<float> values, du, dv, all, all_du, all_dv;
        for (std::size_t t = 0; t < count; ++t) {
            const std::array<Vec2d, 3> places = corner_places(wanted[t]);
            mesh.attribute(wanted[t].patch, request, places, values, du, dv);
            all.insert(all.end(), values.begin(), values.end());
            if (!request.derivatives) continue;
            for (const float step : du) all_du.push_back(step * stretches[t]);
            for (const float step : dv) all_dv.push_back(step * stretches[t]);
        }
        spread(count, width, all, out.values);
        if (!request.derivatives) return;
        spread(count, width, all_du, out.du);
        spread(count, width, all_dv, out.dv);
    };
    make_attributes(grid, mesh.view().requests_of(grid.material), fill);
    return grid;
}

}  // namespace granita
