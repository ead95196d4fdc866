// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/lattice.h"

#include <algorithm>

#include "dice/grid_attributes.h"
#include "dice/lattice_offsets.h"
#include "dice/motion_bounds.h"
#include "dice/parametric_positions.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

class LatticeDicer {
  public:
    void dice(const OpenedMesh& mesh, const BasePatch& patch, const Lattice& lattice, Grid& grid) {
        m_mesh = &mesh;
        m_patch = &patch;
        m_lattice = lattice;
        m_count =
            static_cast<std::size_t>(lattice.n_u + 1) * static_cast<std::size_t>(lattice.n_v + 1);
        find_places();
        mesh.sample(patch, m_places.uv, m_samples);
        m_border.assign(mesh.displaced() ? m_count : 0, {});
        place_border();
        grid.n_u = lattice.n_u;
        grid.n_v = lattice.n_v;
        grid.knots = mesh.knot_count();
        std::swap(grid.positions, m_samples.positions);
        if (mesh.displaced()) displace(grid);
        find_motion(grid);
        grid.p.clear();
        set_frame_positions(grid, mesh.knots());
        std::swap(grid.normal, m_samples.normal);
        std::swap(grid.geometric_normal, m_samples.geometric_normal);
        std::swap(grid.rise, m_samples.rise);
        grid.terminator_offset = mesh.instance().terminator_offset;
        count_spared(grid);
        find_knot_normals(grid);
        find_derivatives(grid);
        find_attributes(grid);
    }

  private:
    void find_places() {
        const EdgeWalker walk(*m_mesh, *m_patch);
        for (int side = 0; side < 4; ++side) {
            m_ends[side].clear();
            if (m_lattice.sides[side].collapsed) continue;
            m_ends[side].push_back(0);
            walk.leaf_ends(m_lattice.sides[side], 0, side % 2 == 0 ? m_lattice.n_u : m_lattice.n_v,
                           m_ends[side]);
        }
        m_places.find(m_lattice.corner_uv, m_lattice.n_u, m_lattice.n_v, m_ends);
    }

    /// Every point from the edge that owns it.
    void place_border() {
        const EdgeWalker walk(*m_mesh, *m_patch);
        EdgePoint point;
        for (int side = 0; side < 4; ++side) {
            if (m_lattice.sides[side].collapsed) continue;
            const int steps = m_places.side_steps(side);
            int evaluated = -1;  // step whose point the last vertex got
            for (int i = 0; i <= steps; ++i) {
                const int at = m_places.snapped[side][static_cast<std::size_t>(i)];
                if (at == evaluated) {
                    copy(m_places.vertex(side, i - 1), m_places.vertex(side, i));
                    continue;
                }
                evaluated = at;
                walk.point(m_lattice.sides[side], static_cast<double>(at) / steps, point);
                place(point, m_places.vertex(side, i));
            }
        }
        for (int side = 0; side < 4; ++side)
            if (m_lattice.sides[side].collapsed)
                for (int i = 1; i < m_places.side_steps(side); ++i)
                    copy(m_places.vertex(side, 0), m_places.vertex(side, i));
    }

    void place(const EdgePoint& point, int vertex) {
        for (int k = 0; k < m_mesh->knot_count(); ++k)
            m_samples.positions[at_knot(k, vertex)] = point.p[k];
        if (m_mesh->displaced()) m_border[static_cast<std::size_t>(vertex)] = point.place;
    }

    void copy(int from, int to) {
        for (int k = 0; k < m_mesh->knot_count(); ++k)
            m_samples.positions[at_knot(k, to)] = m_samples.positions[at_knot(k, from)];
        if (m_mesh->displaced())
            m_border[static_cast<std::size_t>(to)] = m_border[static_cast<std::size_t>(from)];
    }

    std::size_t at_knot(int knot, int vertex) const {
        return static_cast<std::size_t>(knot) * m_count + static_cast<std::size_t>(vertex);
    }

    void displace(Grid& grid) {
        const LatticeOffsets::Lattice whole{m_patch, &m_places};
        m_inside.find(*m_mesh, {&whole, 1}, m_offsets);
        find_displaced_frames();
        displace_border();
        for (int k = 0; k < grid.knots; ++k)
            for (std::size_t i = 0; i < m_count; ++i) {
                Vec3f& p = grid.positions[at_knot(k, static_cast<int>(i))];
                p = m_mesh->displaced(k, p, m_offsets.offset[i]);
            }
    }

