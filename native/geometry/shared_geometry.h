// SPDX-License-Identifier: GPL-3.0-or-later
// What all instances of one geometry share and no camera changes: its faces as patches, its normals
// and, for a subdivision surface, its topology for OpenSubdiv.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/report.h"
#include "geometry/attribute_request.h"
#include "math/bounds.h"
#include "scene/geometry_data.h"

namespace granita {

class SubdivisionTopology;

/// A patch is a quad domain (u, v) of a face:
///   Quad      the face itself: corner 0 at (0,0), 1 at (1,0), 2 at (1,1), 3 at (0,1)
///   Triangle  barycentric: corner 0 at (0,0), 1 at (1,0), 2 at (0,1)
///   SubFace   of a subdivided n-gon: its corner `sub` at (0,0), the middle of the edge that leaves
///             it at (1,0), the face's centre at (1,1), the middle of the arriving edge at (0,1)
enum class PatchKind : std::uint8_t { Quad, Triangle, SubFace };

struct BasePatch {
    std::uint32_t face = 0;
    std::uint32_t sub = 0;                   ///< number within the face
    std::uint32_t corner[4] = {0, 0, 0, 0};  ///< in corner_verts; a triangle repeats its last
    PatchKind kind = PatchKind::Quad;
    bool whole_face = true;  ///< the only patch of its face
};

class SharedGeometry {
  public:
    /// Reports what had to be left out by the geometry's name.
    SharedGeometry(const GeometryData& data, float frame_time, Report& report);
    ~SharedGeometry();

    const GeometryData& data() const { return *m_data; }
    const std::vector<BasePatch>& patches() const { return m_patches; }
    std::uint32_t first_corner(std::size_t face) const { return m_first_corner[face]; }
    /// All knots hold the same points.
    bool is_static() const { return m_static; }
    /// [V] object space, at the frame time.
    std::span<const Vec3f> frame_points() const { return m_frame_points; }
    /// [V] what positions of a source are made of: frame_points(), or those of another frame.
    std::span<const Vec3f> points(AttributeSource source) const;
    /// Of the finite frame points.
    const Bounds3f& frame_box() const { return m_frame_box; }
    /// [V] object space, at the frame time; empty when no face asks for them.
    const std::vector<Vec3f>& vertex_normals() const { return m_vertex_normals; }
    /// nullptr: polygons.
    const SubdivisionTopology* subdivision() const { return m_subdivision.get(); }
    std::uint64_t bytes() const;

  private:
    void find_frame_points(float frame_time);
    /// [F] 1 = the face can be rendered.
    std::vector<std::uint8_t> usable_faces() const;
    void add_polygon(std::uint32_t face, std::size_t& crossed);
    void add_subdivided(std::uint32_t face);

    const GeometryData* m_data;
    std::vector<std::uint32_t> m_first_corner;
    std::vector<BasePatch> m_patches;
    bool m_static = true;
    std::vector<Vec3f> m_interpolated;  ///< backs m_frame_points when they are no knot
    std::span<const Vec3f> m_frame_points;
    Bounds3f m_frame_box;
    std::vector<Vec3f> m_vertex_normals;
    std::unique_ptr<SubdivisionTopology> m_subdivision;
};

}  // namespace granita
