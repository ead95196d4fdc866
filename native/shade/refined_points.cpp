// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/refined_points.h"

#include <algorithm>

#include "geometry/anchor.h"
#include "geometry/knot_normals.h"
#include "math/normalize_or.h"
#include "scene/knot_time.h"
#include "shade/lights/vertex_paths.h"

namespace granita {
namespace {

/// The shading points around a place, and their weights.
struct Blend {
    std::size_t point[4];
    float weight[4];

    template <class T, class Of>
    T mean(const Of& of) const {
        T sum = of(point[0]) * weight[0];
        for (int k = 1; k < 4; ++k)
            if (weight[k] != 0.0f) sum += of(point[k]) * weight[k];
        return sum;
    }
};

/// A lattice's corners around the micropolygon, which lies in one of its cells.
Blend in_lattice(const Grid& grid, const RefinedPoint& at) {
    const int step_u = grid.shading_positions.step_u, step_v = grid.shading_positions.step_v;
    const auto row = static_cast<std::size_t>(grid.n_u / step_u) + 1;
    int low_u = grid.n_u, low_v = grid.n_v;
    float u = 0.0f, v = 0.0f;
    for (int k = 0; k < 3; ++k) {
        const int i = static_cast<int>(at.vertex[k]) % grid.up();
        const int j = static_cast<int>(at.vertex[k]) / grid.up();
        low_u = std::min(low_u, i);
        low_v = std::min(low_v, j);
        u += at.weight[k] * static_cast<float>(i);
        v += at.weight[k] * static_cast<float>(j);
    }
    const int cell_u = low_u / step_u, cell_v = low_v / step_v;
    const float x = u / static_cast<float>(step_u) - static_cast<float>(cell_u);
    const float y = v / static_cast<float>(step_v) - static_cast<float>(cell_v);
    const std::size_t first =
        static_cast<std::size_t>(cell_v) * row + static_cast<std::size_t>(cell_u);
    return {{first, first + 1, first + row, first + row + 1},
            {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y}};
}

Blend blend_at(const Grid& grid, const RefinedPoint& at) {
    if (grid.shades_lattice()) return in_lattice(grid, at);
    Blend blend{{0, 0, 0, grid.point_at(at.vertex[0])}, {0, 0, 0, 0.0f}};
    for (int k = 0; k < 3; ++k) {
        blend.point[k] = grid.point_at(at.vertex[k]);
        blend.weight[k] = at.weight[k];
    }
    return blend;
}

/// Of the micropolygon's triangle, whose corners are at `place(vertex)`.
template <class Place>
Anchor triangle_of(const RefinedPoint& at, const Place& place) {
    const Vec3f a = place(at.vertex[0]), b = place(at.vertex[1]), c = place(at.vertex[2]);
    return {at.weight[0] * a + at.weight[1] * b + at.weight[2] * c, b - a, c - a};
}

/// How far the surface that rays meet may rise, on one side, above the micropolygon at `p`: as far
/// as the planes in which it goes on from the corners do, be it curved or creased.
/// @param p in the camera's space, as the grid is.
float height_above(const Vec3f& p, const Blend& blend, const Grid& grid, float side) {
    float height = 0.0f;
    for (const std::size_t k : blend.point)
        height =
            std::max(height, side * glm::dot(grid.shading_p()[k] - p, grid.geometric_normal[k]));
    return height;
}

/// Shading normals of a mesh that changes its shape, which a micropolygon alone cannot tell: of a
/// smooth mesh they turn with the faces beside it too.
/// As FrameFace, where corners' normals are blended: uneven scale bends them.  The way to the
/// smooth surface (ShadingPoints::rise) goes along with the micropolygon all the same.
Vec3f normal_of_moment(const Grid& grid, const Blend& blend, float time, const Mat3f& from_normal) {
    const KnotTime t = grid.knot_normals->times().at(time);
    Vec3f normal(0.0f);
    for (int k = 0; k < 4; ++k) {
        if (blend.weight[k] == 0.0f) continue;
        const CornerBlend& of = grid.normal_corners[blend.point[k]];
        for (int i = 0; i < 4; ++i) {
            if (of.weight[i] == 0.0f) continue;
            const Vec3f corner(grid.knot_normals->of(of.corner[i], t));
            normal +=
                normalize_or(from_normal * corner, Vec3f(0.0f)) * (blend.weight[k] * of.weight[i]);
        }
    }
    return normal;
}

void add_blended(const Blend& blend, std::span<const float> values, std::size_t width, float by,
                 std::vector<float>& to) {
    for (std::size_t c = 0; c < width; ++c)
        to.push_back(by * blend.mean<float>([&](std::size_t i) { return values[i * width + c]; }));
}

GridAttribute blended(const GridAttribute& from, const std::vector<Blend>& blends,
                      float point_size) {
    GridAttribute out{from.attribute, from.width, {}, {}, {}};
    const auto width = static_cast<std::size_t>(from.width);
    const auto blend_all = [&](const std::vector<float>& values, std::vector<float>& to, float by) {
        if (values.empty()) return;
        to.reserve(blends.size() * width);
        for (const Blend& blend : blends) add_blended(blend, values, width, by, to);
    };
    blend_all(from.values, out.values, 1.0f);
    blend_all(from.du, out.du, point_size);
    blend_all(from.dv, out.dv, point_size);
    return out;
}

std::vector<Blend> blends_at(const Grid& grid, std::span<const RefinedPoint> wanted) {
    std::vector<Blend> blends;
    blends.reserve(wanted.size());
    for (const RefinedPoint& at : wanted) blends.push_back(blend_at(grid, at));
    return blends;
}

}  // namespace

std::vector<float> blended_at(const Grid& grid, std::span<const RefinedPoint> wanted,
                              std::span<const float> values, int width) {
    std::vector<float> out;
    out.reserve(wanted.size() * static_cast<std::size_t>(width));
    for (const RefinedPoint& at : wanted)
        add_blended(blend_at(grid, at), values, static_cast<std::size_t>(width), 1.0f, out);
    return out;
}

RefinedPoints::RefinedPoints(const Grid& grid, const Scene& scene, const ShadingCamera& camera,
                             const MovingEye& eye, std::span<const RefinedPoint> wanted, bool timed,
                             float point_size) {
    const Mat3f rotation(camera.world_from_camera);
    const VertexPaths paths(grid, scene);
    const auto time_of = [&](const RefinedPoint& at) {
        return at.time == kAnyTime ? scene.options.frame_time : at.time;
    };
    const std::vector<Mat4d>& from_object = scene.instances[grid.instance].world_from_object;
    ObjectAxes still;
    if (grid.knot_normals) still = ObjectAxes(matrix_at(from_object, 0.0));
    if (timed && !is_static(from_object))
        for (const RefinedPoint& at : wanted)
            axes_at_times.emplace_back(matrix_at(from_object, time_of(at)));
    points.count = wanted.size();
    points.terminator_offset = grid.terminator_offset;
    (camera.perspective ? points.pixel_slope : points.pixel_width) = camera.pixel;
    points.share = grid.point_share * refined_light_fraction(point_size * point_size);
    for (auto* values : {&points.p, &points.normal, &points.geometric_normal, &points.view,
                         &points.dp_du, &points.dp_dv})
        values->reserve(wanted.size());
    const auto& faces = grid.shading_positions.faces;
    const std::vector<Blend> blends = blends_at(grid, wanted);
    const auto take = [&](const std::vector<Vec3f>& from, std::vector<Vec3f>& to) {
        for (std::size_t i = 0; !from.empty() && i < blends.size(); ++i)
            to.push_back(blends[i].mean<Vec3f>([&](std::size_t point) { return from[point]; }));
    };
    take(grid.found.gathered, found.gathered);
    take(grid.found.gathered_world, found.gathered_world);
    take(grid.found.scattered, found.scattered);
    take(grid.found.scattered_bounced, found.scattered_bounced);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const RefinedPoint& at = wanted[i];
        const float time = time_of(at);
        const Blend& blend = blends[i];
        const auto mean = [&](const std::vector<Vec3f>& values) {
            return rotation * blend.mean<Vec3f>([&](std::size_t k) { return values[k]; });
        };
        const Anchor at_frame = triangle_of(at, [&](std::uint32_t v) { return paths.at_frame(v); });
        Vec3f p = at_frame.place;
        Mat3f turn(1.0f), turn_normal(1.0f);
        if (paths.moves()) {
            const Anchor then = triangle_of(at, [&](std::uint32_t v) { return paths.at(v, time); });
            p = then.place;
            turn = carried(at_frame, then);
            turn_normal = glm::transpose(glm::inverse(turn));
        }
        const Vec3f view = eye.view(p, time);
        const Vec3f outward = normalize_or(turn_normal * mean(grid.geometric_normal), view);
        const float side = glm::dot(outward, view) < 0.0f ? -1.0f : 1.0f;
        points.p.push_back(p);
        Vec3f normal = turn_normal * mean(grid.normal);
        if (grid.knot_normals && at.time != kAnyTime) {
            const ObjectAxes& axes = axes_at_times.empty() ? still : axes_at_times[i];
            normal = normalize_or(
                normal_of_moment(grid, blend, time, axes.world_normal_from_object()), normal);
        }
        points.normal.push_back(normalize_or(normal, outward) * side);
        points.geometric_normal.push_back(outward * side);
        points.view.push_back(view);
        points.dp_du.push_back(turn * mean(grid.dp_du) * point_size);
        points.dp_dv.push_back(turn * mean(grid.dp_dv) * point_size);
        points.backfacing.push_back(side < 0.0f);
        points.places.push_back(at.place);
        const float lift = height_above(at_frame.place * rotation, blend, grid, side);
        Vec3f offset = points.geometric_normal.back() * lift;
        if (!grid.ray_offset.empty()) offset += turn * mean(grid.ray_offset);
        points.ray_offset.push_back(offset);
        if (!grid.rise.empty()) {
            const Vec3f rise = blend.mean<Vec3f>([&](std::size_t k) { return grid.rise[k]; });
            points.rise.push_back(turn * rotation * rise);
        }
        if (!faces.empty()) points.faces.push_back(faces[blend.point[0]]);
        if (timed) points.times.push_back(at.time);
    }
    for (const GridAttribute& attribute : grid.attributes)
        attributes.push_back(blended(attribute, blends, point_size));
}

RefinedPoints::RefinedPoints(const Grid& grid, std::span<const RefinedPoint> wanted)
    : points(painted_points(wanted.size())) {
    const std::vector<Blend> blends = blends_at(grid, wanted);
    for (const GridAttribute& attribute : grid.attributes)
        attributes.push_back(blended(attribute, blends, 1.0f));
}

}  // namespace granita
