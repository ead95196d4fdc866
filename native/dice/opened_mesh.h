// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh in camera space at its knots: what patches ask of the surface they lie on.  Polygons and
// subdivision surfaces are its two kinds.
#pragma once

#include <span>
#include <vector>

#include "dice/edge_rate.h"
#include "dice/frame_face.h"
#include "dice/grid.h"
#include "dice/knots.h"
#include "dice/mesh_part.h"
#include "dice/patch_edge.h"
#include "dice/primitive.h"
#include "dice/small_faces.h"
#include "dice/view.h"
#include "geometry/displacement.h"
#include "geometry/shared_geometry.h"

namespace granita {

/// The surface at n points (u, v) of a patch, camera space.  Derivatives by u and v, not by steps.
struct SurfaceSamples {
    std::vector<Vec3f> positions;         ///< [knots][n], not displaced
    std::vector<Vec3f> su, sv;            ///< [n] at the frame time
    std::vector<Vec3f> normal;            ///< [n] unit, shading, at the frame time
    std::vector<Vec3f> geometric_normal;  ///< [n] unit, at the frame time
    std::vector<Vec3f> rise;              ///< [n] as Grid::rise; empty unless OpenedMesh::rises()
};

class OpenedMesh : public OpenedInstance, public std::enable_shared_from_this<OpenedMesh> {
  public:
    /// Faces' corner places in (u, v) and their four sides, classified, ready to split and dice.
    struct Start {
        Vec2d corner_uv[4];
        PatchEdge sides[4];  ///< bottom (0 to 1), right (1 to 2), top (3 to 2), left (0 to 3)
    };

    OpenedMesh(const View& view, std::size_t instance, std::shared_ptr<const SharedGeometry> shared,
               MeshPart part, Knots knots, Report& report);

    std::size_t primitive_count() const override {
        return m_small.others().size() + m_small.batch_count();
    }
    RasterBounds bounds(std::size_t primitive) const final;
    std::vector<Bounds3f> knot_boxes(std::size_t primitive) const final {
        return knot_count() > 1 ? primitive_boxes(primitive) : std::vector<Bounds3f>{};
    }
    std::unique_ptr<Primitive> primitive(std::size_t primitive) const final;
    std::uint64_t bytes() const override;

    virtual Start start(const BasePatch& patch, int budget) const = 0;
    /// Base edges are straight in camera space: their two ends tell their length.
    virtual bool straight_edges() const = 0;
    /// [knots] conservative, not displaced, for the patch inside `corner_uv`.
    virtual std::vector<Bounds3f> boxes(const BasePatch& patch, const Vec2d* corner_uv) const = 0;
    virtual void edge_point(const EdgeRef& edge, double t, EdgePoint& out) const = 0;
    /// Who says how far that point is displaced.
    virtual SurfacePlace edge_place(const EdgeRef& edge, double t) const = 0;
    virtual void surface_point(const BasePatch& patch, const Vec2d& uv, EdgePoint& out) const = 0;
    virtual void sample(const BasePatch& patch, std::span<const Vec2d> uv,
                        SurfaceSamples& out) const = 0;
    /// `values`, `du`, `dv` [n][request.width]; derivatives by u and v.
    void attribute(const BasePatch& patch, const AttributeRequest& request,
                   std::span<const Vec2d> uv, std::vector<float>& values, std::vector<float>& du,
                   std::vector<float>& dv) const;

    /// Of a patch whose corners are vertices.
    virtual FrameFace frame_face(const BasePatch& patch) const = 0;
    /// Whether a patch whose sides are short may share a grid with others.
    virtual bool may_be_small(const BasePatch& patch) const = 0;
    /// [4] of a patch at a knot.
    struct Corners {
        Vec3d p[4];
    };
    Corners corners(const BasePatch& patch, int knot) const;

    // Of small faces (SmallFaces), which is where displacement has moved them:
    /// A corner's vertex at a knot, camera space.
    Vec3f small_point(int knot, std::uint32_t corner) const {
        const std::size_t place = place_of(corner);
        return m_displaced ? m_small.offsets().point(*this, knot, place) : points(knot)[place];
    }
    FrameFace small_face(const BasePatch& patch) const;
    /// Of what is displaced, object space.
    std::array<Vec3f, 4> corner_offsets(const BasePatch& patch) const;
    /// As displacement moves values of an attribute at (u, v), whose weights are those of `kind`.
    void displace(const BasePatch& patch, PatchKind kind, const AttributeRequest& request,
                  std::span<const Vec2d> uv, std::vector<float>& values, std::vector<float>& du,
                  std::vector<float>& dv) const;

    const View& view() const { return *m_view; }
    const Instance& instance() const { return *m_instance; }
    std::size_t instance_index() const { return m_instance_index; }
    const SharedGeometry& shared() const { return *m_shared; }
    const GeometryData& data() const { return m_shared->data(); }
    const Knots& knots() const { return m_knots; }
    int knot_count() const { return m_knots.count; }
    /// What of the geometry there is here: primitives are of nothing else.
    const MeshPart& part() const { return m_part; }
    /// [part().vertex_count()] camera space, where vertices lie on the surface.
    std::span<const Vec3f> points(int knot) const {
        const std::size_t count = m_part.vertex_count();
        return {m_points.data() + static_cast<std::size_t>(knot) * count, count};
    }
    /// Place in points() of a corner's vertex.
    std::size_t place_of(std::uint32_t corner) const {
        return m_part.place(static_cast<std::size_t>(data().corner_verts[corner]));
    }
    const EdgeRate& rate() const { return m_rate; }
    /// -1 where the frame's matrix mirrors (camera space itself is left-handed): turns cross
    /// products outward.
    double frame_orientation() const { return m_frame_orientation; }
    Report& report() const { return *m_report; }

