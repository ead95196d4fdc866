// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons without subdivision are Blender's loop triangles, flat or smooth: what its viewport,
// Cycles and EEVEE draw.
//
// A quad is cut from its first corner to its third, or from its second to its fourth where that cut
// would turn a triangle over (Blender's rule).  Quads are common, and as one patch they dice into
// half the micropolygons of two, so they are one (PatchKind::TrianglePair).  Where they are bent
// sharply and more than a micropolygon, dicing takes them apart: then the crease is an edge of its
// own, as sharp as Blender's.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/shared_geometry.h"

namespace granita {

class PolygonPatches {
  public:
    /// `first_corner` [F]; `points` [V] at the frame time: where they move, the triangles stay.
    PolygonPatches(const GeometryData& data, std::span<const std::uint32_t> first_corner,
                   std::span<const Vec3f> points)
        : m_data(&data), m_first_corner(first_corner), m_points(points) {}

    /// Appends a face's patches; faces come in order.
    void add(std::uint32_t face, std::vector<BasePatch>& patches);
    /// A face that is left out.
    void skip(std::uint32_t face);
    /// Faces that cross themselves, filled as a fan.
    std::size_t crossed() const { return m_crossed; }

  private:
    void add_quad(std::uint32_t face, std::vector<BasePatch>& patches) const;
    void add_ngon(std::uint32_t face, std::vector<BasePatch>& patches);
    const Vec3f& point(std::uint32_t corner) const {
        return m_points[static_cast<std::size_t>(m_data->corner_verts[corner])];
    }

    const GeometryData* m_data;
    std::span<const std::uint32_t> m_first_corner;
    std::span<const Vec3f> m_points;
    std::size_t m_ngon_corner = 0;  ///< in GeometryData::ngon_triangles, of the next n-gon
    std::size_t m_crossed = 0;
};

}  // namespace granita
