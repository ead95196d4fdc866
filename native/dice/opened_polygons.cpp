// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/opened_polygons.h"

#include <algorithm>

#include "dice/corner_values.h"
#include "dice/face_batch.h"
#include "dice/lattice_stencil.h"
#include "dice/patch_batch.h"
#include "geometry/vertex_normals.h"
#include "math/unit_or.h"

namespace granita {
namespace {

Vec3d blend(const Vec3d* p, const std::array<double, 4>& w) {
    return FrameFace::blend(p, w);
}

}  // namespace

OpenedPolygons::OpenedPolygons(const View& view, std::size_t instance,
                               std::shared_ptr<const SharedGeometry> shared, Knots knots,
                               Report& report)
    : OpenedMesh(view, instance, std::move(shared), std::move(knots), report), m_small(*this) {
    if (!displaced()) return;
    const std::size_t n = data().vertex_count();
    for (int k = 0; k < knot_count(); ++k) {
        std::vector<Vec3f> normals = granita::vertex_normals(data(), {&point(k, 0), n});
        for (Vec3f& normal : normals) normal *= static_cast<float>(orientation(k));
        m_directions.insert(m_directions.end(), normals.begin(), normals.end());
    }
}

OpenedMesh::Start OpenedPolygons::start(const BasePatch& patch, int budget) const {
    const SideWalker walk(*this, patch);
    const int n = patch.kind == PatchKind::Triangle ? 3 : 4;
    std::uint32_t vertex[4];
    for (int i = 0; i < n; ++i) vertex[i] = static_cast<std::uint32_t>(vertex_of(patch.corner[i]));
    Side around[4];  // side i leaves corner i
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
    } else {
        int levels[3];
        for (int i = 0; i < 3; ++i)
            levels[i] = around[i].levels < 0 ? budget + 1 : static_cast<int>(around[i].levels);
        const int base = triangle_base(levels);
        triangle_corners(base, start.corner_uv);
        start.sides[0] = around[base];
        start.sides[1] = around[(base + 1) % 3];
        start.sides[2].collapsed = true;
        start.sides[3] = around[(base + 2) % 3];
    }
    start.sides[3].reversed = !start.sides[3].reversed;
    if (n == 4) start.sides[2].reversed = !start.sides[2].reversed;
    return start;
}

OpenedPolygons::Corners OpenedPolygons::corners(const BasePatch& patch, int knot) const {
    Corners corners;
    for (int i = 0; i < 4; ++i)
        corners.p[i] = point(knot, static_cast<std::size_t>(vertex_of(patch.corner[i])));
    return corners;
}

std::vector<Bounds3f> OpenedPolygons::boxes(const BasePatch& patch, const Vec2d* corner_uv) const {
    Vec2d uv[4];
    std::copy_n(corner_uv, 4, uv);
    if (patch.kind != PatchKind::Triangle) {
        // A bilinear patch lies in the hull of the corners of any (u, v) rectangle around it.
        Vec2d lo = uv[0], hi = uv[0];
        for (const Vec2d& c : uv) lo = glm::min(lo, c), hi = glm::max(hi, c);
        uv[0] = lo, uv[1] = {hi.x, lo.y}, uv[2] = hi, uv[3] = {lo.x, hi.y};
    }
    std::vector<Bounds3f> boxes(static_cast<std::size_t>(knot_count()));
    for (int k = 0; k < knot_count(); ++k) {
        const Corners at = corners(patch, k);
        for (const Vec2d& c : uv)
            boxes[static_cast<std::size_t>(k)].add(
                Vec3f(blend(at.p, CornerWeights(patch.kind, c).w)));
    }
    return boxes;
}

void OpenedPolygons::edge_point(const EdgeRef& edge, double t, EdgePoint& out) const {
    for (int k = 0; k < knot_count(); ++k)
        out.p[k] = Vec3f(Vec3d(point(k, edge.a)) * (1.0 - t) + Vec3d(point(k, edge.b)) * t);
    if (!displaced()) return;
    const double amount = vertex_displacement(edge.a) * (1.0 - t) + vertex_displacement(edge.b) * t;
    const std::size_t n = data().vertex_count();
    for (int k = 0; k < knot_count(); ++k) {
        const Vec3f* directions = &m_directions[static_cast<std::size_t>(k) * n];
        const Vec3d along = Vec3d(directions[edge.a]) * (1.0 - t) + Vec3d(directions[edge.b]) * t;
        out.offset[k] = Vec3f(amount * unit_or(along, Vec3d(0.0, 0.0, -1.0)));
    }
}

bool OpenedPolygons::smooth(std::uint32_t face) const {
    return !data().smooth.empty() && data().smooth[face];
}