    void find_displaced_frames() {
        for (std::size_t i = 0; i < m_count; ++i) {
            TangentFrame at{Vec3d(m_samples.su[i]), Vec3d(m_samples.sv[i]),
                            Vec3d(m_samples.normal[i]), Vec3d(m_samples.geometric_normal[i])};
            m_mesh->displace(at, m_offsets, i);
            m_samples.su[i] = Vec3f(at.su);
            m_samples.sv[i] = Vec3f(at.sv);
            m_samples.geometric_normal[i] = Vec3f(at.geometric_normal);
            m_samples.normal[i] = Vec3f(at.normal);
        }
    }

    /// Every vertex of the border goes where its owner says.
    void displace_border() {
        m_border_vertices.clear();
        m_sites.clear();
        for (int side = 0; side < 4; ++side)
            for (int i = 0; i <= m_places.side_steps(side); ++i) {
                const int vertex = m_places.vertex(side, i);
                const SurfacePlace& owner = m_border[static_cast<std::size_t>(vertex)];
                m_border_vertices.push_back(vertex);
                m_sites.push_back({owner.patch ? owner.patch : m_patch, owner.uv});
            }
        m_mesh->find_offsets(m_sites, false, m_border_offsets);
        for (std::size_t i = 0; i < m_border_vertices.size(); ++i)
            m_offsets.offset[static_cast<std::size_t>(m_border_vertices[i])] =
                m_border_offsets.offset[i];
    }

    void count_spared(const Grid& grid) {
        Statistics* const statistics = m_mesh->view().statistics;
        if (!statistics) return;
        m_path.clear();
        for (int k = 0; k < grid.knots; ++k)
            m_path.push_back(grid.positions[at_knot(k, static_cast<int>(m_count / 2))]);
        const double spared = m_mesh->rate().spared(m_path.data(), grid.knots) - 1.0;
        statistics->add(Counter::PointsSpared,
                        static_cast<std::uint64_t>(spared * static_cast<double>(m_count)));
    }

    void find_knot_normals(Grid& grid) const {
        grid.knot_normals = m_mesh->knot_normals();
        grid.normal_corners.clear();
        if (!grid.knot_normals) return;
        for (const Vec2d& uv : m_places.uv)
            grid.normal_corners.push_back(
                m_mesh->normal_corners(*m_patch, CornerWeights(m_patch->kind, uv)));
    }

    void find_derivatives(Grid& grid) const {
        grid.dp_du.resize(m_count);
        grid.dp_dv.resize(m_count);
        for (std::size_t i = 0; i < m_count; ++i) {
            const Vec3d su(m_samples.su[i]), sv(m_samples.sv[i]);
            grid.dp_du[i] = Vec3f(su * m_places.step_u[i].x + sv * m_places.step_u[i].y);
            grid.dp_dv[i] = Vec3f(su * m_places.step_v[i].x + sv * m_places.step_v[i].y);
        }
    }

    void find_attributes(Grid& grid) {
        const auto fill = [&](const AttributeRequest& request, GridAttribute& out) {
            m_mesh->attribute(*m_patch, request, m_places.uv, out.values, m_by_u, m_by_v);
            m_mesh->displace(request, m_offsets, 0, out.values, m_by_u, m_by_v);
            if (!request.derivatives) {
                out.du.clear();
                out.dv.clear();
                return;
            }
            const std::size_t width = static_cast<std::size_t>(out.width);
            out.du.resize(out.values.size());
            out.dv.resize(out.values.size());
            for (std::size_t i = 0; i < out.values.size(); ++i) {
                const Vec2d &u = m_places.step_u[i / width], &v = m_places.step_v[i / width];
                out.du[i] = static_cast<float>(m_by_u[i] * u.x + m_by_v[i] * u.y);
                out.dv[i] = static_cast<float>(m_by_u[i] * v.x + m_by_v[i] * v.y);
            }
        };
        make_attributes(grid, m_mesh->view().requests_of(grid.material), fill);
    }

    const OpenedMesh* m_mesh = nullptr;
    const BasePatch* m_patch = nullptr;
    Lattice m_lattice{};
    std::size_t m_count = 0;  ///< vertices
    ParametricPositions m_places;
    std::vector<int> m_ends[4];
    std::vector<float> m_by_u, m_by_v;
    std::vector<Vec3f> m_path;
    SurfaceSamples m_samples;
    // Of what is displaced:
    LatticeOffsets m_inside;
    Offsets m_offsets, m_border_offsets;
    std::vector<SurfacePlace> m_border;  ///< [vertices] who says where one goes, on the border
    std::vector<int> m_border_vertices;
    std::vector<SurfacePlace> m_sites;  ///< whose offsets are asked for
};

}  // namespace

void dice_lattice(const OpenedMesh& mesh, const BasePatch& patch, const Lattice& lattice,
                  Grid& grid) {
    static thread_local LatticeDicer dicer;
    dicer.dice(mesh, patch, lattice, grid);
}

}  // namespace granita
