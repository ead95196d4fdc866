// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/opened_subdivision.h"

#include <algorithm>
#include <cmath>

#include "dice/whole_edges.h"
#include "geometry/limit_vertices.h"
#include "geometry/patch_borders.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

const Vec3d kTowardsCamera(0.0, 0.0, -1.0);

}  // namespace

OpenedSubdivision::OpenedSubdivision(const View& view, std::size_t instance,
                                     const std::shared_ptr<const SharedGeometry>& shared,
                                     Knots knots, Report& report)
    : OpenedMesh(view, instance, shared, MeshPart(*shared), std::move(knots), report) {
    for (int k = 0; k < knot_count(); ++k)
        m_times.push_back(knot_time(k, knot_count() - 1, this->shared().surface().knots()));
    m_whole = whole_edges(*this);
    find_small_faces();
}

Vec3d OpenedSubdivision::direction(const double* columns, int knot) const {
    const KnotTime& t = m_times[static_cast<std::size_t>(knot)];
    const double* const p = columns + 3 * t.knot;
    Vec3d object(p[0], p[1], p[2]);
    if (t.fraction > 0.0)
        object = object * (1.0 - t.fraction) + Vec3d(p[3], p[4], p[5]) * t.fraction;
    const Mat4d& m = knots().camera_from_object[static_cast<std::size_t>(knot)];
    return Vec3d(m[0]) * object.x + Vec3d(m[1]) * object.y + Vec3d(m[2]) * object.z;
}

Vec3d OpenedSubdivision::place(const double* columns, int knot) const {
    return direction(columns, knot) +
           Vec3d(knots().camera_from_object[static_cast<std::size_t>(knot)][3]);
}

PatchEdge OpenedSubdivision::base_side(std::uint32_t face, int local, std::int32_t from, int budget,
                                       const EdgeWalker& walk) const {
    const std::size_t index = topology().face_edge(face, local);
    const SubdivisionTopology::Edge& edge = topology().edge(index);
    PatchEdge side;
    side.edge = {static_cast<std::uint32_t>(index), kWhole};
    side.reversed = from != edge.lo;
    side.budget = static_cast<std::uint8_t>(budget);
    if (m_whole.empty() || !m_whole[index]) walk.classify(side);
    if (edge.halved && side.levels == 0) side.levels = 1;
    return side;
}

bool OpenedSubdivision::may_be_small(const BasePatch& patch) const {
    if (patch.kind != PatchKind::Quad || m_whole.empty()) return false;
    for (int i = 0; i < 4; ++i)
        if (!m_whole[topology().face_edge(patch.face, i)]) return false;
    return true;
}

FrameFace OpenedSubdivision::frame_face(const BasePatch& patch) const {
    FrameFace face = frame_corners(patch);
    face.is_smooth = true;
    for (int i = 0; i < 4; ++i) {
        const auto vertex = static_cast<std::size_t>(vertex_of(patch.corner[i]));
        face.normal[i] = normalize_or(camera_normal(shared().limit()->normals[vertex]), Vec3d(0.0));
    }
    return face;
}

