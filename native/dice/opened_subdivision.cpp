// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/opened_subdivision.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/error.h"
#include "dice/corner_values.h"
#include "math/unit_or.h"

namespace granita {
namespace {

const Vec3d kTowardsCamera(0.0, 0.0, -1.0);

/// Faces that a thread keeps ready.  Borders are their owner's business, so a patch asks for its
/// neighbours over and over; 128 hold the neighbours of all that is split at a time, in about a
/// megabyte.
constexpr std::size_t kSlots = 128;

std::uint64_t next_id() {
    static std::atomic<std::uint64_t> id{0};
    return ++id;
}

/// Generated coordinates are made of the object's own.
AttributeSource set_of(AttributeSource source) {
    return source == AttributeSource::Generated ? AttributeSource::ObjectPosition : source;
}

bool wants_positions(const View& view, AttributeSource set) {
    for (const auto& requests : view.requests)
        for (const AttributeRequest& request : requests)
            if (is_position(request.source) && set_of(request.source) == set) return true;
    return false;
}

Vec3d at(const std::vector<double>& columns, int set) {
    const double* p = &columns[3 * static_cast<std::size_t>(set)];
    return {p[0], p[1], p[2]};
}

}  // namespace

struct OpenedSubdivision::FaceSlot {
    std::uint64_t id = 0;  ///< of the opened instance
    int face = -1;
    LimitFace limit;
    std::vector<std::pair<int, LimitFace>> uv_maps;
};

OpenedSubdivision::OpenedSubdivision(const View& view, std::size_t instance,
                                     std::shared_ptr<const SharedGeometry> shared, Knots knots,
                                     Report& report)
    : OpenedMesh(view, instance, std::move(shared), std::move(knots), report), m_id(next_id()) {
    for (int k = 0; k < knot_count(); ++k) m_sets.push_back(&point(k, 0));
    for (const AttributeSource set :
         {AttributeSource::ObjectPosition, AttributeSource::PreviousPosition,
          AttributeSource::NextPosition}) {
        if (!wants_positions(view, set)) continue;
        m_position_column[set] = 3 * m_sets.size();
        m_sets.push_back(this->shared().points(set).data());
    }
}

OpenedSubdivision::FaceSlot& OpenedSubdivision::slot(int face) const {
    thread_local std::vector<FaceSlot> slots(kSlots);
    FaceSlot& slot = slots[(static_cast<std::size_t>(face) + m_id * 31) % kSlots];
    if (slot.id != m_id || slot.face != face) {
        slot.face = -1;
        slot.uv_maps.clear();
        if (!slot.limit.gather(topology(), face, m_sets))
            throw InternalError(data().name + ": face " + std::to_string(face) +
                                " has no limit surface");
        slot.id = m_id;
        slot.face = face;
    }
    return slot;
}

const LimitFace& OpenedSubdivision::face(int index) const {
    return slot(index).limit;
}

const LimitFace& OpenedSubdivision::uv_map(int face, int channel) const {
    FaceSlot& at = slot(face);
    for (const auto& [known, map] : at.uv_maps)
        if (known == channel) return map;
    LimitFace map;
    if (!map.gather_uv(topology(), face, channel))
        throw InternalError(data().name + ": face " + std::to_string(face) + " has no UV surface");
    return at.uv_maps.emplace_back(channel, std::move(map)).second;
}

Side OpenedSubdivision::base_side(std::uint32_t face, int local, std::int32_t from, int budget,
                                  const SideWalker& walk) const {
    const std::size_t index = topology().face_edge(face, local);
    const SubdivisionTopology::Edge& edge = topology().edge(index);
    Side side;
    side.edge = {static_cast<std::uint32_t>(index), kWhole};
    side.reversed = from != edge.lo;
    side.budget = static_cast<std::uint8_t>(budget);
    walk.classify(side);
    if (edge.halved && side.levels == 0) side.levels = 1;
    return side;
}

OpenedMesh::Start OpenedSubdivision::start(const BasePatch& patch, int budget) const {
    static const Vec2d corner_uv[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const SideWalker walk(*this, patch);
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
        Side side;
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
            const double* from = &p[i * columns + 3 * set];
            b[i] = {from[0], from[1], from[2]};
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
        for (std::size_t i = 3 * set; i < control.size(); i += columns)
            hull.add(Vec3f(control[i], control[i + 1], control[i + 2]));
        box.lo = glm::max(box.lo, hull.lo);
        box.hi = glm::min(box.hi, hull.hi);
    }
    return boxes;
}

void OpenedSubdivision::limit_point(int index, const Vec2d& uv, double amount,
                                    EdgePoint& out) const {
    const LimitFace& limit = face(index);
    const std::size_t columns = static_cast<std::size_t>(limit.columns());
    thread_local std::vector<double> p, du, dv;
    p.resize(columns);
    if (!displaced()) {
        limit.evaluate(uv, p.data());
        for (int k = 0; k < knot_count(); ++k) out.p[k] = Vec3f(at(p, k));
        return;
    }
    du.resize(columns);
    dv.resize(columns);
    limit.evaluate(uv, p.data(), du.data(), dv.data());
    for (int k = 0; k < knot_count(); ++k) {
        out.p[k] = Vec3f(at(p, k));
        out.offset[k] = Vec3f(
            amount * unit_or(orientation(k) * glm::cross(at(du, k), at(dv, k)), kTowardsCamera));
    }
}

void OpenedSubdivision::edge_point(const EdgeRef& ref, double t, EdgePoint& out) const {
    if (ref.b != kWhole) {
        const int index = static_cast<int>(ref.a);
        if (t == 0.0) {
            const std::size_t edge = topology().face_edge(ref.a, static_cast<int>(ref.b));
            edge_point({static_cast<std::uint32_t>(edge), kWhole}, 0.5, out);
            return;
        }
        const FaceCoordinates coordinates(topology(), index);
        // The spokes meet in the centre: the first sub-face's.
        const int sub = t == 1.0 ? 0 : static_cast<int>(ref.b);
        limit_point(index, coordinates.sub_face(sub, {1.0, t}),
                    displacement(material(ref.a)).constant, out);
        return;
    }
    const SubdivisionTopology::Edge& edge = topology().edge(ref.a);
    const bool at_vertex = t == 0.0 || t == 1.0;
    const std::size_t lo = static_cast<std::size_t>(edge.lo),
                      hi = static_cast<std::size_t>(edge.hi);
    const SubdivisionTopology::Owner& owner =
        at_vertex ? topology().vertex_owner(t == 0.0 ? lo : hi) : edge.owner;
    const double amount =
        displaced() ? vertex_displacement(lo) * (1.0 - t) + vertex_displacement(hi) * t : 0.0;
    const FaceCoordinates coordinates(topology(), owner.face);
    Vec2d uv;
    if (at_vertex) {
        uv = coordinates.vertex(owner.local);
    } else {
        const std::uint32_t corner = shared().first_corner(static_cast<std::size_t>(owner.face)) +
                                     static_cast<std::uint32_t>(owner.local);
        uv = coordinates.edge(owner.local, vertex_of(corner) == edge.lo ? t : 1.0 - t);
    }
    limit_point(owner.face, uv, amount, out);
}

void OpenedSubdivision::surface_point(const BasePatch& patch, const Vec2d& uv,
                                      EdgePoint& out) const {
    const int index = static_cast<int>(patch.face);
    const FaceCoordinates coordinates(topology(), index);
    limit_point(index, coordinates.sub_face(static_cast<int>(patch.sub), uv),
                displacement(material(patch.face)).constant, out);
}

void OpenedSubdivision::sample(const BasePatch& patch, std::span<const Vec2d> uv,
                               SurfaceSamples& out) const {
    const int index = static_cast<int>(patch.face);
    const LimitFace& limit = face(index);
    const FaceCoordinates coordinates(topology(), index);
    const std::size_t n = uv.size(), columns = static_cast<std::size_t>(limit.columns());
    const double scale = coordinates.sub_face_scale();
    const double amount = displacement(material(patch.face)).constant;
    std::vector<double> p(columns), du(columns), dv(columns);
    const auto frame = [&](const std::vector<double>& from) {
        const int k = knots().frame_knot;
        return knots().frame_fraction > 0.0 ? at_frame(at(from, k), at(from, k + 1)) : at(from, k);
    };
    // Where the parameters stall (a cage edge of no length) the middle of the face stands in.
    limit.evaluate(coordinates.sub_face(static_cast<int>(patch.sub), {0.5, 0.5}), p.data(),
                   du.data(), dv.data());
    const Vec3d middle =
        unit_or(frame_orientation() * glm::cross(frame(du), frame(dv)), kTowardsCamera);

    out.positions.resize(n * static_cast<std::size_t>(knot_count()));
    if (displaced()) out.offset.resize(out.positions.size());
    out.su.resize(n);
    out.sv.resize(n);
    out.geometric_normal.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        limit.evaluate(coordinates.sub_face(static_cast<int>(patch.sub), uv[i]), p.data(),
                       du.data(), dv.data());
        for (int k = 0; k < knot_count(); ++k) {
            const std::size_t to = static_cast<std::size_t>(k) * n + i;
            out.positions[to] = Vec3f(at(p, k));
            if (displaced())
                out.offset[to] = Vec3f(
                    amount * unit_or(orientation(k) * glm::cross(at(du, k), at(dv, k)), middle));
        }
        const Vec3d su = frame(du), sv = frame(dv);
        out.su[i] = Vec3f(scale * su);
        out.sv[i] = Vec3f(scale * sv);
        out.geometric_normal[i] = Vec3f(unit_or(frame_orientation() * glm::cross(su, sv), middle));
    }
    out.normal = out.geometric_normal;
}

