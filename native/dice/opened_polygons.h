// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons: triangles are flat, convex quads bilinear patches, everything else triangulated.
#pragma once

#include "dice/frame_face.h"
#include "dice/opened_mesh.h"
#include "dice/small_faces.h"

namespace granita {

class OpenedPolygons final : public OpenedMesh {
  public:
    OpenedPolygons(const View& view, std::size_t instance,
                   std::shared_ptr<const SharedGeometry> shared, Knots knots, Report& report);

    std::size_t primitive_count() const override {
        return m_small.others().size() + m_small.batch_count();
    }
    std::unique_ptr<Primitive> primitive(std::size_t primitive) const override;
    std::uint64_t bytes() const override { return OpenedMesh::bytes() + m_small.bytes(); }

    Start start(const BasePatch& patch, int budget) const override;
    bool straight_edges() const override { return true; }
    std::vector<Bounds3f> boxes(const BasePatch& patch, const Vec2d* corner_uv) const override;
    void edge_point(const EdgeRef& edge, double t, EdgePoint& out) const override;
    void surface_point(const BasePatch& patch, const Vec2d& uv, EdgePoint& out) const override;
    void sample(const BasePatch& patch, std::span<const Vec2d> uv,
                SurfaceSamples& out) const override;
    void attribute(const BasePatch& patch, const AttributeRequest& request,
                   std::span<const Vec2d> uv, std::vector<float>& values, std::vector<float>& du,
                   std::vector<float>& dv) const override;

    FrameFace frame_face(const BasePatch& patch) const;
    /// [4] of a patch at a knot.
    struct Corners {
        Vec3d p[4];
    };
    Corners corners(const BasePatch& patch, int knot) const;

  protected:
    std::vector<Bounds3f> primitive_boxes(std::size_t primitive) const override;

  private:
    /// Unit direction of displacement at a knot.
    Vec3d direction(const BasePatch& patch, int knot, const CornerWeights& weights,
                    const Corners& at) const;
    bool smooth(std::uint32_t face) const;

    SmallFaces m_small;               ///< none where displaced
    std::vector<Vec3f> m_directions;  ///< [knots][V] vertex normals; empty when not displaced
};

}  // namespace granita
