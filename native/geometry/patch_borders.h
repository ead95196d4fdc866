// SPDX-License-Identifier: GPL-3.0-or-later
// What patches share: edges with a direction of their own, and for every place on them the one
// patch that answers for it, whoever asks (decision 10): of those that share it the first.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/surface_place.h"

namespace granita {

class PatchBorders {
  public:
    explicit PatchBorders(const SharedGeometry& geometry);

    /// A side of a patch: [from, to] of an edge, in [0, 1] of the edge's own direction.
    struct Side {
        std::uint32_t edge = 0;
        double from = 0.0, to = 1.0;
    };
    /// Sides run around the patch from corner to corner: 3 of a triangle, else 4.
    Side side(std::size_t patch, int number) const;
    static int side_count(PatchKind kind) { return kind == PatchKind::Triangle ? 3 : 4; }

    std::size_t edge_count() const { return m_edge_count; }
    /// The owner's place of a point of an edge.
    SurfacePlace place(std::uint32_t edge, double t) const;
    /// The owner's place of a vertex: of an edge's end, whichever edge it is.
    SurfacePlace vertex(std::size_t vertex) const;

    /// Of polygons: the edge between two vertices, which runs from `lo` to `hi`.
    std::uint32_t edge_of(std::uint32_t lo, std::uint32_t hi) const;
    /// Of a subdivision surface: of the cage, as SubdivisionTopology counts.
    static std::uint32_t cage_edge(std::size_t index) { return static_cast<std::uint32_t>(index); }
    /// The line from the middle of the edge that leaves a corner of a face to the face's centre.
    std::uint32_t spoke(std::uint32_t face, std::uint32_t corner) const;

    std::uint64_t bytes() const {
        return sizeof(PolygonEdge) * m_edges.size() + 4 * m_vertex_owners.size();
    }

  private:
    struct PolygonEdge {
        std::uint32_t lo, hi;
        std::uint32_t patch;
        std::uint8_t a, b;  ///< corners of the patch at `lo` and at `hi`
    };
    void find_polygon_edges();
    SurfacePlace on_cage(std::size_t edge, double t) const;
    SurfacePlace on_face(std::int32_t face, std::int32_t local, double t) const;

    const SharedGeometry& m_geometry;
    std::size_t m_edge_count = 0;
    std::vector<PolygonEdge> m_edges;            ///< by lo, then hi
    std::vector<std::uint32_t> m_vertex_owners;  ///< [V] patch * 4 + corner
};

}  // namespace granita
