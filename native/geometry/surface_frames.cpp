// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface_frames.h"

#include <algorithm>

#include "geometry/corner_values.h"
#include "geometry/knot_normals.h"
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

std::array<Vec3d, 4> corners(const SharedGeometry& geometry, const BasePatch& patch,
                             const KnotTime& time) {
    if (time == geometry.frame()) return corners(geometry, patch, geometry.frame_points());
    const int knot = static_cast<int>(time.knot);
    std::array<Vec3d, 4> at = corners(geometry, patch, geometry.knot_points(knot));
    if (time.fraction == 0.0) return at;
    const std::array<Vec3d, 4> next = corners(geometry, patch, geometry.knot_points(knot + 1));
    for (std::size_t i = 0; i < 4; ++i) at[i] += (next[i] - at[i]) * time.fraction;
    return at;
}

std::array<Vec3d, 4> corner_normals(const SharedGeometry& geometry, const BasePatch& patch,
                                    const KnotTime& time) {
    const KnotNormals* const moving = time == geometry.frame() ? nullptr : geometry.knot_normals();
    std::array<Vec3d, 4> normals;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::uint32_t corner = patch.corner[i];
        normals[i] = moving ? moving->of(corner, moving->times().at(time))
                            : Vec3d(geometry.smooth_normal(corner));
    }
    return normals;
}

void resize(SurfaceFrames& out, std::size_t n) {
    for (auto* values : {&out.p, &out.su, &out.sv, &out.normal, &out.geometric_normal})
        values->resize(n);
}

void polygon_frames(const SharedGeometry& geometry, const BasePatch& patch,
                    std::span<const Vec2d> uv, const KnotTime& time, std::size_t first,
                    SurfaceFrames& out) {
    const std::array<Vec3d, 4> at = corners(geometry, patch, time);
    const bool smooth = geometry.is_smooth(patch.face);
    std::array<Vec3d, 4> normals{};
    if (smooth) normals = corner_normals(geometry, patch, time);
    const Vec3d across = normalize_or(glm::cross(at[2] - at[0], at[3] - at[1]), kUp);
    for (std::size_t k = 0; k < uv.size(); ++k) {
        const CornerWeights weights(patch.kind, uv[k]);
        const std::size_t i = first + k;
        out.p[i] = blend(at, weights.w);
        out.su[i] = blend(at, weights.du);
        out.sv[i] = blend(at, weights.dv);
        out.geometric_normal[i] = normalize_or(glm::cross(out.su[i], out.sv[i]), across);
        out.normal[i] = smooth ? normalize_or(blend(normals, weights.w), out.geometric_normal[i])
                               : out.geometric_normal[i];
    }
}

/// From the columns of a limit face to a time.
Vec3d at_time(const double* columns, const KnotTime& t) {
    const double* const p = columns + 3 * t.knot;
    Vec3d value(p[0], p[1], p[2]);
    if (t.fraction > 0.0) value = value * (1.0 - t.fraction) + Vec3d(p[3], p[4], p[5]) * t.fraction;
    return value;
}

void limit_frames(const SharedGeometry& geometry, const BasePatch& patch, std::span<const Vec2d> uv,
                  const KnotTime& time, std::size_t first, SurfaceFrames& out) {
    const int face = static_cast<int>(patch.face), sub = static_cast<int>(patch.sub);
    const LimitFace& limit = geometry.surface().limit_face(face);
    const FaceCoordinates coordinates(*geometry.subdivision(), face);
    const auto columns = static_cast<std::size_t>(limit.columns());
    const double scale = coordinates.sub_face_scale();
    std::vector<double> p(columns), du(columns), dv(columns);
    const auto normal_at = [&](const Vec2d& at, const Vec3d& otherwise) {
        limit.evaluate(coordinates.sub_face(sub, at), p.data(), du.data(), dv.data());
        return normalize_or(glm::cross(at_time(du.data(), time), at_time(dv.data(), time)),
                            otherwise);
    };
    // Where the parameters stall (a cage edge of no length) the middle of the face stands in.
    const Vec3d middle = normal_at({0.5, 0.5}, kUp);
    for (std::size_t k = 0; k < uv.size(); ++k) {
        const std::size_t i = first + k;
        out.geometric_normal[i] = out.normal[i] = normal_at(uv[k], middle);
        out.p[i] = at_time(p.data(), time);
        out.su[i] = scale * at_time(du.data(), time);
        out.sv[i] = scale * at_time(dv.data(), time);
    }
}

}  // namespace

void find_frames(const SharedGeometry& geometry, const BasePatch& patch, std::span<const Vec2d> uv,
                 const KnotTime& time, SurfaceFrames& out) {
    out.clear();
    add_frames(geometry, patch, uv, time, out);
}

void add_frames(const SharedGeometry& geometry, const BasePatch& patch, std::span<const Vec2d> uv,
                const KnotTime& time, SurfaceFrames& out) {
    const std::size_t first = out.p.size();
    resize(out, first + uv.size());
    if (geometry.subdivision())
        limit_frames(geometry, patch, uv, time, first, out);
    else
        polygon_frames(geometry, patch, uv, time, first, out);
}

bool find_smooth_face(const SharedGeometry& geometry, const BasePatch& patch, const KnotTime& time,
                      SmoothFace& out) {
    if (geometry.subdivision() || !geometry.is_smooth(patch.face)) return false;
    std::ranges::copy(corners(geometry, patch, time), out.p);
    std::ranges::copy(corner_normals(geometry, patch, time), out.normal);
    return true;
}

void find_positions(const SharedGeometry& geometry, const BasePatch& patch,
                    std::span<const Vec2d> uv, std::vector<Vec3f>& out) {
    const std::size_t n = uv.size();
    const int knots = geometry.surface_knots();
    out.resize(n * static_cast<std::size_t>(knots));
    if (!geometry.subdivision()) {
        for (int k = 0; k < knots; ++k) {
            const std::array<Vec3d, 4> at =
                corners(geometry, patch, KnotTime{static_cast<std::size_t>(k), 0.0});
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
