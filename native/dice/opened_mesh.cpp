// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/opened_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "dice/face_batch.h"
#include "dice/patch.h"
#include "dice/patch_batch.h"
#include "dice/raster_bound.h"
#include "geometry/knot_normals.h"
#include "geometry/smooth_rise.h"
#include "geometry/surface_evaluator.h"
#include "math/largest_stretch.h"

namespace granita {
namespace {

/// Vertices that are transformed in a piece of a loop.
constexpr std::size_t kGrain = 1 << 13;

double orientation_of(const Mat4d& m) {
    return glm::determinant(Mat3d(m)) < 0.0 ? -1.0 : 1.0;
}

}  // namespace

OpenedMesh::OpenedMesh(const View& view, std::size_t instance,
                       std::shared_ptr<const SharedGeometry> shared, MeshPart part, Knots knots,
                       Report& report)
    : m_view(&view),
      m_instance(&view.scene->instances[instance]),
      m_instance_index(instance),
      m_shared(std::move(shared)),
      m_knots(std::move(knots)),
      m_report(&report),
      m_displaced(view.displacement && view.displacement->displaces(instance)),
      m_rate(view, 1.0, m_displaced),
      m_part(std::move(part)) {
    transform_points();
    m_frame_orientation = orientation_of(m_knots.frame_camera_from_object);
    // The cofactor matrix times the orientation is the inverse transpose up to a positive factor,
    // and it exists for scale 0 too.
    const Mat3d m(m_knots.frame_camera_from_object);
    m_camera_from_object_normal =
        m_frame_orientation *
        Mat3d(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    find_displacement();
}

void OpenedMesh::transform_points() {
    const int geometry_knots = m_shared->is_static() ? 1 : data().knots;
    const std::size_t vertex_count = m_part.vertex_count();
    m_points.resize(static_cast<std::size_t>(m_knots.count) * vertex_count);
    for (int k = 0; k < m_knots.count; ++k) {
        const Mat4d& m = m_knots.camera_from_object[static_cast<std::size_t>(k)];
        const KnotTime t = knot_time(k, m_knots.count - 1, geometry_knots);
        const Vec3f* from = m_shared->surface_points(static_cast<int>(t.knot)).data();
        const Vec3f* next =
            t.fraction > 0.0 ? m_shared->surface_points(static_cast<int>(t.knot) + 1).data() : from;
        Vec3f* to = m_points.data() + static_cast<std::size_t>(k) * vertex_count;
        parallel_for(vertex_count, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t v = m_part.vertex(i);
                const Vec3d p = t.fraction > 0.0 ? Vec3d(from[v]) * (1.0 - t.fraction) +
                                                       Vec3d(next[v]) * t.fraction
                                                 : Vec3d(from[v]);
                to[i] = Vec3f(transform_point(m, p));
            }
        });
    }
    // Knots that all came out equal, such as a thing parented to the moving camera, cost nothing.
    for (int k = 1; k < m_knots.count; ++k)
        if (!std::equal(m_points.begin(),
                        m_points.begin() + static_cast<std::ptrdiff_t>(vertex_count),
                        m_points.begin() + static_cast<std::ptrdiff_t>(vertex_count) * k))
            return;
    m_knots.count = 1;
    m_knots.frame_knot = 0;
    m_knots.frame_fraction = 0.0;
    m_knots.camera_from_object.resize(1);
    m_points.resize(vertex_count);
    m_points.shrink_to_fit();
}

void OpenedMesh::find_displacement() {
    if (!m_displaced) return;
    const float bound = m_view->displacement->bound(m_instance_index);
    for (const Mat4d& m : m_knots.camera_from_object)
        m_displacement_reach =
            std::max(m_displacement_reach, bound * static_cast<float>(largest_stretch(m)));
}

float OpenedMesh::frame_scale() const {
    double most = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        most = std::max(most, glm::length(Vec3d(m_knots.frame_camera_from_object[axis])));
    return static_cast<float>(most);
}

int OpenedMesh::material(std::uint32_t face) const {
    return m_instance->material(data().slot(face));
}

void OpenedMesh::attribute(const BasePatch& patch, const AttributeRequest& request,
                           std::span<const Vec2d> uv, std::vector<float>& values,
                           std::vector<float>& du, std::vector<float>& dv) const {
    m_shared->surface().attribute(patch, request, uv, values, du, dv);
}

Vec3d OpenedMesh::camera_normal(const Vec3f& normal_object) const {
    return m_camera_from_object_normal * Vec3d(normal_object);
}

RasterBounds OpenedMesh::bounds(std::size_t primitive) const {
    return raster_bound_of(view().projection, primitive_boxes(primitive));
}

void OpenedMesh::find_small_faces() {
    m_small = SmallFaces(*this);
}

OpenedMesh::Corners OpenedMesh::corners(const BasePatch& patch, int knot) const {
    Corners corners;
    for (int i = 0; i < 4; ++i)
        corners.p[i] = point(knot, static_cast<std::size_t>(vertex_of(patch.corner[i])));
    return corners;
}

