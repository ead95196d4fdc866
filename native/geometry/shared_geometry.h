// SPDX-License-Identifier: GPL-3.0-or-later
// What all instances of one geometry share and no camera changes: its faces as patches, its normals
// and, for a subdivision surface, its topology for OpenSubdiv.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <shared_mutex>
#include <span>
#include <string>
#include <vector>

#include "base/once.h"
#include "base/parallel.h"
#include "base/report.h"
#include "geometry/attribute_request.h"
#include "math/bounds.h"
#include "scene/geometry_data.h"
#include "scene/knot_time.h"

namespace granita {

class KnotNormals;
struct LimitVertices;
class PatchBorders;
class SubdivisionTopology;
class SurfaceEvaluator;

/// A patch is a quad domain (u, v) of a face:
///   Quad          of a cage: corner 0 at (0,0), 1 at (1,0), 2 at (1,1), 3 at (0,1)
///   SubFace       of a cage's n-gon: its corner `sub` at (0,0), the middle of the edge that leaves
///                 it at (1,0), the face's centre at (1,1), the middle of the arriving edge at
///                 (0,1)
///   Triangle      of a polygon, barycentric: corner 0 at (0,0), 1 at (1,0), 2 at (0,1)
///   TrianglePair  two of a polygon, corners as a Quad's: (0,1,2) where u > v and (0,2,3)
enum class PatchKind : std::uint8_t { Quad, SubFace, Triangle, TrianglePair };
/// Of its domain.
inline Vec2d middle_of(PatchKind kind) {
    return Vec2d(kind == PatchKind::Triangle ? 1.0 / 3.0 : 0.5);
}

struct BasePatch {
    std::uint32_t face = 0;
    std::uint32_t sub = 0;                   ///< number within the face
    std::uint32_t corner[4] = {0, 0, 0, 0};  ///< in corner_verts; a triangle repeats its last
    PatchKind kind = PatchKind::Quad;
    bool whole_face = true;  ///< the only patch of its face
    bool bent = false;       ///< a pair whose crease is too sharp to be blurred by a micropolygon

    /// The first (0) or the second triangle of a pair, as a patch of its own.
    BasePatch half(int number) const;
};

class SharedGeometry {
  public:
    /// Reports what had to be left out by the geometry's name.
    SharedGeometry(const GeometryData& data, float frame_time, Report& report);
    ~SharedGeometry();

    const GeometryData& data() const { return *m_data; }
    const std::vector<BasePatch>& patches() const { return m_patches; }
    std::uint32_t first_corner(std::size_t face) const { return m_first_corner[face]; }
    std::uint32_t first_patch(std::size_t face) const { return m_first_patch[face]; }
    std::uint32_t face_of(std::uint32_t corner) const;
    /// All knots hold the same points.
    bool is_static() const { return m_static; }
    /// The frame time among the geometry's knots; the first where it stands still.
    const KnotTime& frame() const { return m_frame; }
    /// A time of the shutter likewise.
    KnotTime at(float time) const {
        return m_static ? KnotTime{} : knot_time(static_cast<double>(time), m_data->knots);
    }
    /// [V] object space, of a knot; all of them are one where it stands still.
    std::span<const Vec3f> knot_points(int knot) const;
    /// Knots at which its points differ: 1 where it stands still.
    int surface_knots() const { return m_static ? 1 : m_data->knots; }
    /// The same where the surface is: of a subdivision cage its limit.
    std::span<const Vec3f> surface_points(int knot) const;
    /// [V] object space, at the frame time.
    std::span<const Vec3f> frame_points() const { return m_frame_points; }
    /// [V] what positions of a source are made of: frame_points(), those of another frame, or the
    /// Generated coordinates themselves where the geometry has them.
    std::span<const Vec3f> points(AttributeSource source) const;
    /// Of the finite frame points.
    const Bounds3f& frame_box() const { return m_frame_box; }
    /// [V] object space, at the frame time; empty when no face asks for them.
    const std::vector<Vec3f>& vertex_normals() const { return m_vertex_normals; }
    /// Whether a polygon has other shading normals than its own.
    bool is_smooth(std::uint32_t face) const {
        return !m_data->corner_normals.empty() ||
               (!m_data->smooth.empty() && m_data->smooth[face] != 0 && !m_vertex_normals.empty());
    }
    /// Where it has: of a corner, object space, at the frame time.
    const Vec3f& smooth_normal(std::uint32_t corner) const {
        if (!m_data->corner_normals.empty()) return m_data->corner_normals[corner];
        return m_vertex_normals[static_cast<std::size_t>(m_data->corner_verts[corner])];
    }
    /// nullptr: none but faces' own, which are told by its points, or they stay as they are.
    /// Computed at the first call; any thread.
    const KnotNormals* knot_normals() const;
    /// Of a polygon's patch, unit, object space, at the frame time; a triangle repeats its last.
    std::array<Vec3f, 4> corner_normals(const BasePatch& patch) const;
    /// tangents() of a polygon's patch in a UV map (empty: the one active for render; where the
    /// mesh has none, longitude and latitude around its origin, as in Cycles), at the frame time.
    /// Computed at the first call for a map; any thread.
    std::array<Vec4f, 4> corner_tangents(const BasePatch& patch, const std::string& uv_map) const;
    /// nullptr: polygons.
    const SubdivisionTopology* subdivision() const { return m_subdivision.get(); }
    /// nullptr: polygons.
    const LimitVertices* limit() const { return m_limit.get(); }
    const SurfaceEvaluator& surface() const { return *m_surface; }
    /// Who answers for what patches share.  Computed at the first call; any thread.
    const PatchBorders& borders() const;
    std::uint64_t bytes() const;

  private:
    void find_frame_points(float frame_time);
    void find_normals();
    /// [F] 1 = the face can be rendered.
    std::vector<std::uint8_t> usable_faces() const;
    void add_subdivided(std::uint32_t face);
    std::vector<Vec4f> make_tangents(const std::string& uv_map) const;

    const GeometryData* m_data;
    std::vector<std::uint32_t> m_first_corner;
    std::vector<std::uint32_t> m_first_patch;  ///< [F]
    std::vector<BasePatch> m_patches;
    bool m_static = true;
    std::vector<Vec3f> m_interpolated;  ///< backs m_frame_points when they are no knot
    std::span<const Vec3f> m_frame_points;
    KnotTime m_frame;
    Bounds3f m_frame_box;
    std::vector<Vec3f> m_vertex_normals;
    std::unique_ptr<SubdivisionTopology> m_subdivision;
    std::unique_ptr<const LimitVertices> m_limit;
    std::unique_ptr<const SurfaceEvaluator> m_surface;
    mutable Once m_borders_once;
    mutable std::unique_ptr<const PatchBorders> m_borders;
    mutable SharedOnce m_knot_normals_once;
    mutable std::unique_ptr<const KnotNormals> m_knot_normals;
    mutable std::shared_mutex m_tangent_mutex;
    mutable std::map<std::string, std::vector<Vec4f>> m_tangents;  ///< [patches][4] by UV map
};

}  // namespace granita
