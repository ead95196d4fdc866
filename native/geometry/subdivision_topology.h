// SPDX-License-Identifier: GPL-3.0-or-later
// The topology of a subdivision surface for OpenSubdiv's Bfr, shared by the instances of its cage.
//
// Limit points on a shared edge or vertex come out equal only to rounding from the two sides.  Each
// edge and vertex therefore has one owner, the usable face of the lowest index, and border points
// are evaluated there alone.
#pragma once

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/far/topologyRefiner.h>

#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <vector>

#include "scene/geometry_data.h"

namespace granita {

class SubdivisionTopology {
  public:
    using Cache = OpenSubdiv::Bfr::SurfaceFactoryCacheThreaded<std::shared_mutex,
                                                               std::shared_lock<std::shared_mutex>,
                                                               std::unique_lock<std::shared_mutex>>;
    using Factory = OpenSubdiv::Bfr::RefinerSurfaceFactory<Cache>;

    struct Owner {
        std::int32_t face = -1;  ///< -1: no usable face
        std::int32_t local = 0;  ///< edge or corner number within the face
    };
    struct Edge {
        std::int32_t lo = 0, hi = 0;  ///< vertices, lo < hi: the edge's own direction
        Owner owner;
        bool halved = false;  ///< touches a face that is no quad: its sub-faces meet in the middle
    };

    /// nullptr, with the reason, where OpenSubdiv cannot take the mesh.
    static std::unique_ptr<SubdivisionTopology> create(const GeometryData& data, std::string& why);

    /// `usable` [F]: faces that may own edges and vertices.
    void find_owners(const std::vector<std::uint8_t>& usable);

    /// Thread-safe.
    const Factory& factory() const { return *m_factory; }
    std::size_t edge_count() const { return m_edges.size(); }
    const Edge& edge(std::size_t index) const { return m_edges[index]; }
    const Owner& vertex_owner(std::size_t vertex) const { return m_vertex_owners[vertex]; }
    /// The edge that leaves corner `local` of a face.
    std::size_t face_edge(std::size_t face, int local) const;

    /// Face-varying channel of a UV attribute (index in GeometryData::attributes), -1 if it is
    /// none.
    int uv_channel(std::size_t attribute) const { return m_uv_channels[attribute]; }
    /// [values][2] of a channel: UVs of one vertex within 1e-4 of each other are one, as in
    /// Blender.
    const std::vector<float>& uv_values(int channel) const {
        return m_uv_values[static_cast<std::size_t>(channel)];
    }
    std::uint64_t bytes() const { return m_bytes; }

  private:
    std::unique_ptr<OpenSubdiv::Far::TopologyRefiner> m_refiner;
    std::unique_ptr<Factory> m_factory;
    std::vector<Edge> m_edges;
    std::vector<Owner> m_vertex_owners;
    std::vector<int> m_uv_channels;
    std::vector<std::vector<float>> m_uv_values;
    std::uint64_t m_bytes = 0;
};

}  // namespace granita
