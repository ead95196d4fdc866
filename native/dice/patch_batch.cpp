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
    explicit Joiner(Grid& grid) : m_grid(grid) {
        grid.places.point_of.resize(static_cast<std::size_t>(grid.vertex_count()));
    }

    void add(const Grid& part, std::uint32_t face) {
        for (int m = 0; m < part.micropolygon_count(); ++m) {
            const Grid::Corners c = part.corners(m);
            const int corner[4] = {c.v0, c.v1, c.v3, c.v2};  // as planes are ordered
            for (int plane = 0; plane < 4; ++plane) {
                const int vertex = plane * m_grid.n_u + m_micropolygons + m;
                put_vertex(part, corner[plane], vertex);
            }
        }
        for (int j = 0; j <= part.n_v; ++j)
            for (int i = 0; i <= part.n_u; ++i) {
                const int m = std::min(j, part.n_v - 1) * part.n_u + std::min(i, part.n_u - 1);
                const int plane = (i == part.n_u ? 1 : 0) + (j == part.n_v ? 2 : 0);
                m_grid.places.anchors.push_back(
                    static_cast<std::uint32_t>(plane * m_grid.n_u + m_micropolygons + m));
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
        m_micropolygons += part.micropolygon_count();
        m_points += part.vertex_count();
    }

  private:
    /// A part that stands still has one knot.
    void put_vertex(const Grid& part, int from, int to) {
        for (int k = 0; k < m_grid.knots; ++k)
            m_grid.positions[static_cast<std::size_t>(k * m_grid.vertex_count() + to)] =
                part.positions[static_cast<std::size_t>(
                    (part.motion ? k * part.vertex_count() : 0) + from)];
        m_grid.places.point_of[static_cast<std::size_t>(to)] =
            static_cast<std::uint32_t>(m_points + from);
    }

    template <class T>
    static void append(const std::vector<T>& from, std::vector<T>& to) {
        to.insert(to.end(), from.begin(), from.end());
    }

    Grid& m_grid;
    int m_micropolygons = 0, m_points = 0;  ///< so far
};

}  // namespace

/// A face as a lattice, by its sides alone, or a piece of it as Patch diced it.
struct PatchBatch::Part {
    std::size_t face = 0;
    OpenedMesh::Start start;
    int n_u = 0, n_v = 0;
    std::unique_ptr<Grid> diced;
    int micropolygons() const { return diced ? diced->micropolygon_count() : n_u * n_v; }
};

/// Where this is all that Patch would find.  `inside`: in the frame, at every knot.
bool PatchBatch::is_lattice(Part& part, bool inside) const {
    const BasePatch& face = patch(part.face);
    if (!inside || !face.whole_face) return false;
    part.start = m_mesh->start(face, kMostEdgeLevels);
    const Side* const sides = part.start.sides;
    if (std::any_of(sides, sides + 4, [](const Side& s) { return s.levels < 0; })) return false;
    const int u = std::max(sides[0].levels, sides[2].levels);
    const int v = std::max(sides[1].levels, sides[3].levels);
    part.n_u = 1 << u;
    part.n_v = 1 << v;
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
    std::size_t micropolygons = 0;
    for (std::size_t i = 0; i < face_count(); ++i) {
        parts.emplace_back().face = i;
        if (is_lattice(parts.back(), inside)) continue;
        parts.pop_back();
        dice_face(i, parts);
    }
    for (const Part& part : parts) micropolygons += static_cast<std::size_t>(part.micropolygons());
    if (micropolygons == 0) return nullptr;
    auto grid = make_grid(micropolygons);
    Joiner joiner(*grid);
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
