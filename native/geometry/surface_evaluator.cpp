// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface_evaluator.h"

#include <algorithm>
#include <atomic>

#include "base/error.h"
#include "geometry/corner_values.h"

namespace granita {
namespace {

/// Faces that a thread keeps ready.  Borders are their owner's business, so a patch asks for its
/// neighbours over and over; 128 hold the neighbours of all that is split at a time, in about a
/// megabyte.
constexpr std::size_t kSlots = 128;

std::uint64_t next_id() {
    static std::atomic<std::uint64_t> id{0};
    return ++id;
}

[[noreturn]] void fail(const SharedGeometry& geometry, int face, const char* what) {
    throw InternalError(geometry.data().name + ": face " + std::to_string(face) + " has no " +
                        what);
}

/// A place on a patch of a subdivision surface, as OpenSubdiv counts.
class LimitPlace {
  public:
    LimitPlace(const SharedGeometry& geometry, const BasePatch& patch)
        : m_patch(patch), m_coordinates(*geometry.subdivision(), static_cast<int>(patch.face)) {}
    Vec2d operator()(const Vec2d& uv) const {
        return m_coordinates.sub_face(static_cast<int>(m_patch.sub), uv);
    }
    double scale() const { return m_coordinates.sub_face_scale(); }

  private:
    const BasePatch& m_patch;
    FaceCoordinates m_coordinates;
};

}  // namespace

struct SurfaceEvaluator::FaceSlot {
    std::uint64_t id = 0;  ///< of the evaluator
    int face = -1;
    LimitFace limit;
    std::vector<std::pair<int, LimitFace>> uv_maps;
    std::vector<std::pair<AttributeSource, LimitFace>> positions;
};

SurfaceEvaluator::SurfaceEvaluator(const SharedGeometry& geometry)
    : m_geometry(&geometry),
      m_id(next_id()),
      m_knots(geometry.is_static() ? 1 : geometry.data().knots) {
    for (int k = 0; k < m_knots; ++k) m_sets.push_back(geometry.knot_points(k).data());
}

SurfaceEvaluator::FaceSlot& SurfaceEvaluator::slot(int face) const {
    thread_local std::vector<FaceSlot> slots(kSlots);
    FaceSlot& slot = slots[(static_cast<std::size_t>(face) + m_id * 31) % kSlots];
    if (slot.id != m_id || slot.face != face) {
        slot.face = -1;
        slot.uv_maps.clear();
        slot.positions.clear();
        if (!slot.limit.gather(*m_geometry->subdivision(), face, m_sets))
            fail(*m_geometry, face, "limit surface");
        slot.id = m_id;
        slot.face = face;
    }
    return slot;
}

const LimitFace& SurfaceEvaluator::limit_face(int face) const {
    return slot(face).limit;
}

const LimitFace& SurfaceEvaluator::uv_map(int face, int channel) const {
    FaceSlot& at = slot(face);
    for (const auto& [known, map] : at.uv_maps)
        if (known == channel) return map;
    LimitFace map;
    if (!map.gather_uv(*m_geometry->subdivision(), face, channel))
        fail(*m_geometry, face, "UV surface");
    return at.uv_maps.emplace_back(channel, std::move(map)).second;
}

const LimitFace& SurfaceEvaluator::positions_of(int face, AttributeSource source) const {
    FaceSlot& at = slot(face);
    for (const auto& [known, positions] : at.positions)
        if (known == source) return positions;
    LimitFace positions;
    const Vec3f* const points = m_geometry->points(source).data();
    if (!positions.gather(*m_geometry->subdivision(), face, {&points, 1}))
        fail(*m_geometry, face, "limit surface");
    return at.positions.emplace_back(source, std::move(positions)).second;
}

void SurfaceEvaluator::attribute(const BasePatch& patch, const AttributeRequest& request,
                                 std::span<const Vec2d> uv, std::vector<float>& values,
                                 std::vector<float>& du, std::vector<float>& dv) const {
    if (const SubdivisionTopology* topology = m_geometry->subdivision()) {
        const GeometryData& data = m_geometry->data();
        const Attribute* found = find_attribute(data, request);
        const int channel =
            found ? topology->uv_channel(static_cast<std::size_t>(found - data.attributes.data()))
                  : -1;
        if (channel >= 0 || is_position(request.source)) {
            limit_attribute(patch, request, channel, uv, values, du, dv);
            return;
        }
    }
    interpolate(corner_values(*m_geometry, patch, request), patch.kind, uv, request.width, values,
                du, dv);
}

void SurfaceEvaluator::limit_attribute(const BasePatch& patch, const AttributeRequest& request,
                                       int channel, std::span<const Vec2d> uv,
                                       std::vector<float>& values, std::vector<float>& du,
                                       std::vector<float>& dv) const {
    const int face = static_cast<int>(patch.face);
    const LimitFace& limit =
        channel >= 0 ? uv_map(face, channel) : positions_of(face, request.source);
    const LimitPlace place(*m_geometry, patch);
    const auto columns = static_cast<std::size_t>(limit.columns());
    const auto width = static_cast<std::size_t>(request.width);
    const std::size_t given = std::min(width, columns);
    double p[3], by_u[3], by_v[3];
    for (std::vector<float>* out : {&values, &du, &dv}) out->assign(uv.size() * width, 0.0f);
    const Bounds3f& box = m_geometry->frame_box();
    for (std::size_t i = 0; i < uv.size(); ++i) {
        limit.evaluate(place(uv[i]), p, by_u, by_v);
        if (in_box(m_geometry->data(), request.source)) {
            const Vec3d g = generated(box, {p[0], p[1], p[2]});
            for (int c = 0; c < 3; ++c) {
                const double size = static_cast<double>(box.hi[c]) - box.lo[c];
                p[c] = g[c];
                by_u[c] = size > 0.0 ? by_u[c] / size : 0.0;
                by_v[c] = size > 0.0 ? by_v[c] / size : 0.0;
            }
        }
        for (std::size_t c = 0; c < given; ++c) {
            values[i * width + c] = static_cast<float>(p[c]);
            du[i * width + c] = static_cast<float>(place.scale() * by_u[c]);
            dv[i * width + c] = static_cast<float>(place.scale() * by_v[c]);
        }
    }
}

}  // namespace granita
