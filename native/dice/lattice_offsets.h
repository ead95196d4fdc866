// SPDX-License-Identifier: GPL-3.0-or-later
// How far displacement moves lattices, and how that changes over them.
//
// What a vertex needs of slopes its neighbours tell: the program runs at one point a vertex, and
// one more all around the lattice.  Slopes over two micropolygons are those of the surface that is
// hidden; finer ones are of detail that it does not have (docs/decisions/displacement.md).
#pragma once

#include <span>
#include <vector>

#include "dice/opened_mesh.h"
#include "dice/parametric_positions.h"
#include "geometry/surface_frames.h"

namespace granita {

class LatticeOffsets {
  public:
    struct Lattice {
        const BasePatch* patch;
        const ParametricPositions* places;
    };
    /// At the vertices of all of them, each as its own patch says, with slopes along the patch's
    /// (u, v).
    void find(const OpenedMesh& mesh, std::span<const Lattice> lattices, Offsets& out);

  private:
    void add_sites(const OpenedMesh& mesh, const Lattice& lattice);
    void read(const OpenedMesh& mesh, const Lattice& lattice, Offsets& out);
    /// Over one step of the lattice from the vertex (i, j).
    Vec3f slope(const ParametricPositions& places, int i, int j, bool along_u) const;

    /// Of m_site_of: none, and, downwards, those beside the lattices.
    static constexpr int kNoSite = -1, kFirstBeside = -2;
    const Vec3f& at(int site) const {
        return site >= 0 ? m_found.offset[static_cast<std::size_t>(site)]
                         : m_found_beside.offset[static_cast<std::size_t>(kFirstBeside - site)];
    }

    std::vector<SurfacePlace> m_sites, m_beside;
    std::vector<int> m_site_of;        ///< [lattices][row][column]
    std::size_t m_first = 0;           ///< in m_site_of, of the lattice that is read
    std::vector<std::size_t> m_alone;  ///< vertices whose slopes are looked for by themselves
    std::vector<SurfacePlace> m_alone_sites;
    Offsets m_found, m_found_beside;
    SurfaceFrames m_middle;
};

}  // namespace granita
