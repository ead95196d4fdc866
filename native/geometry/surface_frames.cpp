// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface_frames.h"

#include <algorithm>

#include "geometry/corner_values.h"
#include "geometry/surface_evaluator.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

const Vec3d kUp(0.0, 0.0, 1.0);

std::array<Vec3d, 4> corners(const SharedGeometry& geometry, const BasePatch& patch,
                             std::span<const Vec3f> points) {
    std::array<Vec3d, 4> at;
    for (std::size_t i = 0; i < 4; ++i)
        at[i] = points[static_cast<std::size_t>(geometry.data().corner_verts[patch.corner[i]])];
    return at;
}

bool is_smooth(const SharedGeometry& geometry, std::uint32_t face) {
    const GeometryData& data = geometry.data();
    if (!data.corner_normals.empty()) return true;
    return !data.smooth.empty() && data.smooth[face] && !geometry.vertex_normals().empty();
}

std::array<Vec3d, 4> corner_normals(const SharedGeometry& geometry, const BasePatch& patch) {
    const GeometryData& data = geometry.data();
    std::array<Vec3d, 4> normals;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::uint32_t corner = patch.corner[i];
        const auto vertex = static_cast<std::size_t>(data.corner_verts[corner]);
        normals[i] = data.corner_normals.empty() ? geometry.vertex_normals()[vertex]
                                                 : data.corner_normals[corner];
    }
    return normals;
}

void resize(SurfaceFrames& out, std::size_t n) {
    for (auto* values : {&out.p, &out.su, &out.sv, &out.normal, &out.geometric_normal})
        values->resize(n);
}

void polygon_frames(const SharedGeometry& geometry, const BasePatch& patch,
                    std::span<const Vec2d> uv, SurfaceFrames& out) {
    const std::array<Vec3d, 4> at = corners(geometry, patch, geometry.frame_points());
    const bool smooth = is_smooth(geometry, patch.face);
    std::array<Vec3d, 4> normals{};
    if (smooth) normals = corner_normals(geometry, patch);
    const Vec3d across = normalize_or(glm::cross(at[2] - at[0], at[3] - at[1]), kUp);
    for (std::size_t i = 0; i < uv.size(); ++i) {
        const CornerWeights weights(patch.kind, uv[i]);
        out.p[i] = blend(at, weights.w);
        out.su[i] = blend(at, weights.du);
        out.sv[i] = blend(at, weights.dv);
        out.geometric_normal[i] = normalize_or(glm::cross(out.su[i], out.sv[i]), across);
        out.normal[i] = smooth ? normalize_or(blend(normals, weights.w), out.geometric_normal[i])
                               : out.geometric_normal[i];
    }
}

/// From the columns of a limit face to the frame time.
Vec3d at_frame(const double* columns, const KnotTime& t) {
    const double* const p = columns + 3 * t.knot;
    Vec3d value(p[0], p[1], p[2]);
    if (t.fraction > 0.0) value = value * (1.0 - t.fraction) + Vec3d(p[3], p[4], p[5]) * t.fraction;
    return value;
}

void limit_frames(const SharedGeometry& geometry, const BasePatch& patch, std::span<const Vec2d> uv,
                  SurfaceFrames& out) {
    const int face = static_cast<int>(patch.face), sub = static_cast<int>(patch.sub);
    const LimitFace& limit = geometry.surface().limit_face(face);
    const FaceCoordinates coordinates(*geometry.subdivision(), face);
    const auto columns = static_cast<std::size_t>(limit.columns());
    const double scale = coordinates.sub_face_scale();
    const KnotTime t = geometry.surface().knots() == 1 ? KnotTime{} : geometry.frame();
    std::vector<double> p(columns), du(columns), dv(columns);
    const auto normal_at = [&](const Vec2d& at, const Vec3d& otherwise) {
        limit.evaluate(coordinates.sub_face(sub, at), p.data(), du.data(), dv.data());
        return normalize_or(glm::cross(at_frame(du.data(), t), at_frame(dv.data(), t)), otherwise);
    };
    // Where the parameters stall (a cage edge of no length) the middle of the face stands in.
    const Vec3d middle = normal_at({0.5, 0.5}, kUp);
    for (std::size_t i = 0; i < uv.size(); ++i) {
        out.geometric_normal[i] = out.normal[i] = normal_at(uv[i], middle);
        out.p[i] = at_frame(p.data(), t);
        out.su[i] = scale * at_frame(du.data(), t);
        out.sv[i] = scale * at_frame(dv.data(), t);
    }
}

}  // namespace

void find_frames(const SharedGeometry& geometry, const BasePatch& patch, std::span<const Vec2d> uv,
                 SurfaceFrames& out) {
    resize(out, uv.size());
    if (geometry.subdivision())
        limit_frames(geometry, patch, uv, out);
    else
        polygon_frames(geometry, patch, uv, out);
}

bool find_smooth_face(const SharedGeometry& geometry, const BasePatch& patch, SmoothFace& out) {
    if (geometry.subdivision() || !is_smooth(geometry, patch.face)) return false;
    std::ranges::copy(corners(geometry, patch, geometry.frame_points()), out.p);
    std::ranges::copy(corner_normals(geometry, patch), out.normal);
    return true;
}

void find_positions(const SharedGeometry& geometry, const BasePatch& patch,
                    std::span<const Vec2d> uv, std::vector<Vec3f>& out) {
    const std::size_t n = uv.size();
    const int knots = geometry.surface_knots();
    out.resize(n * static_cast<std::size_t>(knots));
    if (!geometry.subdivision()) {
        for (int k = 0; k < knots; ++k) {
            const std::array<Vec3d, 4> at = corners(
                geometry, patch, knots == 1 ? geometry.frame_points() : geometry.knot_points(k));
            for (std::size_t i = 0; i < n; ++i)
                out[static_cast<std::size_t>(k) * n + i] =
                    Vec3f(blend(at, CornerWeights(patch.kind, uv[i]).w));
        }
        return;
    }
    const int face = static_cast<int>(patch.face);
    const LimitFace& limit = geometry.surface().limit_face(face);
    const FaceCoordinates coordinates(*geometry.subdivision(), face);
    std::vector<double> p(static_cast<std::size_t>(limit.columns()));
    for (std::size_t i = 0; i < n; ++i) {
        limit.evaluate(coordinates.sub_face(static_cast<int>(patch.sub), uv[i]), p.data());
        for (std::size_t k = 0; k < static_cast<std::size_t>(knots); ++k)
            out[k * n + i] = {static_cast<float>(p[3 * k]), static_cast<float>(p[3 * k + 1]),
                              static_cast<float>(p[3 * k + 2])};
    }
}

}  // namespace granita