    /// The largest stretch from object to camera space at the frame time.
    float frame_scale() const;
    /// Index in Scene::materials, -1 = none.
    int material(std::uint32_t face) const;
    /// Whether what has a material cuts out of the picture.
    bool holds_out(int material) const { return m_view->scene->holds_out(*m_instance, material); }
    /// Normals of its own tell of a smoother surface, and there is light to ask for it.
    bool rises() const {
        return m_view->has_light && !m_displaced && !m_shared->subdivision() &&
               (!data().corner_normals.empty() || !m_shared->vertex_normals().empty());
    }
    /// Grid::rise where the face itself has the normal `flat`.
    Vec3f rise(const FrameFace& face, const CornerWeights& weights, const Vec3d& flat) const;
    /// Grid::knot_normals
    std::shared_ptr<const KnotNormals> knot_normals() const;
    /// Grid::normal_corners at a place of a polygon's patch.
    CornerBlend normal_corners(const BasePatch& patch, const CornerWeights& weights) const;
    /// A normal of what is seen at `p`, camera space, turned to the side that is.
    Vec3f seen_side(const Vec3f& p, const Vec3f& outward) const {
        const Vec3f along = view().projection.perspective ? p : Vec3f(0.0f, 0.0f, 1.0f);
        return glm::dot(outward, along) > 0.0f ? -outward : outward;
    }
    /// Any material of the instance displaces.
    bool displaced() const { return m_displaced; }
    /// The longest way that displacement may move a point at any knot, metres.
    float displacement_reach() const { return m_displacement_reach; }
    /// Where it is displaced: how far that moves these places.
    void find_offsets(std::span<const SurfacePlace> places, bool derivatives, Offsets& out) const {
        m_view->displacement->find(m_instance_index, *m_shared, places, derivatives, out);
    }
    /// Displacement::find_beside
    void find_offsets_beside(std::span<const SurfacePlace> places, Offsets& out) const {
        m_view->displacement->find_beside(m_instance_index, *m_shared, places, out);
    }
    /// Whether values of an attribute move along: places of the frame and of those around it.
    bool displaces(const AttributeRequest& request) const {
        return m_displaced && request.source != AttributeSource::Generated &&
               is_position(request.source);
    }
    /// Of the i-th of some places that have these offsets.
    void displace(TangentFrame& at, const Offsets& offsets, std::size_t i) const {
        const Mat3d turn(m_knots.frame_camera_from_object);
        at.displace(turn * Vec3d(offsets.by_u[i]), turn * Vec3d(offsets.by_v[i]),
                    m_frame_orientation);
    }
    /// Values of an attribute at places, which begin with the first-th of those that have these
    /// offsets.
    void displace(const AttributeRequest& request, const Offsets& offsets, std::size_t first,
                  std::vector<float>& values, std::vector<float>& du, std::vector<float>& dv) const;
    /// Where a point of camera space at a knot goes that has this offset in object space.
    Vec3f displaced(int knot, const Vec3f& p, const Vec3f& offset) const {
        const Mat3d turn(m_knots.camera_from_object[static_cast<std::size_t>(knot)]);
        return p + Vec3f(turn * Vec3d(offset));
    }

    /// Object-space normals to camera space at the frame time, of any length.
    Vec3d camera_normal(const Vec3f& normal_object) const;

  protected:
    /// Once an instance can answer for its patches: at the end of its constructor.
    void find_small_faces();
    /// Places and orientation of a patch's corners at the frame time, without normals.
    FrameFace frame_corners(const BasePatch& patch) const;
    const Vec3f& point(int knot, std::size_t vertex) const {
        return points(knot)[m_part.place(vertex)];
    }
    std::int32_t vertex_of(std::uint32_t corner) const { return data().corner_verts[corner]; }
    /// From a knot's values to the frame time.
    Vec3d at_frame(const Vec3d& knot, const Vec3d& next) const {
        return knot * (1.0 - m_knots.frame_fraction) + next * m_knots.frame_fraction;
    }

  private:
    /// [knots]
    std::vector<Bounds3f> primitive_boxes(std::size_t primitive) const;
    void transform_points();
    void find_displacement();

    const View* m_view;
    const Instance* m_instance;
    std::size_t m_instance_index;
    std::shared_ptr<const SharedGeometry> m_shared;
    Knots m_knots;
    Report* m_report;
    bool m_displaced;
    EdgeRate m_rate;
    MeshPart m_part;
    std::vector<Vec3f> m_points;  ///< [knots][vertices of the part] camera space
    double m_frame_orientation = 1.0;
    Mat3d m_camera_from_object_normal{1.0};
    float m_displacement_reach = 0.0f;
    SmallFaces m_small;
};

}  // namespace granita
