// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_subdivision.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "geometry/limit_face.h"
#include "geometry/limit_vertices.h"
#include "geometry/subdivision_topology.h"
#include "geometry/surface_frames.h"
#include "shade/rays/patch_cells.h"

namespace granita {
namespace {

/// Of a pixel: how far quads may lie off the surface.  It is about as much of a contact shadow that
/// is lost.
constexpr float kPart = 0.25f;
/// Of a face's diagonal: however far away a face is, its quads turn by no more than 6 degrees (an
/// arc's height over its chord is an eighth of the angle), or its shadow shows them.
constexpr float kBend = 0.0125f;
/// log2 of the cells along an edge: of a face that is seen, and for its shadow's sake alone.
constexpr int kMostLevels = 6, kMostBendLevels = 3;
/// Points over all knots that a geometry may have: some gigabytes in Embree.
constexpr std::size_t kMostPoints = 40'000'000;
/// Faces that a thread takes at a time.
constexpr std::size_t kGrain = 256;

int levels_for(float height, float most) {
    int levels = 0;
    while (height > most && levels < kMostLevels) height *= 0.25f, ++levels;
    return levels;
}

}  // namespace

RaySubdivision::RaySubdivision(std::shared_ptr<const SharedGeometry> shared,
                               const RayDetail& detail, const Progress& progress)
    : RayFaces(std::move(shared)) {
    find_levels(detail);
    find_edge_levels();
    number_points();
    const auto& patches = m_shared->patches();
    // Points of the finer faces are read by the coarser: all of them first.
    std::vector<float> errors(patches.size());
    parallel_patches(progress, [&](std::size_t k) { errors[k] = place(k); });
    std::vector<float> extents(patches.size());
    parallel_patches(progress, [&](std::size_t k) { extents[k] = connect(k); });
    m_errors.assign(m_shared->data().face_count(), 0.0f);
    for (std::size_t k = 0; k < patches.size(); ++k) {
        const std::uint32_t face = patches[k].face;
        m_errors[face] = std::max(m_errors[face], errors[k]);
        m_extents[face] = std::max(m_extents[face], extents[k]);
    }
    m_primitives.put_still_first();
}

template <class Act>
void RaySubdivision::parallel_patches(const Progress& progress, Act act) const {
    parallel_for(m_shared->patches().size(), kGrain, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t k = begin; k != end; ++k) act(k);
    });
}

/// Faces far away first need what their shadow shows, then what the camera sees.
void RaySubdivision::find_levels(const RayDetail& detail) {
    const GeometryData& data = m_shared->data();
    const std::vector<float>& heights = m_shared->limit()->heights;
    const std::span<const Vec3f> points =
        m_shared->surface_points(static_cast<int>(m_shared->frame().knot));
    m_levels.assign(data.face_count(), 0);
    parallel_for(data.face_count(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t face = begin; face != end; ++face) {
            Bounds3f box;
            float pixel = std::numeric_limits<float>::infinity();
            for (int i = 0; i < data.face_sizes[face]; ++i) {
                const Vec3f& p = points[static_cast<std::size_t>(
                    data.corner_verts[m_shared->first_corner(face) +
                                      static_cast<std::uint32_t>(i)])];
                box.add(p);
                pixel = std::min(pixel, detail.pixel(p));
            }
            pixel = std::min(pixel, detail.pixel(0.5f * (box.lo + box.hi)));
            const float size = glm::distance(box.lo, box.hi);
            const int bend = std::min(levels_for(heights[face], kBend * size), kMostBendLevels);
            const int seen = levels_for(heights[face], kPart * pixel);
            // Sub-faces meet in the middle of edges.
            m_levels[face] =
                static_cast<std::uint8_t>(std::max({bend, seen, is_quad(face) ? 0 : 1}));
        }
    });
}

