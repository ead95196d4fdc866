// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of a mesh in object space: limits of subdivision faces, and (patch, uv) to
// attributes.  Dicing, the ray scene and shadows all read it here.
//
// Attributes are linear in each triangle of a polygon; on a subdivision surface UV maps and texture
// coordinates are the limits of the cage's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/attribute_request.h"
#include "geometry/limit_face.h"
#include "geometry/shared_geometry.h"

namespace granita {

/// Thread-safe; each thread keeps the limit faces it used last.  The geometry must outlive it.
class SurfaceEvaluator {
  public:
    explicit SurfaceEvaluator(const SharedGeometry& geometry);

    /// 1 where the geometry stands still.
    int knots() const { return m_knots; }

    /// Of a subdivision surface: the limit of a face, columns 3 k .. 3 k + 2 are knot k.  Valid
    /// until the thread asks for a hundred others.
    const LimitFace& limit_face(int face) const;

    /// `values`, `du`, `dv` [n][request.width] at the frame time, derivatives by u and v of the
    /// patch. Zeros where the geometry has nothing of that name.
    void attribute(const BasePatch& patch, const AttributeRequest& request,
                   std::span<const Vec2d> uv, std::vector<float>& values, std::vector<float>& du,
                   std::vector<float>& dv) const;

  private:
    struct FaceSlot;
    FaceSlot& slot(int face) const;
    const LimitFace& uv_map(int face, int channel) const;
    /// Of the vertices of another frame.
    const LimitFace& positions_of(int face, AttributeSource source) const;
    void limit_attribute(const BasePatch& patch, const AttributeRequest& request, int channel,
                         std::span<const Vec2d> uv, std::vector<float>& values,
                         std::vector<float>& du, std::vector<float>& dv) const;

    const SharedGeometry* m_geometry;
    std::uint64_t m_id;  ///< in each thread's slots
    int m_knots;
    std::vector<const Vec3f*> m_sets;  ///< [knots] vertices
};

}  // namespace granita
