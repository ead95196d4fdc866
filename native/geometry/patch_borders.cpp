// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/patch_borders.h"

#include <algorithm>
#include <tuple>

#include "geometry/subdivision_topology.h"

namespace granita {
namespace {

Vec2d corner_uv(PatchKind kind, int corner) {
    static const Vec2d triangle[4] = {{0, 0}, {1, 0}, {0, 1}, {0, 1}};
    static const Vec2d quad[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    return (kind == PatchKind::Triangle ? triangle : quad)[corner];
}

}  // namespace

PatchBorders::PatchBorders(const SharedGeometry& geometry) : m_geometry(geometry) {
    if (const SubdivisionTopology* topology = geometry.subdivision())
        m_edge_count = topology->edge_count() + geometry.data().corner_verts.size();
    else
        find_polygon_edges();
}

void PatchBorders::find_polygon_edges() {
    const std::vector<std::int32_t>& verts = m_geometry.data().corner_verts;
    const std::vector<BasePatch>& patches = m_geometry.patches();
    constexpr std::uint32_t kNobody = 0xffffffffu;
    m_vertex_owners.assign(m_geometry.data().vertex_count(), kNobody);
    const auto add = [&](std::uint32_t k, int a, int b) {
        const auto from = static_cast<std::uint32_t>(verts[patches[k].corner[a]]);
        const auto to = static_cast<std::uint32_t>(verts[patches[k].corner[b]]);
        const bool turned = from > to;
        m_edges.push_back({std::min(from, to), std::max(from, to), k,
                           static_cast<std::uint8_t>(turned ? b : a),
                           static_cast<std::uint8_t>(turned ? a : b)});
    };
    for (std::uint32_t k = 0; k < patches.size(); ++k) {
        const int n = side_count(patches[k].kind);
        for (int i = 0; i < n; ++i) {
            std::uint32_t& owner =
                m_vertex_owners[static_cast<std::size_t>(verts[patches[k].corner[i]])];
            owner = std::min(owner, 4 * k + static_cast<std::uint32_t>(i));
            add(k, i, (i + 1) % n);
        }
        // A bent pair is diced as two triangles, which share the crease.
        if (patches[k].kind == PatchKind::TrianglePair) add(k, 0, 2);
    }
    const auto key = [](const PolygonEdge& e) { return std::tie(e.lo, e.hi, e.patch, e.a, e.b); };
    std::ranges::sort(m_edges, {}, key);
    const auto is_same = [](const PolygonEdge& e, const PolygonEdge& f) {
        return e.lo == f.lo && e.hi == f.hi;
    };
    m_edges.erase(std::unique(m_edges.begin(), m_edges.end(), is_same), m_edges.end());
    m_edges.shrink_to_fit();
    m_edge_count = m_edges.size();
}

std::uint32_t PatchBorders::edge_of(std::uint32_t lo, std::uint32_t hi) const {
    const auto found = std::ranges::lower_bound(
        m_edges, std::pair(lo, hi), {}, [](const PolygonEdge& e) { return std::pair(e.lo, e.hi); });
    return static_cast<std::uint32_t>(found - m_edges.begin());
}

std::uint32_t PatchBorders::spoke(std::uint32_t face, std::uint32_t corner) const {
    return static_cast<std::uint32_t>(m_geometry.subdivision()->edge_count()) +
           m_geometry.first_corner(face) + corner;
}

PatchBorders::Side PatchBorders::side(std::size_t patch_index, int number) const {
    const BasePatch& patch = m_geometry.patches()[patch_index];
    const std::vector<std::int32_t>& verts = m_geometry.data().corner_verts;
    const SubdivisionTopology* topology = m_geometry.subdivision();
    if (!topology) {
        const int n = side_count(patch.kind);
        const auto from = static_cast<std::uint32_t>(verts[patch.corner[number]]);
        const auto to = static_cast<std::uint32_t>(verts[patch.corner[(number + 1) % n]]);
        Side side{edge_of(std::min(from, to), std::max(from, to)), 0.0, 1.0};
        if (from > to) std::swap(side.from, side.to);
        return side;
    }
    const std::uint32_t first = m_geometry.first_corner(patch.face);
    const auto around = [&](std::uint32_t local, double from, double to) {
        const std::size_t edge = topology->face_edge(patch.face, static_cast<int>(local));
        const bool turned = verts[first + local] != topology->edge(edge).lo;
        return Side{cage_edge(edge), turned ? 1.0 - from : from, turned ? 1.0 - to : to};
    };
    if (patch.kind == PatchKind::Quad) return around(static_cast<std::uint32_t>(number), 0.0, 1.0);
    const auto n = static_cast<std::uint32_t>(m_geometry.data().face_sizes[patch.face]);
    const std::uint32_t last = (patch.sub + n - 1) % n;
    switch (number) {
        case 0:
            return around(patch.sub, 0.0, 0.5);
        case 1:
            return {spoke(patch.face, patch.sub), 0.0, 1.0};
        case 2:
            return {spoke(patch.face, last), 1.0, 0.0};
        default:
            return around(last, 0.5, 1.0);
    }
}

SurfacePlace PatchBorders::place(std::uint32_t edge, double t) const {
    const SubdivisionTopology* topology = m_geometry.subdivision();
    if (!topology) {
        const PolygonEdge& at = m_edges[edge];
        if (t == 0.0) return vertex(at.lo);
        if (t == 1.0) return vertex(at.hi);
        const BasePatch& patch = m_geometry.patches()[at.patch];
        return {&patch, corner_uv(patch.kind, at.a) * (1.0 - t) + corner_uv(patch.kind, at.b) * t};
    }
    const std::size_t cage = topology->edge_count();
    if (edge < cage) return on_cage(edge, t);
    const std::uint32_t corner = edge - static_cast<std::uint32_t>(cage);
    const auto face = static_cast<std::uint32_t>(m_geometry.face_of(corner));
    const std::uint32_t local = corner - m_geometry.first_corner(face);
    if (t == 0.0) return on_cage(topology->face_edge(face, static_cast<int>(local)), 0.5);
    // The spokes meet in the centre: the first sub-face's.
    const std::uint32_t sub = t == 1.0 ? 0 : local;
    return {&m_geometry.patches()[m_geometry.first_patch(face) + sub], {1.0, t}};
}

SurfacePlace PatchBorders::vertex(std::size_t vertex) const {
    if (const SubdivisionTopology* topology = m_geometry.subdivision()) {
        const SubdivisionTopology::Owner& owner = topology->vertex_owner(vertex);
        return on_face(owner.face, owner.local, 0.0);
    }
    const std::uint32_t owner = m_vertex_owners[vertex];
    const BasePatch& patch = m_geometry.patches()[owner / 4];
    return {&patch, corner_uv(patch.kind, static_cast<int>(owner % 4))};
}

SurfacePlace PatchBorders::on_cage(std::size_t index, double t) const {
    const SubdivisionTopology& topology = *m_geometry.subdivision();
    const SubdivisionTopology::Edge& edge = topology.edge(index);
    if (t == 0.0 || t == 1.0) return vertex(static_cast<std::size_t>(t == 0.0 ? edge.lo : edge.hi));
    const std::uint32_t corner =
        m_geometry.first_corner(static_cast<std::size_t>(edge.owner.face)) +
        static_cast<std::uint32_t>(edge.owner.local);
    const bool turned = m_geometry.data().corner_verts[corner] != edge.lo;
    return on_face(edge.owner.face, edge.owner.local, turned ? 1.0 - t : t);
}

/// On the edge that leaves a corner of a face, as the face runs.
SurfacePlace PatchBorders::on_face(std::int32_t face, std::int32_t local, double t) const {
    const auto f = static_cast<std::size_t>(face);
    const BasePatch* const first = &m_geometry.patches()[m_geometry.first_patch(f)];
    if (first->kind == PatchKind::Quad)
        return {first, corner_uv(PatchKind::Quad, local) * (1.0 - t) +
                           corner_uv(PatchKind::Quad, (local + 1) % 4) * t};
    const std::int32_t n = m_geometry.data().face_sizes[f];
    if (t <= 0.5) return {first + local, {2.0 * t, 0.0}};
    return {first + (local + 1) % n, {0.0, 2.0 * (1.0 - t)}};
}

}  // namespace granita