void RaySubdivision::find_edge_levels() {
    const SubdivisionTopology& topology = *m_shared->subdivision();
    const GeometryData& data = m_shared->data();
    const auto edges_of = [&](std::size_t face, auto visit) {
        for (int i = 0; i < data.face_sizes[face]; ++i) visit(topology.face_edge(face, i));
    };
    // A sub-face's corner in the middle of an edge is one of its neighbour's too.
    for (std::size_t face = 0; face < m_levels.size(); ++face)
        edges_of(face, [&](std::size_t edge) {
            if (topology.edge(edge).halved)
                m_levels[face] = std::max<std::uint8_t>(m_levels[face], 1);
        });
    std::size_t points = 0;
    const auto count = [&] {
        points = 0;
        for (const BasePatch& patch : m_shared->patches())
            points += std::size_t{1} << 2 * patch_level(patch);
        return points * static_cast<std::size_t>(m_primitives.knots);
    };
    while (count() > kMostPoints && std::ranges::any_of(m_levels, [](int l) { return l > 1; })) {
        m_coarsened = true;
        for (std::uint8_t& level : m_levels) level -= level > 1 ? 1 : 0;
    }
    if (std::ranges::all_of(m_levels, [](int level) { return level == 0; })) return;
    m_edge_levels.assign(topology.edge_count(), kMostLevels + 1);
    for (std::size_t face = 0; face < m_levels.size(); ++face)
        edges_of(face, [&](std::size_t edge) {
            m_edge_levels[edge] = std::min(m_edge_levels[edge], m_levels[face]);
        });
}

int RaySubdivision::patch_level(const BasePatch& patch) const {
    return m_levels[patch.face] - (patch.kind == PatchKind::SubFace ? 1 : 0);
}

bool RaySubdivision::is_one_quad(const BasePatch& patch) const {
    return patch.kind == PatchKind::Quad && m_levels[patch.face] == 0;
}

RaySubdivision::PatchSide RaySubdivision::side(const BasePatch& patch, int number) const {
    PatchSide side;
    const int level = m_levels[patch.face], whole = 1 << level;
    std::uint32_t local = static_cast<std::uint32_t>(number);
    if (patch.kind == PatchKind::Quad) {
        side.sign = number < 2 ? 1 : -1;
        side.first = number < 2 ? 0 : whole;
    } else {
        if (number == 1 || number == 2) return side;  // between sub-faces
        const auto n = static_cast<std::uint32_t>(m_shared->data().face_sizes[patch.face]);
        local = number == 0 ? patch.sub : (patch.sub + n - 1) % n;
        side.sign = number == 0 ? 1 : -1;
        side.first = number == 0 ? 0 : whole;
    }
    const SubdivisionTopology& topology = *m_shared->subdivision();
    side.index = topology.face_edge(patch.face, static_cast<int>(local));
    side.edge = &topology.edge(side.index);
    side.owned = side.edge->owner.face == static_cast<std::int32_t>(patch.face) &&
                 side.edge->owner.local == static_cast<std::int32_t>(local);
    side.step = 1 << (level - m_edge_levels[side.index]);
    const std::uint32_t from = m_shared->first_corner(patch.face) + local;
    if (m_shared->data().corner_verts[from] != side.edge->lo) {
        side.first = whole - side.first;
        side.sign = -side.sign;
    }
    side.whole = whole;
    return side;
}