Vec3d OpenedPolygons::direction(const BasePatch& patch, int knot, const CornerWeights& weights,
                                const Corners& at) const {
    const Vec3d flat =
        orientation(knot) * face_direction(at.p, blend(at.p, weights.du), blend(at.p, weights.dv));
    if (!smooth(patch.face)) return flat;
    const Vec3f* normals = &m_directions[static_cast<std::size_t>(knot) * data().vertex_count()];
    Vec3d corner[4];
    for (int i = 0; i < 4; ++i) corner[i] = normals[vertex_of(patch.corner[i])];
    return unit_or(blend(corner, weights.w), flat);
}

FrameFace OpenedPolygons::frame_face(const BasePatch& patch) const {
    FrameFace face;
    const Corners at = corners(patch, knots().frame_knot);
    std::copy_n(at.p, 4, face.p);
    if (knots().frame_fraction > 0.0) {
        const Corners next = corners(patch, knots().frame_knot + 1);
        for (int i = 0; i < 4; ++i) face.p[i] = at_frame(at.p[i], next.p[i]);
    }
    face.orientation = frame_orientation();
    const bool custom = !data().corner_normals.empty();
    face.is_smooth = custom || (smooth(patch.face) && !shared().vertex_normals().empty());
    for (int i = 0; i < 4 && face.is_smooth; ++i) {
        const std::uint32_t corner = patch.corner[i];
        const Vec3f& normal =
            custom ? data().corner_normals[corner]
                   : shared().vertex_normals()[static_cast<std::size_t>(vertex_of(corner))];
        face.normal[i] = unit_or(camera_normal(normal), Vec3d(0.0));
    }
    return face;
}

std::vector<Bounds3f> OpenedPolygons::primitive_boxes(std::size_t primitive) const {
    const std::size_t others = m_small.others().size();
    if (primitive < others) return OpenedMesh::primitive_boxes(m_small.others()[primitive]);
    const std::span<const Bounds3f> boxes = m_small.boxes(primitive - others);
    return {boxes.begin(), boxes.end()};
}

std::unique_ptr<Primitive> OpenedPolygons::primitive(std::size_t primitive) const {
    const std::size_t others = m_small.others().size();
    if (primitive < others) return OpenedMesh::primitive(m_small.others()[primitive]);
    const std::size_t batch = primitive - others;
    auto self = std::static_pointer_cast<const OpenedPolygons>(shared_from_this());
    if (m_small.is_whole(batch))
        return std::make_unique<FaceBatch>(std::move(self), m_small.batch(batch),
                                           m_small.boxes(batch));
    return std::make_unique<PatchBatch>(std::move(self), m_small.batch(batch),
                                        m_small.boxes(batch));
}

void OpenedPolygons::surface_point(const BasePatch& patch, const Vec2d& uv, EdgePoint& out) const {
    const CornerWeights weights(patch.kind, uv);
    for (int k = 0; k < knot_count(); ++k) {
        const Corners at = corners(patch, k);
        out.p[k] = Vec3f(blend(at.p, weights.w));
        if (displaced())
            out.offset[k] = Vec3f(static_cast<double>(displacement(material(patch.face)).constant) *
                                  direction(patch, k, weights, at));
    }
}

void OpenedPolygons::sample(const BasePatch& patch, std::span<const Vec2d> uv,
                            SurfaceSamples& out) const {
    const std::size_t n = uv.size();
    static thread_local std::vector<CornerWeights> weights;  // kept for its memory
    weights.clear();
    for (const Vec2d& at : uv) weights.emplace_back(patch.kind, at);

    out.positions.resize(n * static_cast<std::size_t>(knot_count()));
    if (displaced()) out.offset.resize(out.positions.size());
    const double amount = displacement(material(patch.face)).constant;
    for (int k = 0; k < knot_count(); ++k) {
        const Corners at = corners(patch, k);
        const std::size_t base = static_cast<std::size_t>(k) * n;
        for (std::size_t i = 0; i < n; ++i) {
            out.positions[base + i] = Vec3f(blend(at.p, weights[i].w));
            if (displaced())
                out.offset[base + i] = Vec3f(amount * direction(patch, k, weights[i], at));
        }
    }

    const FrameFace face = frame_face(patch);
    out.su.resize(n);
    out.sv.resize(n);
    out.normal.resize(n);
    out.geometric_normal.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3d su = face.by_u(weights[i]), sv = face.by_v(weights[i]);
        const Vec3d flat = face.geometric_normal(su, sv);
        out.su[i] = Vec3f(su);
        out.sv[i] = Vec3f(sv);
        out.geometric_normal[i] = Vec3f(flat);
        out.normal[i] = Vec3f(face.shading_normal(weights[i], flat));
    }
}

void OpenedPolygons::attribute(const BasePatch& patch, const AttributeRequest& request,
                               std::span<const Vec2d> uv, std::vector<float>& values,
                               std::vector<float>& du, std::vector<float>& dv) const {
    interpolate(corner_values(shared(), patch, request), patch.kind, uv, request.width, values, du,
                dv);
}

}  // namespace granita