OpenedMesh::Start OpenedSubdivision::start(const BasePatch& patch, int budget) const {
    static const Vec2d corner_uv[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const EdgeWalker walk(*this, patch);
    Start start;
    std::copy_n(corner_uv, 4, start.corner_uv);
    const std::uint32_t first = shared().first_corner(patch.face);
    if (patch.kind == PatchKind::Quad) {
        constexpr int from[4] = {0, 1, 3, 0};  // corner where a side starts, seen from the patch
        for (int i = 0; i < 4; ++i)
            start.sides[i] = base_side(
                patch.face, i, vertex_of(first + static_cast<unsigned>(from[i])), budget, walk);
        return start;
    }
    const std::uint32_t n = static_cast<std::uint32_t>(data().face_sizes[patch.face]);
    const std::uint32_t last = (patch.sub + n - 1) % n;
    const std::int32_t here = vertex_of(first + patch.sub);
    const auto spoke = [&](std::uint32_t corner) {
        PatchEdge side;
        side.edge = {patch.face, corner};
        side.budget = static_cast<std::uint8_t>(budget);
        walk.classify(side);
        return side;
    };
    start.sides[0] =
        walk.half(base_side(patch.face, static_cast<int>(patch.sub), here, budget, walk), 0);
    start.sides[1] = spoke(patch.sub);
    start.sides[2] = spoke(last);
    start.sides[3] =
        walk.half(base_side(patch.face, static_cast<int>(last), here, budget, walk), 0);
    return start;
}

std::vector<Bounds3f> OpenedSubdivision::boxes(const BasePatch& patch,
                                               const Vec2d* corner_uv) const {
    const LimitFace& limit = face(static_cast<int>(patch.face));
    const FaceCoordinates coordinates(topology(), static_cast<int>(patch.face));
    Vec2d lo = corner_uv[0], hi = corner_uv[0];
    for (int i = 1; i < 4; ++i) lo = glm::min(lo, corner_uv[i]), hi = glm::max(hi, corner_uv[i]);

    const std::size_t columns = static_cast<std::size_t>(limit.columns());
    std::vector<double> p(16 * columns);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
            limit.evaluate(
                coordinates.sub_face(static_cast<int>(patch.sub), {lo.x + (hi.x - lo.x) * i / 3.0,
                                                                   lo.y + (hi.y - lo.y) * j / 3.0}),
                &p[static_cast<std::size_t>(4 * j + i) * columns]);

    // The Bezier points of the bicubic through the sixteen bound it; a regular face is that
    // bicubic. An irregular one is left by its second differences: at most an eighth of the largest
    // could lie beyond the samples if it were the same all over, so the whole of it is a wide
    // margin.
    std::vector<Bounds3f> boxes(static_cast<std::size_t>(knot_count()));
    const std::span<const double> control = limit.control_points();
    for (std::size_t set = 0; set < boxes.size(); ++set) {
        Bounds3f& box = boxes[set];
        Vec3d b[16], slack(0.0);
        for (std::size_t i = 0; i < 16; ++i) {
            b[i] = place(&p[i * columns], static_cast<int>(set));
        }
        const auto line = [&](int first, int step) {
            Vec3d& f0 = b[first];
            Vec3d& f1 = b[first + step];
            Vec3d& f2 = b[first + 2 * step];
            Vec3d& f3 = b[first + 3 * step];
            slack = glm::max(slack,
                             glm::max(glm::abs(f0 - 2.0 * f1 + f2), glm::abs(f1 - 2.0 * f2 + f3)));
            const Vec3d b1 = (-5.0 * f0 + 18.0 * f1 - 9.0 * f2 + 2.0 * f3) / 6.0;
            const Vec3d b2 = (2.0 * f0 - 9.0 * f1 + 18.0 * f2 - 5.0 * f3) / 6.0;
            f1 = b1;
            f2 = b2;
        };
        for (int j = 0; j < 4; ++j) line(4 * j, 1);
        for (int i = 0; i < 4; ++i) line(i, 4);
        if (limit.is_regular()) slack = Vec3d(0.0);
        for (const Vec3d& corner : b) {
            box.add(Vec3f(corner - slack));
            box.add(Vec3f(corner + slack));
        }
        if (limit.is_regular()) continue;
        Bounds3f hull;
        for (std::size_t i = 0; i < control.size(); i += columns)
            hull.add(Vec3f(place(&control[i], static_cast<int>(set))));
        box.lo = glm::max(box.lo, hull.lo);
        box.hi = glm::min(box.hi, hull.hi);
    }
    return boxes;
}

void OpenedSubdivision::limit_point(int index, const Vec2d& uv, EdgePoint& out) const {
    const LimitFace& limit = face(index);
    thread_local std::vector<double> p;
    p.resize(static_cast<std::size_t>(limit.columns()));
    limit.evaluate(uv, p.data());
    for (int k = 0; k < knot_count(); ++k) out.p[k] = Vec3f(place(p.data(), k));
}

void OpenedSubdivision::copy_vertex(std::size_t vertex, EdgePoint& out) const {
    for (int k = 0; k < knot_count(); ++k) out.p[k] = point(k, vertex);
}

void OpenedSubdivision::edge_point(const EdgeRef& ref, double t, EdgePoint& out) const {
    if (ref.b == kWhole) {
        cage_point(ref.a, t, out);
        return;
    }
    const int index = static_cast<int>(ref.a);
    if (t == 0.0) {
        cage_point(topology().face_edge(ref.a, static_cast<int>(ref.b)), 0.5, out);
        return;
    }
    // The spokes meet in the centre: the first sub-face's.
    const int sub = t == 1.0 ? 0 : static_cast<int>(ref.b);
    limit_point(index, FaceCoordinates(topology(), index).sub_face(sub, {1.0, t}), out);
}

SurfacePlace OpenedSubdivision::edge_place(const EdgeRef& ref, double t) const {
    const PatchBorders& borders = shared().borders();
    return borders.place(
        ref.b == kWhole ? PatchBorders::cage_edge(ref.a) : borders.spoke(ref.a, ref.b), t);
}

void OpenedSubdivision::cage_point(std::size_t index, double t, EdgePoint& out) const {
    const SubdivisionTopology::Edge& edge = topology().edge(index);
    if (t == 0.0 || t == 1.0) {
        copy_vertex(static_cast<std::size_t>(t == 0.0 ? edge.lo : edge.hi), out);
        return;
    }
    const SubdivisionTopology::Owner& owner = edge.owner;
    const std::uint32_t corner = shared().first_corner(static_cast<std::size_t>(owner.face)) +
                                 static_cast<std::uint32_t>(owner.local);
    limit_point(owner.face,
                FaceCoordinates(topology(), owner.face)
                    .edge(owner.local, vertex_of(corner) == edge.lo ? t : 1.0 - t),
                out);
}

void OpenedSubdivision::surface_point(const BasePatch& patch, const Vec2d& uv,
                                      EdgePoint& out) const {
    const int index = static_cast<int>(patch.face);
    const FaceCoordinates coordinates(topology(), index);
    limit_point(index, coordinates.sub_face(static_cast<int>(patch.sub), uv), out);
}

void OpenedSubdivision::sample(const BasePatch& patch, std::span<const Vec2d> uv,
                               SurfaceSamples& out) const {
    const int index = static_cast<int>(patch.face);
    const LimitFace& limit = face(index);
    const FaceCoordinates coordinates(topology(), index);
    const std::size_t n = uv.size(), columns = static_cast<std::size_t>(limit.columns());
    const double scale = coordinates.sub_face_scale();
    std::vector<double> p(columns), du(columns), dv(columns);
    const auto frame = [&](const std::vector<double>& from) {
        const int k = knots().frame_knot;
        const Vec3d there = direction(from.data(), k);
        return knots().frame_fraction > 0.0 ? at_frame(there, direction(from.data(), k + 1))
                                            : there;
    };
    // Where the parameters stall (a cage edge of no length) the middle of the face stands in.
    limit.evaluate(coordinates.sub_face(static_cast<int>(patch.sub), {0.5, 0.5}), p.data(),
                   du.data(), dv.data());
    const Vec3d middle =
        normalize_or(frame_orientation() * glm::cross(frame(du), frame(dv)), kTowardsCamera);

    out.positions.resize(n * static_cast<std::size_t>(knot_count()));
    out.su.resize(n);
    out.sv.resize(n);
    out.geometric_normal.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        limit.evaluate(coordinates.sub_face(static_cast<int>(patch.sub), uv[i]), p.data(),
                       du.data(), dv.data());
        for (int k = 0; k < knot_count(); ++k) {
            const std::size_t to = static_cast<std::size_t>(k) * n + i;
            out.positions[to] = Vec3f(place(p.data(), k));
        }
        const Vec3d su = frame(du), sv = frame(dv);
        out.su[i] = Vec3f(scale * su);
        out.sv[i] = Vec3f(scale * sv);
        out.geometric_normal[i] =
            Vec3f(normalize_or(frame_orientation() * glm::cross(su, sv), middle));
    }
    out.normal = out.geometric_normal;
    out.rise.clear();
}

}  // namespace granita
