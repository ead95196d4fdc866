// SPDX-License-Identifier: GPL-3.0-or-later
// A subdivision surface: the limit of its cage, regular and irregular faces alike.  A quad is one
// patch, another face one patch a corner.
//
// Base edges: {edge, kWhole} of SubdivisionTopology; {face, corner} is the line from the middle of
// the edge that leaves this corner to the face's centre, between two sub-faces.
#pragma once

#include <map>

#include "dice/opened_mesh.h"
#include "geometry/limit_face.h"

namespace granita {

class OpenedSubdivision final : public OpenedMesh {
  public:
    OpenedSubdivision(const View& view, std::size_t instance,
                      std::shared_ptr<const SharedGeometry> shared, Knots knots, Report& report);

    Start start(const BasePatch& patch, int budget) const override;
    bool straight_edges() const override { return false; }
    std::vector<Bounds3f> boxes(const BasePatch& patch, const Vec2d* corner_uv) const override;
    void edge_point(const EdgeRef& edge, double t, EdgePoint& out) const override;
    void surface_point(const BasePatch& patch, const Vec2d& uv, EdgePoint& out) const override;
    void sample(const BasePatch& patch, std::span<const Vec2d> uv,
                SurfaceSamples& out) const override;
    void attribute(const BasePatch& patch, const AttributeRequest& request,
                   std::span<const Vec2d> uv, std::vector<float>& values, std::vector<float>& du,
                   std::vector<float>& dv) const override;

  private:
    static constexpr std::uint32_t kWhole = 0xffffffffu;

    const SubdivisionTopology& topology() const { return *shared().subdivision(); }
    struct FaceSlot;
    FaceSlot& slot(int face) const;
    const LimitFace& face(int index) const;
    const LimitFace& uv_map(int face, int channel) const;
    Side base_side(std::uint32_t face, int local, std::int32_t from, int budget,
                   const SideWalker& walk) const;
    /// `amount`: displacement along the normal, metres.
    void limit_point(int face, const Vec2d& uv, double amount, EdgePoint& out) const;

    std::uint64_t m_id;                ///< of this opened instance, in each thread's face cache
    std::vector<const Vec3f*> m_sets;  ///< points at the knots, then in object space if asked for
    std::map<AttributeSource, std::size_t> m_position_column;  ///< of the latter, in a limit point
};

}  // namespace granita
