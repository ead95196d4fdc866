// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/patch_batch.h"

#include <algorithm>

#include "dice/grid_attributes.h"
#include "dice/lattice_offsets.h"
#include "dice/lattice_stencil.h"
#include "dice/motion_bounds.h"
#include "dice/patch.h"
#include "dice/raster_bound.h"
#include "geometry/patch_borders.h"

namespace granita {
namespace {

/// Where a lattice lies in the grid of separate micropolygons.
class Slot {
  public:
    Slot(const Grid& grid, int n_u, int n_v, std::size_t first_micropolygon)
        : m_all(static_cast<std::size_t>(grid.n_u)),
          m_n_u(static_cast<std::size_t>(n_u)),
          m_n_v(static_cast<std::size_t>(n_v)),
          m_first(first_micropolygon) {}

    /// to[vertex of the grid] = value(vertex of the lattice), corner by corner.
    template <class To, class Value>
    void spread(To* to, Value value) const {
        for (std::size_t corner = 0; corner < 4; ++corner)
            for (std::size_t j = 0; j < m_n_v; ++j) {
                const std::size_t from = (j + corner / 2) * (m_n_u + 1) + corner % 2;
                To* const row = to + corner * m_all + m_first + j * m_n_u;
                for (std::size_t i = 0; i < m_n_u; ++i) row[i] = value(from + i);
            }
    }
    /// A vertex of the grid for each of the lattice.
    void add_anchors(std::vector<std::uint32_t>& anchors) const {
        for (std::size_t j = 0; j <= m_n_v; ++j)
            for (std::size_t i = 0; i <= m_n_u; ++i) {
                const std::size_t m = std::min(j, m_n_v - 1) * m_n_u + std::min(i, m_n_u - 1);
                const std::size_t corner = (i == m_n_u ? 1 : 0) + (j == m_n_v ? 2 : 0);
                anchors.push_back(static_cast<std::uint32_t>(corner * m_all + m_first + m));
            }
    }