/// Vertices of the cage come first, then points of edges, from the lower vertex to the higher, then
/// those of patches: inside, and of a sub-face those of its right side.
void RaySubdivision::number_points() {
    const auto& patches = m_shared->patches();
    const bool all_one = m_edge_levels.empty();
    std::uint32_t quads = 0;
    auto points = static_cast<std::uint32_t>(m_shared->data().vertex_count());
    for (const std::uint8_t level : m_edge_levels) {
        m_first_edge_point.push_back(points);
        if (level <= kMostLevels) points += (1u << level) - 1;
    }
    for (const BasePatch& patch : patches) {
        const auto cells = 1u << patch_level(patch);
        if (!all_one) {
            m_first_quad.push_back(quads);
            m_first_point.push_back(points);
        }
        quads += cells * cells;
        points += patch.kind == PatchKind::SubFace ? cells * cells : (cells - 1) * (cells - 1);
    }
    if (!all_one) m_first_quad.push_back(quads);
    m_primitives.indices.resize(quads);
    m_primitives.points.resize(static_cast<std::size_t>(m_primitives.knots) * points);
    for (int knot = 0; knot < m_primitives.knots; ++knot)
        std::ranges::copy(m_shared->surface_points(knot),
                          m_primitives.points.begin() + static_cast<std::ptrdiff_t>(knot) * points);
}

std::uint32_t RaySubdivision::edge_point(const PatchSide& side, int i) const {
    // The nearest that the edge has.
    const int at = (side.first + side.sign * i + side.step / 2) / side.step;
    const int last = side.whole / side.step;
    if (at == 0) return static_cast<std::uint32_t>(side.edge->lo);
    if (at == last) return static_cast<std::uint32_t>(side.edge->hi);
    return m_first_edge_point[side.index] + static_cast<std::uint32_t>(at - 1);
}

/// Of a patch's own, at (i, j) with i in [1, cells) or, of a sub-face, [1, cells], and j likewise.
std::uint32_t RaySubdivision::own_point(std::size_t k, int i, int j) const {
    const BasePatch& patch = m_shared->patches()[k];
    const int cells = 1 << patch_level(patch);
    const int row = patch.kind == PatchKind::SubFace ? cells : cells - 1;
    return m_first_point[k] + static_cast<std::uint32_t>((j - 1) * row + i - 1);
}

/// Points (i, j) of a patch's cells.
std::uint32_t RaySubdivision::point(std::size_t k, const PatchSide* sides, int i, int j) const {
    const BasePatch& patch = m_shared->patches()[k];
    const int cells = 1 << patch_level(patch);
    if (j == 0) return edge_point(sides[0], i);
    if (i == 0) return edge_point(sides[3], j);
    if (patch.kind == PatchKind::Quad) {
        if (i == cells) return edge_point(sides[1], j);
        if (j == cells) return edge_point(sides[2], i);
        return own_point(k, i, j);
    }
    if (i == cells && j == cells) return own_point(k - patch.sub, i, j);  // the face's centre
    if (j < cells) return own_point(k, i, j);
    // The right side of the sub-face before.
    const auto n = static_cast<std::size_t>(m_shared->data().face_sizes[patch.face]);
    return own_point(patch.sub == 0 ? k + n - 1 : k - 1, cells, i);
}

/// Evaluates a patch at the points of its cells; keeps its own and those of edges that it owns.
/// Returns the largest distance between the surface and its quads.
float RaySubdivision::place(std::size_t k) {
    const BasePatch& patch = m_shared->patches()[k];
    if (is_one_quad(patch)) return m_shared->limit()->heights[patch.face];
    const int cells = 1 << patch_level(patch);
    PatchSide sides[4];
    for (int s = 0; s < 4; ++s) sides[s] = side(patch, s);
    const auto line = static_cast<std::size_t>(cells) + 1;
    static thread_local std::vector<Vec3f> evaluated;  // [knots][points]
    static thread_local std::vector<Vec2d> uv;
    uv.clear();
    for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) uv.push_back(Vec2d(i, j) / static_cast<double>(cells));
    find_positions(*m_shared, patch, uv, evaluated);
    float error = 0.0f;
    for (int knot = 0; knot < m_primitives.knots; ++knot) {
        const PatchCells at(&evaluated[static_cast<std::size_t>(knot) * line * line], cells);
        Vec3f* const points =
            &m_primitives.points[static_cast<std::size_t>(knot) * m_primitives.point_count()];
        float off = 0.0f;
        for (int s = 0; s < 4; ++s)
            if (sides[s].edge) off = std::max(off, at.error_of_side(s, sides[s].step));
        // One cell of a sub-face tells nothing of its bend; it is half as wide as the face.
        const float bent = cells == 1 ? 0.25f * m_shared->limit()->heights[patch.face] : 0.0f;
        error = std::max(error, at.error() + off + bent);
        const auto keep = [&](const PatchSide& side, int i, const Vec3f& p) {
            const int along = side.first + side.sign * i;
            const bool is_end = along == 0 || along == side.whole;
            if (side.owned && !is_end && along % side.step == 0) points[edge_point(side, i)] = p;
        };
        for (int i = 0; i <= cells; ++i) {
            keep(sides[0], i, at.at(i, 0));
            keep(sides[3], i, at.at(0, i));
            if (patch.kind != PatchKind::Quad) continue;
            keep(sides[1], i, at.at(cells, i));
            keep(sides[2], i, at.at(i, cells));
        }
        const int last = patch.kind == PatchKind::SubFace ? cells : cells - 1;
        for (int j = 1; j <= last; ++j)
            for (int i = 1; i <= last; ++i) points[own_point(k, i, j)] = at.at(i, j);
    }
    return error;
}

