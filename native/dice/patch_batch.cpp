// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/patch_batch.h"

#include <algorithm>

#include "dice/finish_motion.h"
#include "dice/lattice.h"
#include "dice/patch.h"

namespace granita {
namespace {

/// Puts lattices one after the other into a grid of separate micropolygons.
class Joiner {
  public:
    /// `points`: of all lattices.
    Joiner(Grid& grid, std::size_t points) : m_grid(grid) {
        grid.places.point_of.resize(static_cast<std::size_t>(grid.vertex_count()));
        grid.places.anchors.reserve(points);
        for (auto* values :
             {&grid.p, &grid.normal, &grid.geometric_normal, &grid.dp_du, &grid.dp_dv})
            values->reserve(points);
    }

    void add(const Grid& part, std::uint32_t face) {
        const std::size_t n_u = size(part.n_u), n_v = size(part.n_v);
        for (std::size_t plane = 0; plane < 4; ++plane)
            for (std::size_t j = 0; j < n_v; ++j) put_row(part, plane, j);
        for (std::size_t j = 0; j <= n_v; ++j)
            for (std::size_t i = 0; i <= n_u; ++i) {
                const std::size_t m = std::min(j, n_v - 1) * n_u + std::min(i, n_u - 1);
                const std::size_t plane = (i == n_u ? 1 : 0) + (j == n_v ? 2 : 0);
                m_grid.places.anchors.push_back(
                    static_cast<std::uint32_t>(plane * size(m_grid.n_u) + m_micropolygons + m));
            }
        const std::vector<Vec3f>& p = part.shading_p();
        m_grid.p.insert(m_grid.p.end(), p.begin(), p.begin() + part.vertex_count());
        append(part.normal, m_grid.normal);
        append(part.geometric_normal, m_grid.geometric_normal);
        append(part.dp_du, m_grid.dp_du);
        append(part.dp_dv, m_grid.dp_dv);
        m_grid.attributes.resize(part.attributes.size());
        for (std::size_t a = 0; a < part.attributes.size(); ++a) {
            const GridAttribute& from = part.attributes[a];
            GridAttribute& to = m_grid.attributes[a];
            to.attribute = from.attribute;
            to.width = from.width;
            append(from.values, to.values);
            append(from.du, to.du);
            append(from.dv, to.dv);
        }
        m_grid.places.faces.resize(m_grid.p.size(), face);
        m_micropolygons += n_u * n_v;
        m_points += size(part.vertex_count());
    }

  private:
    /// One corner of the micropolygons of a row.  A part that stands still has one knot.
    void put_row(const Grid& part, std::size_t plane, std::size_t j) {
        const std::size_t count = size(part.n_u), all = size(m_grid.vertex_count());
        const std::size_t from = (j + plane / 2) * (count + 1) + plane % 2;
        const std::size_t to = plane * size(m_grid.n_u) + m_micropolygons + j * count;
        const std::size_t step = part.motion ? size(part.vertex_count()) : 0;
        for (std::size_t k = 0; k < size(m_grid.knots); ++k)
            std::copy_n(&part.positions[k * step + from], count, &m_grid.positions[k * all + to]);
        for (std::size_t i = 0; i < count; ++i)
            m_grid.places.point_of[to + i] = static_cast<std::uint32_t>(m_points + from + i);
    }

    static std::size_t size(int count) { return static_cast<std::size_t>(count); }

    template <class T>
    static void append(const std::vector<T>& from, std::vector<T>& to) {
        to.insert(to.end(), from.begin(), from.end());
    }

    Grid& m_grid;
    std::size_t m_micropolygons = 0, m_points = 0;  ///< so far
};

}  // namespace

/// A face as a lattice, by its sides alone, or a piece of it as Patch diced it.
struct PatchBatch::Part {
    std::size_t face = 0;
    OpenedMesh::Start start;
    int n_u = 0, n_v = 0;
    std::unique_ptr<Grid> diced;
    int points() const { return diced ? diced->vertex_count() : (n_u + 1) * (n_v + 1); }
    int micropolygons() const { return diced ? diced->micropolygon_count() : n_u * n_v; }
};

/// Where this is all that Patch would find.  `inside`: in the frame, at every knot.
bool PatchBatch::is_lattice(Part& part, bool inside) const {
    const BasePatch& face = patch(part.face);
    if (!inside || !face.whole_face) return false;
    part.start = m_mesh->start(face, kMostEdgeLevels);
    const Side* const sides = part.start.sides;
    if (std::any_of(sides, sides + 4, [](const Side& s) { return s.levels < 0; })) return false;
    part.n_u = 1 << std::max(sides[0].levels, sides[2].levels);
    part.n_v = 1 << std::max(sides[1].levels, sides[3].levels);
    return part.n_u * part.n_v <= m_mesh->view().scene->options.grid_size;
}

/// Where a face should not dice in one piece after all, its pieces do.
void PatchBatch::dice_face(std::size_t face, std::vector<Part>& parts) const {
    std::vector<std::unique_ptr<Primitive>> left;
    left.push_back(Patch::open(m_mesh, patch(face)));
    while (!left.empty()) {
        const auto primitive = std::move(left.back());
        left.pop_back();
        if (!primitive->diceable()) {
            for (auto& child : primitive->split()) left.push_back(std::move(child));
        } else if (auto diced = primitive->dice()) {
            parts.emplace_back().face = face;
            parts.back().diced = std::move(diced);
        }
    }
}

std::unique_ptr<Grid> PatchBatch::dice() const {
    const bool inside = m_mesh->rate().inside(bounds());
    std::vector<Part> parts;
    parts.reserve(face_count());
    std::size_t micropolygons = 0, points = 0;
    for (std::size_t i = 0; i < face_count(); ++i) {
        parts.emplace_back().face = i;
        if (is_lattice(parts.back(), inside)) continue;
        parts.pop_back();
        dice_face(i, parts);
    }
    for (const Part& part : parts) {
        micropolygons += static_cast<std::size_t>(part.micropolygons());
        points += static_cast<std::size_t>(part.points());
    }
    if (micropolygons == 0) return nullptr;
    auto grid = make_grid(micropolygons);
    Joiner joiner(*grid, points);
    static thread_local Grid lattice;  // kept for its memory
    for (const Part& part : parts) {
        if (!part.diced) {
            lattice.material = grid->material;
            lattice.lifespan = grid->lifespan;
            dice_lattice(*m_mesh, patch(part.face),
                         {part.start.corner_uv, part.start.sides, part.n_u, part.n_v}, lattice);
        }
        joiner.add(part.diced ? *part.diced : lattice, patch(part.face).face);
    }
    // All have the light samples of a whole pixel: by the area of a batch, those of its larger
    // faces were too few, and what light grazes had specks.
    finish_motion(*grid, m_mesh->view().projection);
    return grid;
}

}  // namespace granita
