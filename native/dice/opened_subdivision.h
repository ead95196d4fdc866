// SPDX-License-Identifier: GPL-3.0-or-later
// A subdivision surface: the limit of its cage, regular and irregular faces alike.  A quad is one
// patch, another face one patch a corner.
//
// Base edges: {edge, kWhole} of SubdivisionTopology; {face, corner} is the line from the middle of
// the edge that leaves this corner to the face's centre, between two sub-faces.
#pragma once

#include "dice/opened_mesh.h"
#include "geometry/surface_evaluator.h"

namespace granita {

class OpenedSubdivision final : public OpenedMesh {
  public:
    OpenedSubdivision(const View& view, std::size_t instance,
                      const std::shared_ptr<const SharedGeometry>& shared, Knots knots,
                      Report& report);

    Start start(const BasePatch& patch, int budget) const override;
    bool straight_edges() const override { return false; }
    std::vector<Bounds3f> boxes(const BasePatch& patch, const Vec2d* corner_uv) const override;
    void edge_point(const EdgeRef& edge, double t, EdgePoint& out) const override;
    SurfacePlace edge_place(const EdgeRef& edge, double t) const override;
    void surface_point(const BasePatch& patch, const Vec2d& uv, EdgePoint& out) const override;
    void sample(const BasePatch& patch, std::span<const Vec2d> uv,
                SurfaceSamples& out) const override;
    FrameFace frame_face(const BasePatch& patch) const override;
    bool may_be_small(const BasePatch& patch) const override;

  private:
    static constexpr std::uint32_t kWhole = 0xffffffffu;

    const SubdivisionTopology& topology() const { return *shared().subdivision(); }
    const LimitFace& face(int index) const { return shared().surface().limit_face(index); }
    /// A place at a knot from a limit point's columns, one a knot of the geometry.
    Vec3d place(const double* columns, int knot) const;
    /// A derivative likewise.
    Vec3d direction(const double* columns, int knot) const;
    /// Vertices lie where all faces have them (LimitVertices).
    void copy_vertex(std::size_t vertex, EdgePoint& out) const;
    /// A point of an edge of the cage.
    void cage_point(std::size_t edge, double t, EdgePoint& out) const;
    PatchEdge base_side(std::uint32_t face, int local, std::int32_t from, int budget,
                        const EdgeWalker& walk) const;
    void limit_point(int face, const Vec2d& uv, EdgePoint& out) const;

    /// [edges] that stay whole, looked at as their ends are, without the surface between.
    std::vector<bool> m_whole;
    std::vector<KnotTime> m_times;  ///< [knots] among the geometry's
};

}  // namespace granita
