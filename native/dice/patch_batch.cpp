// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/patch_batch.h"

#include <algorithm>

#include "dice/finish_motion.h"
#include "dice/patch.h"
#include "dice/seen_area.h"

namespace granita {
namespace {

/// Puts lattices one after the other into a grid of separate micropolygons.
class Joiner {
  public:
    explicit Joiner(Grid& grid) : m_grid(grid) {
        grid.places.point_of.resize(static_cast<std::size_t>(grid.vertex_count()));
    }

    void add(const Grid& part) {
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

/// Where a face should not dice in one piece after all, its pieces do.
std::vector<std::unique_ptr<Grid>> PatchBatch::dice_faces() const {
    std::vector<std::unique_ptr<Grid>> parts;
    std::vector<std::unique_ptr<Primitive>> left;
    for (std::size_t i = 0; i < face_count(); ++i) {
        left.push_back(Patch::open(m_mesh, patch(i)));
        while (!left.empty()) {
            const auto primitive = std::move(left.back());
            left.pop_back();
            if (!primitive->diceable()) {
                for (auto& child : primitive->split()) left.push_back(std::move(child));
            } else if (auto part = primitive->dice()) {
                parts.push_back(std::move(part));
            }
        }
    }
    return parts;
}

std::unique_ptr<Grid> PatchBatch::dice() const {
    const std::vector<std::unique_ptr<Grid>> parts = dice_faces();
    std::size_t micropolygons = 0;
    for (const auto& part : parts)
        micropolygons += static_cast<std::size_t>(part->micropolygon_count());
    if (micropolygons == 0) return nullptr;
    const Projection& projection = m_mesh->view().projection;
    auto grid = make_grid(micropolygons);
    Joiner joiner(*grid);
    double area = 0.0;
    for (const auto& part : parts) {
        joiner.add(*part);
        area += seen_area(*part, part->shading_p(), projection);
    }
    finish_motion(*grid, projection);
    set_share(*grid, area);
    return grid;
}

}  // namespace granita