void OpenedSubdivision::attribute(const BasePatch& patch, const AttributeRequest& request,
                                  std::span<const Vec2d> uv, std::vector<float>& values,
                                  std::vector<float>& du, std::vector<float>& dv) const {
    const Attribute* found = find_attribute(data(), request);
    const int channel =
        found ? topology().uv_channel(static_cast<std::size_t>(found - data().attributes.data()))
              : -1;
    const bool position = is_position(request.source);
    if (channel < 0 && !position) {
        interpolate(corner_values(shared(), patch, request), patch.kind, uv, request.width, values,
                    du, dv);
        return;
    }
    const int index = static_cast<int>(patch.face);
    const LimitFace& limit = channel >= 0 ? uv_map(index, channel) : face(index);
    const FaceCoordinates coordinates(topology(), index);
    const std::size_t columns = static_cast<std::size_t>(limit.columns());
    const std::size_t width = static_cast<std::size_t>(request.width);
    const std::size_t first = position ? m_position_column.at(set_of(request.source)) : 0;
    const std::size_t given = std::min(width, position ? 3 : columns);
    std::vector<double> p(columns), by_u(columns), by_v(columns);
    for (std::vector<float>* out : {&values, &du, &dv}) out->assign(uv.size() * width, 0.0f);
    const Vec3d box = Vec3d(shared().frame_box().hi) - Vec3d(shared().frame_box().lo);
    for (std::size_t i = 0; i < uv.size(); ++i) {
        limit.evaluate(coordinates.sub_face(static_cast<int>(patch.sub), uv[i]), p.data(),
                       by_u.data(), by_v.data());
        if (request.source == AttributeSource::Generated) {
            const Vec3d g = generated(shared().frame_box(), {p[first], p[first + 1], p[first + 2]});
            for (int c = 0; c < 3; ++c) {
                const std::size_t column = first + static_cast<std::size_t>(c);
                p[column] = g[c];
                by_u[column] = box[c] > 0.0 ? by_u[column] / box[c] : 0.0;
                by_v[column] = box[c] > 0.0 ? by_v[column] / box[c] : 0.0;
            }
        }
        for (std::size_t c = 0; c < given; ++c) {
            values[i * width + c] = static_cast<float>(p[first + c]);
            du[i * width + c] = static_cast<float>(coordinates.sub_face_scale() * by_u[first + c]);
            dv[i * width + c] = static_cast<float>(coordinates.sub_face_scale() * by_v[first + c]);
        }
    }
}

}  // namespace granita