  private:
    std::size_t m_all, m_n_u, m_n_v, m_first;
};

/// of_lattice(lattice, slot) and of_piece(piece, slot) for all of them.
template <class Parts, class OfLattice, class OfPiece>
void for_each_part(const Grid& grid, const Parts& parts, OfLattice of_lattice, OfPiece of_piece) {
    std::size_t first = 0;
    for (const auto& lattice : parts.lattices) {
        const LatticeStencil& stencil = LatticeStencil::of(lattice.stencil);
        of_lattice(lattice, Slot(grid, stencil.n_u, stencil.n_v, first));
        first += static_cast<std::size_t>(stencil.micropolygon_count());
    }
    for (const auto& piece : parts.pieces) {
        of_piece(piece, Slot(grid, piece.grid->n_u, piece.grid->n_v, first));
        first += static_cast<std::size_t>(piece.grid->micropolygon_count());
    }
}

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
    to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

int PatchBatch::levels(std::uint32_t a, std::uint32_t b, const BasePatch& face) const {
    Vec3f start[kMaxKnots], end[kMaxKnots];
    const int knots = m_mesh->knot_count();
    for (int k = 0; k < knots; ++k) {
        const std::span<const Vec3f> points = m_mesh->points(k);
        start[k] = points[m_mesh->part().place(a)];
        end[k] = points[m_mesh->part().place(b)];
    }
    const int sure = m_mesh->rate().sure_levels(start, end, knots);
    if (sure != EdgeRate::kUnsure) return sure;
    PatchEdge side;
    side.edge = {std::min(a, b), std::max(a, b)};
    side.budget = kMostEdgeLevels;
    EdgeWalker(*m_mesh, face).classify(side);
    return side.levels;
}

/// False: the sides ask for more.
bool PatchBatch::find_stencil(const BasePatch& at, std::uint32_t& stencil) const {
    const int sides = at.kind == PatchKind::Triangle ? 3 : 4;
    const auto vertex = [&](int i) {
        return static_cast<std::uint32_t>(m_mesh->data().corner_verts[at.corner[i % sides]]);
    };
    int around[4];
    for (int i = 0; i < sides; ++i) {
        around[i] = levels(vertex(i), vertex(i + 1), at);
        if (around[i] < 0 || around[i] > LatticeStencil::kMostLevels) return false;
    }
    stencil = LatticeStencil::number(at.kind, around);
    return LatticeStencil::of(stencil).micropolygon_count() <=
           m_mesh->view().scene->options.grid_size;
}

/// Where a face should not dice in one piece after all, its pieces do.
void PatchBatch::dice_face(const BasePatch& patch, std::vector<Piece>& pieces) const {
    std::vector<std::unique_ptr<Primitive>> left;
    left.push_back(Patch::open(m_mesh, patch));
    while (!left.empty()) {
        const auto primitive = std::move(left.back());
        left.pop_back();
        if (!primitive->diceable()) {
            for (auto& child : primitive->split()) left.push_back(std::move(child));
        } else if (auto diced = primitive->dice()) {
            pieces.push_back({patch.face, std::move(diced)});
        }
    }
}

PatchBatch::Parts PatchBatch::find_parts() const {
    // Elsewhere Patch may find more than its sides do.
    bool in_frame = m_mesh->rate().in_frame(boxes());
    if (in_frame && m_mesh->displaced()) in_frame = m_mesh->rate().in_frame(still_boxes());
    Parts parts;
    parts.lattices.reserve(face_count());
    const auto add = [&](const BasePatch& part) {
        std::uint32_t stencil = 0;
        // Of what is curved none but whole faces are here, whose edges have been told so.
        if (!m_mesh->straight_edges() || (in_frame && find_stencil(part, stencil)))
            parts.lattices.push_back({part, stencil});
        else
            dice_face(part, parts.pieces);
    };
    for (std::size_t i = 0; i < face_count(); ++i) {
        if (patch(i).bent) {
            add(patch(i).half(0));
            add(patch(i).half(1));
        } else {
            add(patch(i));
        }
    }
    return parts;
}

std::unique_ptr<Grid> PatchBatch::dice() const {
    Parts parts = find_parts();
    int micropolygons = 0;
    for (const Lattice& lattice : parts.lattices)
        micropolygons += LatticeStencil::of(lattice.stencil).micropolygon_count();
    for (const Piece& piece : parts.pieces) micropolygons += piece.grid->micropolygon_count();
    if (micropolygons == 0) return nullptr;
    if (m_mesh->displaced()) find_offsets(parts);
    auto grid = make_grid(static_cast<std::size_t>(micropolygons));
    place(*grid, parts);
    // All have the light samples of a whole pixel: by the area of a batch, those of its larger
    // faces were too few, and what light grazes had specks.
    find_motion(*grid);
    grid->bounds = m_mesh->displaced() ? raster_bound(m_mesh->view().projection, grid->positions)
                                       : corner_bounds();
    count_spared(*grid, parts);
    grid->state_asks_displacement = m_mesh->displaced();
    grid->shading_state = [batch = *this, parts = std::move(parts)](Grid& of) {
        batch.fill_shading_state(of, parts);
    };
    return grid;
}

std::vector<Bounds3f> PatchBatch::still_boxes() const {
    std::vector<Bounds3f> boxes(static_cast<std::size_t>(m_mesh->knot_count()));
    for (std::size_t k = 0; k < boxes.size(); ++k)
        for (std::size_t i = 0; i < face_count(); ++i)
            for (const std::uint32_t corner : patch(i).corner)
                boxes[k].add(m_mesh->points(static_cast<int>(k))[m_mesh->place_of(corner)]);
    return boxes;
}

/// Who answers for a vertex of a lattice that is no corner: of what two corners tell, the edge's
/// owner.
SurfacePlace PatchBatch::owner_place(const BasePatch& patch, const LatticeStencil& stencil,
                                     std::size_t v) const {
    const int sides = patch.kind == PatchKind::Triangle ? 3 : 4;
    const auto vertex = [&](int i) {
        return static_cast<std::uint32_t>(m_mesh->data().corner_verts[patch.corner[i % sides]]);
    };
    const std::array<double, 4>& w = stencil.weights[v].w;
    for (int i = 0; i < sides; ++i) {
        const double before = w[static_cast<std::size_t>(i)];
        const double after = w[static_cast<std::size_t>((i + 1) % sides)];
        if (!(before > 0.0 && after > 0.0 && before + after == 1.0)) continue;
        const PatchBorders& borders = m_mesh->shared().borders();
        const std::uint32_t from = vertex(i), to = vertex(i + 1);
        return borders.place(borders.edge_of(std::min(from, to), std::max(from, to)),
                             from < to ? after : before);
    }
    return {&patch, stencil.uv[v]};
}

/// Those of corners are known.
void PatchBatch::find_offsets(Parts& parts) const {
    std::vector<Vec3f>& offsets = parts.offsets;
    std::vector<std::size_t> others;
    std::vector<SurfacePlace> places;
    for (const Lattice& lattice : parts.lattices) {
        const LatticeStencil& stencil = LatticeStencil::of(lattice.stencil);
        const std::array<Vec3f, 4> corners = m_mesh->corner_offsets(lattice.patch);
        for (std::size_t v = 0; v < stencil.vertex_count(); ++v) {
            const std::array<double, 4>& w = stencil.weights[v].w;
            const auto corner = static_cast<std::size_t>(std::ranges::find(w, 1.0) - w.begin());
            if (corner == w.size()) {
                others.push_back(offsets.size());
                places.push_back(owner_place(lattice.patch, stencil, v));
            }
            offsets.push_back(corner == w.size() ? Vec3f(0.0f) : corners[corner]);
        }
    }
    Offsets found;
    m_mesh->find_offsets(places, false, found);
    for (std::size_t i = 0; i < others.size(); ++i) offsets[others[i]] = found.offset[i];
}

/// With what changes of them by (u, v) of each lattice's own patch: between the corners of what is
/// one micropolygon.
Offsets PatchBatch::offsets_with_slopes(const Parts& parts) const {
    std::vector<LatticeOffsets::Lattice> wanted;
    for (const Lattice& lattice : parts.lattices) {
        const LatticeStencil& stencil = LatticeStencil::of(lattice.stencil);
        if (stencil.micropolygon_count() > 1) wanted.push_back({&lattice.patch, &stencil});
    }
    Offsets found;
    LatticeOffsets().find(*m_mesh, wanted, found);
    Offsets out;
    out.offset = parts.offsets;
    std::size_t next = 0;
    for (const Lattice& lattice : parts.lattices) {
        const LatticeStencil& stencil = LatticeStencil::of(lattice.stencil);
        const bool alone = stencil.micropolygon_count() == 1;
        const auto corners = m_mesh->corner_offsets(lattice.patch);
        for (const CornerWeights& weights : stencil.weights) {
            out.by_u.push_back(alone ? Vec3f(blend(corners, weights.du)) : found.by_u[next]);
            out.by_v.push_back(alone ? Vec3f(blend(corners, weights.dv)) : found.by_v[next]);
            if (!alone) ++next;
        }
    }
    return out;
}

void PatchBatch::place(Grid& grid, const Parts& parts) const {
    const auto count = static_cast<std::size_t>(grid.vertex_count());
    for (int k = 0; k < grid.knots; ++k) {
        Vec3f* const to = &grid.positions[static_cast<std::size_t>(k) * count];
        const Vec3f* offset = parts.offsets.data();
        const auto place_lattice = [&](const Lattice& lattice, const Slot& slot) {
            const LatticeStencil& stencil = LatticeStencil::of(lattice.stencil);
            const OpenedMesh::Corners corners = m_mesh->corners(lattice.patch, k);
            Vec3f at[LatticeStencil::kMostVertices];
            for (std::size_t v = 0; v < stencil.vertex_count(); ++v) {
                at[v] = Vec3f(blend(corners.p, stencil.weights[v].w));
                if (m_mesh->displaced()) at[v] = m_mesh->displaced(k, at[v], *offset++);
            }
            slot.spread(to, [&](std::size_t v) { return at[v]; });
        };
        const auto place_piece = [&](const Piece& piece, const Slot& slot) {
            // What stands still has one knot.
            const auto step = static_cast<std::size_t>(piece.grid->motion ? k : 0);
            const Vec3f* const at =
                &piece.grid->positions[step * static_cast<std::size_t>(piece.grid->vertex_count())];
            slot.spread(to, [&](std::size_t v) { return at[v]; });
        };
        for_each_part(grid, parts, place_lattice, place_piece);
    }
}

/// All vertices of a face lie between its corners, in the raster too, from each point of the lens.
RasterBounds PatchBatch::corner_bounds() const {
    std::vector<Vec3f> corners;
    corners.reserve(4 * face_count() * static_cast<std::size_t>(m_mesh->knot_count()));
    for (int k = 0; k < m_mesh->knot_count(); ++k) {
        const std::span<const Vec3f> points = m_mesh->points(k);
        for (std::size_t i = 0; i < face_count(); ++i)
            for (const std::uint32_t corner : patch(i).corner)
                corners.push_back(points[m_mesh->place_of(corner)]);
    }
    return raster_bound(m_mesh->view().projection, corners);
}

/// Of the lattices; pieces have counted themselves.
void PatchBatch::count_spared(const Grid& grid, const Parts& parts) const {
    Statistics* const statistics = m_mesh->view().statistics;
    if (!statistics || parts.lattices.empty()) return;
    std::size_t points = 0;
    for (const Lattice& lattice : parts.lattices)
        points += LatticeStencil::of(lattice.stencil).vertex_count();
    std::vector<Vec3f> path(static_cast<std::size_t>(grid.knots));
    const auto stride = static_cast<std::size_t>(grid.vertex_count());
    for (std::size_t k = 0; k < path.size(); ++k) path[k] = grid.positions[k * stride];
    const double spared = m_mesh->rate().spared(path.data(), grid.knots) - 1.0;
    statistics->add(Counter::PointsSpared,
                    static_cast<std::uint64_t>(spared * static_cast<double>(points)));
}

void PatchBatch::fill_shading_state(Grid& grid, const Parts& parts) const {
    std::size_t points = 0;
    for (const Lattice& lattice : parts.lattices)
        points += LatticeStencil::of(lattice.stencil).vertex_count();
    for (const Piece& piece : parts.pieces)
        points += static_cast<std::size_t>(piece.grid->vertex_count());
    for (auto* values : {&grid.p, &grid.normal, &grid.geometric_normal, &grid.dp_du, &grid.dp_dv})
        values->reserve(points);
    grid.terminator_offset = m_mesh->instance().terminator_offset;
    grid.rise.reserve(m_mesh->rises() ? points : 0);
    grid.knot_normals = m_mesh->knot_normals();
    grid.normal_corners.reserve(grid.knot_normals ? points : 0);
    ShadingPositions& places = grid.shading_positions;
    places.point_of.resize(static_cast<std::size_t>(grid.vertex_count()));
    for (auto* values : {&places.anchors, &places.faces}) values->reserve(points);

    const auto begin = [&](std::uint32_t face, const Slot& slot) {
        const auto first = static_cast<std::uint32_t>(places.anchors.size());
        slot.spread(places.point_of.data(),
                    [&](std::size_t v) { return first + static_cast<std::uint32_t>(v); });
        slot.add_anchors(places.anchors);
        places.faces.resize(places.anchors.size(), face);
    };
    const auto shade_piece = [&](const Piece& piece, const Slot& slot) {
        begin(piece.face, slot);
        append(piece.grid->normal, grid.normal);
        append(piece.grid->geometric_normal, grid.geometric_normal);
        append(piece.grid->rise, grid.rise);
        append(piece.grid->normal_corners, grid.normal_corners);
        append(piece.grid->dp_du, grid.dp_du);
        append(piece.grid->dp_dv, grid.dp_dv);
    };
    const Offsets offsets = m_mesh->displaced() ? offsets_with_slopes(parts) : Offsets{};
    std::size_t vertex = 0;
    const auto shade_lattice = [&](const Lattice& lattice, const Slot& slot) {
        begin(lattice.patch.face, slot);
        add_points(lattice, offsets, vertex, grid);
        vertex += LatticeStencil::of(lattice.stencil).vertex_count();
    };
    for_each_part(grid, parts, shade_lattice, shade_piece);
    set_point_positions(grid, m_mesh->knots());
    fill_attributes(grid, parts, offsets);
}

void PatchBatch::add_points(const Lattice& lattice, const Offsets& offsets, std::size_t first,
                            Grid& grid) const {
    const LatticeStencil& stencil = LatticeStencil::of(lattice.stencil);
    const FrameFace face = m_mesh->frame_face(lattice.patch);
    const bool has_rise = m_mesh->rises();
    for (std::size_t v = 0; v < stencil.vertex_count(); ++v) {
        const CornerWeights& weights = stencil.weights[v];
        TangentFrame at = face.frame(weights);
        if (m_mesh->displaced()) m_mesh->displace(at, offsets, first + v);
        grid.geometric_normal.emplace_back(at.geometric_normal);
        grid.normal.emplace_back(at.normal);
        if (has_rise) grid.rise.push_back(m_mesh->rise(face, weights, at.geometric_normal));
        if (grid.knot_normals)
            grid.normal_corners.push_back(m_mesh->normal_corners(lattice.patch, weights));
        const Vec2d &by_u = stencil.step_u[v], &by_v = stencil.step_v[v];
        grid.dp_du.emplace_back(at.su * by_u.x + at.sv * by_u.y);
        grid.dp_dv.emplace_back(at.su * by_v.x + at.sv * by_v.y);
    }
}

void PatchBatch::fill_attributes(Grid& grid, const Parts& parts, const Offsets& offsets) const {
    std::vector<float> values, du, dv;
    const auto fill = [&](const AttributeRequest& request, GridAttribute& out) {
        std::size_t vertex = 0;
        for (const Lattice& lattice : parts.lattices) {
            const LatticeStencil& stencil = LatticeStencil::of(lattice.stencil);
            m_mesh->attribute(lattice.patch, request, stencil.uv, values, du, dv);
            m_mesh->displace(request, offsets, vertex, values, du, dv);
            vertex += stencil.vertex_count();
            append(values, out.values);
            for (std::size_t i = 0; request.derivatives && i < values.size(); ++i) {
                const std::size_t v = i / static_cast<std::size_t>(out.width);
                const Vec2d &by_u = stencil.step_u[v], &by_v = stencil.step_v[v];
                out.du.push_back(static_cast<float>(du[i] * by_u.x + dv[i] * by_u.y));
                out.dv.push_back(static_cast<float>(du[i] * by_v.x + dv[i] * by_v.y));
            }
        }
        for (const Piece& piece : parts.pieces) {
            const GridAttribute& from =
                piece.grid->attributes[static_cast<std::size_t>(out.attribute)];
            append(from.values, out.values);
            append(from.du, out.du);
            append(from.dv, out.dv);
        }
    };
    make_attributes(grid, m_mesh->view().requests_of(grid.material), fill);
}

}  // namespace granita
