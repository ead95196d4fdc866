// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons: Blender's triangles (polygon_patches.h).
#pragma once

#include "dice/opened_mesh.h"

namespace granita {

class OpenedPolygons final : public OpenedMesh {
  public:
    OpenedPolygons(const View& view, std::size_t instance,
                   std::shared_ptr<const SharedGeometry> shared, MeshPart part, Knots knots,
                   Report& report);

    Start start(const BasePatch& patch, int budget) const override;
    bool straight_edges() const override { return true; }
    std::vector<Bounds3f> boxes(const BasePatch& patch, const Vec2d* corner_uv) const override;
    void edge_point(const EdgeRef& edge, double t, EdgePoint& out) const override;
    SurfacePlace edge_place(const EdgeRef& edge, double t) const override;
    void surface_point(const BasePatch& patch, const Vec2d& uv, EdgePoint& out) const override;
    void sample(const BasePatch& patch, std::span<const Vec2d> uv,
                SurfaceSamples& out) const override;

    FrameFace frame_face(const BasePatch& patch) const override;
    bool may_be_small(const BasePatch&) const override { return true; }
};

}  // namespace granita
