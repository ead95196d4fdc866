// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/shared_geometry.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/knot_normals.h"
#include "geometry/limit_vertices.h"
#include "geometry/patch_borders.h"
#include "geometry/polygon_patches.h"
#include "geometry/subdivision_topology.h"
#include "geometry/surface_evaluator.h"
#include "geometry/vertex_normals.h"

namespace granita {
namespace {

std::string counted(std::size_t n, const char* what) {
    return std::to_string(n) + (n == 1 ? " face " : " faces ") + what;
}

}  // namespace

SharedGeometry::SharedGeometry(const GeometryData& data, float frame_time, Report& report)
    : m_data(&data) {
    m_first_corner.reserve(data.face_count());
    std::uint32_t first = 0;
    for (const std::int32_t size : data.face_sizes) {
        m_first_corner.push_back(first);
        first += static_cast<std::uint32_t>(size);
    }
    find_frame_points(frame_time);

    if (data.is_subdivision && data.face_count() > 0) {
        std::string why;
        m_subdivision = SubdivisionTopology::create(data, why);
        if (!m_subdivision)
            report.warn(data.name, "cannot be subdivided, its cage is rendered: " + why);
    }
    const std::vector<std::uint8_t> usable = usable_faces();
    std::size_t unusable = 0;
    PolygonPatches polygons(data, m_first_corner, m_frame_points);
    m_patches.reserve(data.face_count());
    for (std::uint32_t face = 0; face < data.face_count(); ++face) {
        m_first_patch.push_back(static_cast<std::uint32_t>(m_patches.size()));
        if (!usable[face]) {
            ++unusable;
            polygons.skip(face);
        } else if (m_subdivision) {
            add_subdivided(face);
        } else {
            polygons.add(face, m_patches);
        }
    }
    if (m_subdivision) m_subdivision->find_owners(usable);
    if (unusable) report.warn(data.name, counted(unusable, "with non-finite vertices left out"));
    if (polygons.crossed())
        report.warn(data.name, counted(polygons.crossed(), "crossing themselves, filled as a fan"));

    find_normals();
    m_surface = std::make_unique<SurfaceEvaluator>(*this);
}

SharedGeometry::~SharedGeometry() = default;

void SharedGeometry::find_frame_points(float frame_time) {
    const std::size_t n = m_data->vertex_count();
    const std::span<const Vec3f> points(m_data->points);
    for (int k = 1; k < m_data->knots && m_static; ++k)
        m_static = std::equal(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(n),
                              points.begin() + static_cast<std::ptrdiff_t>(n) * k);
    if (!m_static) m_frame = knot_time(static_cast<double>(frame_time), m_data->knots);
    const auto [knot, fraction] = m_frame;
    if (fraction == 0.0) {
        m_frame_points = points.subspan(knot * n, n);
    } else {
        m_interpolated.resize(n);
        for (std::size_t v = 0; v < n; ++v)
            m_interpolated[v] = Vec3f(Vec3d(points[knot * n + v]) * (1.0 - fraction) +
                                      Vec3d(points[(knot + 1) * n + v]) * fraction);
        m_frame_points = m_interpolated;
    }
    for (const Vec3f& p : m_frame_points)
        if (is_finite(p)) m_frame_box.add(p);
}

void SharedGeometry::find_normals() {
    if (m_subdivision) {
        m_limit = std::make_unique<LimitVertices>(limit_vertices(*this));
        return;
    }
    const bool smooth = std::ranges::any_of(m_data->smooth, [](std::uint8_t s) { return s != 0; });
    if (smooth && m_data->corner_normals.empty())
        m_vertex_normals = granita::vertex_normals(*m_data, m_frame_points);
}

std::uint32_t SharedGeometry::face_of(std::uint32_t corner) const {
    const auto after = std::ranges::upper_bound(m_first_corner, corner);
    return static_cast<std::uint32_t>(after - m_first_corner.begin()) - 1;
}

const PatchBorders& SharedGeometry::borders() const {
    m_borders_once.call([this] { m_borders = std::make_unique<PatchBorders>(*this); });
    return *m_borders;
}

const KnotNormals* SharedGeometry::knot_normals() const {
    if (m_static || m_subdivision || (m_vertex_normals.empty() && m_data->corner_normals.empty()))
        return nullptr;
    m_knot_normals_once.call([this] { m_knot_normals = std::make_unique<KnotNormals>(*this); });
    return m_knot_normals.get();
}

std::span<const Vec3f> SharedGeometry::knot_points(int knot) const {
    const std::size_t n = m_data->vertex_count();
    return std::span(m_data->points).subspan(static_cast<std::size_t>(knot) * n, n);
}

std::span<const Vec3f> SharedGeometry::surface_points(int knot) const {
    if (!m_limit) return knot_points(knot);
    const std::size_t n = m_data->vertex_count();
    return std::span(m_limit->points).subspan(m_static ? 0 : static_cast<std::size_t>(knot) * n, n);
}

std::span<const Vec3f> SharedGeometry::points(AttributeSource source) const {
    if (source == AttributeSource::Generated && !m_data->generated.empty())
        return m_data->generated;
    const std::span<const Vec3f> other = neighbour_points(*m_data, source);
    return other.empty() ? m_frame_points : other;
}

std::vector<std::uint8_t> SharedGeometry::usable_faces() const {
    std::vector<std::uint8_t> usable(m_data->face_count(), 1);
    const std::size_t n = m_data->vertex_count();
    std::vector<std::uint8_t> bad(n, 0);
    bool any = false;
    for (std::size_t i = 0; i < m_data->points.size(); ++i)
        if (!is_finite(m_data->points[i])) bad[i % n] = 1, any = true;
    if (!any) return usable;
    const auto spread = [&] {
        for (std::size_t face = 0; face < usable.size(); ++face)
            for (int i = 0; i < m_data->face_sizes[face]; ++i)
                if (bad[static_cast<std::size_t>(
                        m_data->corner_verts[m_first_corner[face] + static_cast<unsigned>(i)])])
                    usable[face] = 0;
    };
    spread();
    if (!m_subdivision) return usable;
    // A limit face depends on every vertex of every face that touches it.
    for (std::size_t face = 0; face < usable.size(); ++face)
        if (!usable[face])
            for (int i = 0; i < m_data->face_sizes[face]; ++i)
                bad[static_cast<std::size_t>(
                    m_data->corner_verts[m_first_corner[face] + static_cast<unsigned>(i)])] = 1;
    spread();
    return usable;
}

void SharedGeometry::add_subdivided(std::uint32_t face) {
    const std::uint32_t first = m_first_corner[face];
    const std::uint32_t n = static_cast<std::uint32_t>(m_data->face_sizes[face]);
    BasePatch patch;
    patch.face = face;
    if (n == 4) {
        for (std::uint32_t i = 0; i < 4; ++i) patch.corner[i] = first + i;
        m_patches.push_back(patch);
        return;
    }
    patch.kind = PatchKind::SubFace;
    patch.whole_face = false;
    for (patch.sub = 0; patch.sub < n; ++patch.sub) {
        patch.corner[0] = first + patch.sub;
        m_patches.push_back(patch);
    }
}

std::uint64_t SharedGeometry::bytes() const {
    std::uint64_t limit = 0;
    if (m_limit)
        limit = sizeof(Vec3f) * (m_limit->points.size() + m_limit->normals.size()) +
                4 * m_limit->heights.size();
    return sizeof(*this) + 4 * (m_first_corner.size() + m_first_patch.size()) +
           sizeof(BasePatch) * m_patches.size() +
           sizeof(Vec3f) * (m_interpolated.size() + m_vertex_normals.size()) + limit +
           (m_subdivision ? m_subdivision->bytes() : 0);
}

}  // namespace granita
