// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/opened_polygons.h"

#include <algorithm>

#include "dice/lattice_stencil.h"
#include "geometry/patch_borders.h"
#include "math/normalize_or.h"

namespace granita {

OpenedPolygons::OpenedPolygons(const View& view, std::size_t instance,
                               std::shared_ptr<const SharedGeometry> shared, MeshPart part,
                               Knots knots, Report& report)
    : OpenedMesh(view, instance, std::move(shared), std::move(part), std::move(knots), report) {
    find_small_faces();
}

OpenedMesh::Start OpenedPolygons::start(const BasePatch& patch, int budget) const {
    const EdgeWalker walk(*this, patch);
    const int n = patch.kind == PatchKind::Triangle ? 3 : 4;
    std::uint32_t vertex[4];
    for (int i = 0; i < n; ++i) vertex[i] = static_cast<std::uint32_t>(vertex_of(patch.corner[i]));
    PatchEdge around[4];  // side i leaves corner i
    for (int i = 0; i < n; ++i) {
        const std::uint32_t a = vertex[i], b = vertex[(i + 1) % n];
        around[i].edge = {std::min(a, b), std::max(a, b)};
        around[i].reversed = a > b;
        around[i].budget = static_cast<std::uint8_t>(budget);
        walk.classify(around[i]);
    }
    Start start;
    if (n == 4) {
        static const Vec2d corner_uv[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        std::copy_n(corner_uv, 4, start.corner_uv);
        std::copy_n(around, 4, start.sides);
        for (const int side : {2, 3}) start.sides[side].reversed = !start.sides[side].reversed;
    } else {
        int levels[3];
        for (int i = 0; i < 3; ++i)
            levels[i] = around[i].levels < 0 ? budget + 1 : static_cast<int>(around[i].levels);
        const int base = triangle_base(levels);
        triangle_corners(base, start.corner_uv);
        set_triangle_sides(around, base, start.sides);
    }
    return start;
}

std::vector<Bounds3f> OpenedPolygons::boxes(const BasePatch& patch, const Vec2d* corner_uv) const {
    static thread_local std::vector<CornerWeights> weights;  // kept for its memory
    weights.clear();
    const std::span<const Vec2d> uv(corner_uv, 4);
    const auto add = [&](std::initializer_list<Vec2d> more) {
        for (const Vec2d& at : more) weights.emplace_back(patch.kind, at);
    };
    if (patch.kind == PatchKind::TrianglePair) {
        // In the hull of a (u, v) rectangle's corners and of where the crease enters and leaves it.
        Vec2d lo = uv[0], hi = uv[0];
        for (const Vec2d& c : uv) lo = glm::min(lo, c), hi = glm::max(hi, c);
        const double from = std::max(lo.x, lo.y), to = std::min(hi.x, hi.y);
        add({lo, {hi.x, lo.y}, hi, {lo.x, hi.y}});
        if (from < to) add({Vec2d(from), Vec2d(to)});
    } else {
        add({uv[0], uv[1], uv[2], uv[3]});
    }
    std::vector<Bounds3f> boxes(static_cast<std::size_t>(knot_count()));
    for (int k = 0; k < knot_count(); ++k) {
        const Corners at = corners(patch, k);
        for (const CornerWeights& of : weights)
            boxes[static_cast<std::size_t>(k)].add(Vec3f(blend(at.p, of.w)));
    }
    return boxes;
}

void OpenedPolygons::edge_point(const EdgeRef& edge, double t, EdgePoint& out) const {
    for (int k = 0; k < knot_count(); ++k)
        out.p[k] = Vec3f(Vec3d(point(k, edge.a)) * (1.0 - t) + Vec3d(point(k, edge.b)) * t);
}

SurfacePlace OpenedPolygons::edge_place(const EdgeRef& edge, double t) const {
    const PatchBorders& borders = shared().borders();
    return borders.place(borders.edge_of(edge.a, edge.b), t);
}

FrameFace OpenedPolygons::frame_face(const BasePatch& patch) const {
    FrameFace face = frame_corners(patch);
    face.is_smooth = shared().is_smooth(patch.face);
    for (int i = 0; i < 4 && face.is_smooth; ++i) {
        const Vec3f& normal = shared().smooth_normal(patch.corner[i]);
        face.normal[i] = normalize_or(camera_normal(normal), Vec3d(0.0));
    }
    return face;
}

void OpenedPolygons::surface_point(const BasePatch& patch, const Vec2d& uv, EdgePoint& out) const {
    const CornerWeights weights(patch.kind, uv);
    for (int k = 0; k < knot_count(); ++k) {
        const Corners at = corners(patch, k);
        out.p[k] = Vec3f(blend(at.p, weights.w));
    }
}

void OpenedPolygons::sample(const BasePatch& patch, std::span<const Vec2d> uv,
                            SurfaceSamples& out) const {
    const std::size_t n = uv.size();
    static thread_local std::vector<CornerWeights> weights;  // kept for its memory
    weights.clear();
    for (const Vec2d& at : uv) weights.emplace_back(patch.kind, at);

    out.positions.resize(n * static_cast<std::size_t>(knot_count()));
    for (int k = 0; k < knot_count(); ++k) {
        const Corners at = corners(patch, k);
        const std::size_t base = static_cast<std::size_t>(k) * n;
        for (std::size_t i = 0; i < n; ++i)
            out.positions[base + i] = Vec3f(blend(at.p, weights[i].w));
    }

    const FrameFace face = frame_face(patch);
    out.su.resize(n);
    out.sv.resize(n);
    out.normal.resize(n);
    out.geometric_normal.resize(n);
    const bool has_rise = rises();
    out.rise.resize(has_rise ? n : 0);
    TangentFrame at;
    for (std::size_t i = 0; i < n; ++i) {
        const bool is_same = i > 0 && !face.is_smooth && weights[i].du == weights[i - 1].du &&
                             weights[i].dv == weights[i - 1].dv;
        if (!is_same) at = face.frame(weights[i]);
        out.su[i] = Vec3f(at.su);
        out.sv[i] = Vec3f(at.sv);
        out.geometric_normal[i] = Vec3f(at.geometric_normal);
        out.normal[i] = Vec3f(at.normal);
        if (has_rise) out.rise[i] = rise(face, weights[i], at.geometric_normal);
    }
}

}  // namespace granita