/// Makes a patch's quads; returns the largest coordinate of their points.
float RaySubdivision::connect(std::size_t k) {
    const BasePatch& patch = m_shared->patches()[k];
    auto* quads = &m_primitives.indices[m_first_quad.empty() ? k : m_first_quad[k]];
    const auto* const first = quads;
    if (is_one_quad(patch)) {
        std::uint32_t corner[4];
        for (std::size_t i = 0; i < 4; ++i)
            corner[i] = static_cast<std::uint32_t>(m_shared->data().corner_verts[patch.corner[i]]);
        *quads++ = {corner[1], corner[2], corner[3], corner[0]};
    } else {
        const int cells = 1 << patch_level(patch);
        PatchSide sides[4];
        for (int s = 0; s < 4; ++s) sides[s] = side(patch, s);
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i)
                *quads++ = {point(k, sides, i + 1, j), point(k, sides, i + 1, j + 1),
                            point(k, sides, i, j + 1), point(k, sides, i, j)};
    }
    float extent = 0.0f;
    for (const auto* quad = first; quad != quads; ++quad)
        for (int knot = 0; knot < m_primitives.knots; ++knot)
            for (const std::uint32_t v : *quad)
                extent = std::max(extent, largest_coordinate(m_primitives.at(knot)[v]));
    return extent;
}

/// `out` [knots][(cells + 1)^2]: the limit.
std::string RaySubdivision::size() const {
    return std::to_string(m_primitives.indices.size()) + " quads";
}

float RaySubdivision::error(std::uint32_t face) const {
    return face < m_errors.size() ? m_errors[face] : 0.0f;
}

void RaySubdivision::locate(std::uint32_t geometry, std::uint32_t quad, float u, float v,
                            RayHit& hit) const {
    quad = m_primitives.original(geometry, quad);
    std::size_t k = quad;
    std::uint32_t cell = 0;
    if (!m_first_quad.empty()) {
        const auto after = std::upper_bound(m_first_quad.begin(), m_first_quad.end(), quad);
        k = static_cast<std::size_t>(after - m_first_quad.begin()) - 1;
        cell = quad - m_first_quad[k];
    }
    locate_on(k, hit);
    // Embree's corners are the cell's second, third, fourth and first.
    const std::uint32_t side = 1u << patch_level(*hit.patch);
    hit.uv = (Vec2d(cell % side, cell / side) + Vec2d(1.0 - v, u)) / static_cast<double>(side);
}

std::size_t RaySubdivision::bytes() const {
    return sizeof(*this) + bytes_of_faces() + m_levels.size() + m_edge_levels.size() +
           4 * (m_first_quad.size() + m_first_point.size() + m_errors.size());
}

}  // namespace granita