FrameFace OpenedMesh::frame_corners(const BasePatch& patch) const {
    FrameFace face;
    const Corners at = corners(patch, m_knots.frame_knot);
    std::copy_n(at.p, 4, face.p);
    if (m_knots.frame_fraction > 0.0) {
        const Corners next = corners(patch, m_knots.frame_knot + 1);
        for (int i = 0; i < 4; ++i) face.p[i] = at_frame(at.p[i], next.p[i]);
    }
    face.orientation = frame_orientation();
    return face;
}

FrameFace OpenedMesh::small_face(const BasePatch& patch) const {
    FrameFace face = frame_face(patch);
    face.is_displaced = m_displaced;
    if (!m_displaced) return face;
    std::ranges::transform(corner_offsets(patch), face.moved, [&](const Vec3f& offset) {
        return Mat3d(m_knots.frame_camera_from_object) * Vec3d(offset);
    });
    return face;
}

std::array<Vec3f, 4> OpenedMesh::corner_offsets(const BasePatch& patch) const {
    std::array<Vec3f, 4> offsets;
    for (std::size_t i = 0; i < 4; ++i) offsets[i] = m_small.offsets()[place_of(patch.corner[i])];
    return offsets;
}

void OpenedMesh::displace(const AttributeRequest& request, const Offsets& offsets,
                          std::size_t first, std::vector<float>& values, std::vector<float>& du,
                          std::vector<float>& dv) const {
    if (!displaces(request)) return;
    const auto add = [&](const std::vector<Vec3f>& of, std::vector<float>& to) {
        for (std::size_t i = 0; i < to.size(); ++i)
            to[i] += of[first + i / 3][static_cast<int>(i % 3)];
    };
    add(offsets.offset, values);
    add(offsets.by_u, du);
    add(offsets.by_v, dv);
}

void OpenedMesh::displace(const BasePatch& patch, PatchKind kind, const AttributeRequest& request,
                          std::span<const Vec2d> uv, std::vector<float>& values,
                          std::vector<float>& du, std::vector<float>& dv) const {
    if (!displaces(request)) return;
    const std::array<Vec3f, 4> corners = corner_offsets(patch);
    Offsets offsets;
    for (const Vec2d& at : uv) {
        const CornerWeights weights(kind, at);
        offsets.offset.emplace_back(blend(corners, weights.w));
        offsets.by_u.emplace_back(blend(corners, weights.du));
        offsets.by_v.emplace_back(blend(corners, weights.dv));
    }
    displace(request, offsets, 0, values, du, dv);
}

Vec3f OpenedMesh::rise(const FrameFace& face, const CornerWeights& weights,
                       const Vec3d& flat) const {
    if (!face.is_smooth) return Vec3f(0.0f);
    const Vec3d from_eye =
        view().projection.perspective ? blend(face.p, weights.w) : Vec3d(0.0, 0.0, 1.0);
    return smooth_rise(face.p, face.normal, weights, glm::dot(flat, from_eye) < 0.0);
}

std::shared_ptr<const KnotNormals> OpenedMesh::knot_normals() const {
    if (!m_view->has_light || m_displaced) return nullptr;
    const KnotNormals* const normals = m_shared->knot_normals();
    return normals ? std::shared_ptr<const KnotNormals>(m_shared, normals) : nullptr;
}

CornerBlend OpenedMesh::normal_corners(const BasePatch& patch, const CornerWeights& weights) const {
    CornerBlend blend;
    if (!m_shared->is_smooth(patch.face)) return blend;
    std::copy_n(patch.corner, 4, blend.corner);
    std::ranges::transform(weights.w, blend.weight,
                           [](double weight) { return static_cast<float>(weight); });
    return blend;
}

std::vector<Bounds3f> OpenedMesh::primitive_boxes(std::size_t primitive) const {
    const std::size_t others = m_small.others().size();
    if (primitive >= others) {
        const std::span<const Bounds3f> boxes = m_small.boxes(primitive - others);
        return {boxes.begin(), boxes.end()};
    }
    const BasePatch& patch = m_shared->patches()[m_small.others()[primitive]];
    static const Vec2d triangle[4] = {{0, 0}, {1, 0}, {0, 1}, {0, 1}};
    static const Vec2d quad[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    return patch_boxes(*this, patch, patch.kind == PatchKind::Triangle ? triangle : quad);
}

std::unique_ptr<Primitive> OpenedMesh::primitive(std::size_t primitive) const {
    const std::size_t others = m_small.others().size();
    if (primitive < others)
        return Patch::open(shared_from_this(), m_shared->patches()[m_small.others()[primitive]]);
    const std::size_t batch = primitive - others;
    if (m_small.is_whole(batch))
        return std::make_unique<FaceBatch>(shared_from_this(), m_small.batch(batch),
                                           m_small.boxes(batch));
    return std::make_unique<PatchBatch>(shared_from_this(), m_small.batch(batch),
                                        m_small.boxes(batch));
}

std::uint64_t OpenedMesh::bytes() const {
    return sizeof(*this) + sizeof(Vec3f) * m_points.size() + m_part.bytes() + m_small.bytes();
}

}  // namespace granita
