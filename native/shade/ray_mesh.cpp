// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/ray_mesh.h"

#include <opensubdiv/bfr/surface.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/subdivision_topology.h"

namespace granita {
namespace {

namespace Bfr = OpenSubdiv::Bfr;

/// Cells a side of a patch, so that no geometry takes more than some ten million points over all
/// its knots.
int cells_a_side(std::size_t patches) {
    if (patches <= 40'000) return 8;
    return patches <= 400'000 ? 4 : 2;
}

/// How far a face with this offset from a triangle's plane may stand off the triangle, along the
/// face's own normal. Only what leaves the plane counts: a flat trapezoid's patch is not linear in
/// its parameters, but lies in its triangles all the same.
float height_off(const Vec3f& offset, const Vec3f& triangle, const Vec3f& face) {
    const float area = glm::length(triangle);
    if (!(area > 0.0f)) return 0.0f;  // no triangle for a ray to hit
    const float cosine = std::abs(glm::dot(triangle, face)) / glm::length(face);
    return std::min(glm::length(offset), std::abs(glm::dot(offset, triangle)) / cosine);
}

/// The same of a quad cut from a to c: the larger of its two triangles'. Normals of any length.
float height_off(const Vec3f& offset, const Vec3f& a, const Vec3f& b, const Vec3f& c,
                 const Vec3f& d) {
    const Vec3f face = glm::cross(c - a, d - b);
    return std::max(height_off(offset, glm::cross(b - a, c - a), face),
                    height_off(offset, glm::cross(c - a, d - a), face));
}

/// 0 where p is not finite: rays meet nothing there.
float largest_coordinate(const Vec3f& p) {
    return is_finite(p) ? std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) : 0.0f;
}

Report& no_report() {
    // What cannot be diced is reported by dicing, which reads the same data.
    static Report report;
    return report;
}

}  // namespace

RayMesh::RayMesh(const GeometryData& data, float frame_time, const Progress& progress)
    : m_shared(data, frame_time, no_report()), m_knots(m_shared.is_static() ? 1 : data.knots) {
    if (m_shared.subdivision() != nullptr)
        add_limit_surface(progress);
    else
        add_polygons();
    if (m_knots > 1) put_still_first();
    for (const Vec3f& p : m_points) m_extent = std::max(m_extent, largest_coordinate(p));
}

std::span<const Vec3f> RayMesh::vertices(int knot) const {
    if (m_knots == 1) return m_shared.frame_points();
    const GeometryData& data = m_shared.data();
    return std::span(data.points)
        .subspan(static_cast<std::size_t>(knot) * data.vertex_count(), data.vertex_count());
}

void RayMesh::add_polygons() {
    const GeometryData& data = m_shared.data();
    const auto& patches = m_shared.patches();
    for (int knot = 0; knot < m_knots; ++knot)
        m_points.insert(m_points.end(), vertices(knot).begin(), vertices(knot).end());
    m_triangles.reserve(2 * patches.size());
    m_patches.reserve(2 * patches.size());
    m_extents.assign(data.face_count(), 0.0f);
    for (std::uint32_t k = 0; k < patches.size(); ++k) {
        const BasePatch& patch = patches[k];
        std::array<std::uint32_t, 4> v;
        for (std::size_t i = 0; i < 4; ++i)
            v[i] = static_cast<std::uint32_t>(data.corner_verts[patch.corner[i]]);
        float& extent = m_extents[patch.face];
        for (int knot = 0; knot < m_knots; ++knot)
            for (const std::uint32_t vertex : v)
                extent = std::max(extent, largest_coordinate(points(knot)[vertex]));
        m_triangles.push_back({v[0], v[1], v[2]});
        m_patches.push_back(2 * k);
        if (patch.kind != PatchKind::Quad) continue;
        m_triangles.push_back({v[0], v[2], v[3]});
        m_patches.push_back(2 * k + 1);
        for (int knot = 0; knot < m_knots; ++knot) {
            const auto at = points(knot);
            const Vec3f twist = at[v[0]] - at[v[1]] + at[v[2]] - at[v[3]];
            const float error = 0.25f * height_off(twist, at[v[0]], at[v[1]], at[v[2]], at[v[3]]);
            // Rounding alone twists a flat quad: that is the business of extent().
            if (error <= 1e-6f * glm::length(at[v[0]] - at[v[2]])) continue;
            if (m_errors.empty()) m_errors.assign(data.face_count(), 0.0f);
            m_errors[patch.face] = std::max(m_errors[patch.face], error);
        }
    }
}

void RayMesh::add_limit_surface(const Progress& progress) {
    const auto& patches = m_shared.patches();
    const int side = m_side = cells_a_side(patches.size() * static_cast<std::size_t>(m_knots));
    const auto line = static_cast<std::size_t>(side) + 1;
    const auto cells = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    m_points.resize(static_cast<std::size_t>(m_knots) * patches.size() * line * line);
    m_triangles.resize(patches.size() * 2 * cells);
    std::vector<float> errors(patches.size(), 0.0f);
    const auto& factory = m_shared.subdivision()->factory();

    const auto evaluate = [&](std::size_t k, int knot) {
        const BasePatch& patch = patches[k];
        const auto* cage = reinterpret_cast<const float*>(vertices(knot).data());
        Vec3f* points =
            m_points.data() + (static_cast<std::size_t>(knot) * patches.size() + k) * line * line;
        Bfr::Surface<float> surface;
        if (!factory.InitVertexSurface(static_cast<int>(patch.face), &surface)) {
            std::fill_n(points, line * line, Vec3f(std::nanf("")));  // a hole: Embree skips it
            return;
        }
        std::vector<float> control(static_cast<std::size_t>(surface.GetNumPatchPoints()) * 3);
        surface.PreparePatchPoints(cage, 3, control.data(), 3);
        for (std::size_t j = 0; j < line; ++j)
            for (std::size_t i = 0; i < line; ++i) {
                float st[2] = {static_cast<float>(i) / static_cast<float>(side),
                               static_cast<float>(j) / static_cast<float>(side)};
                float uv[2] = {st[0], st[1]};
                if (patch.kind == PatchKind::SubFace)
                    surface.GetParameterization().ConvertNormalizedSubFaceToCoord(
                        static_cast<int>(patch.sub), st, uv);
                surface.Evaluate(uv, control.data(), 3, &points[j * line + i].x);
            }
        // A chord misses a curve by an eighth of its second difference, a cell's diagonal by a
        // quarter of its twist. At the patch's border the nearest second difference inside stands.
        const auto at = [&](std::size_t i, std::size_t j) { return points[j * line + i]; };
        const auto inside = [&](std::size_t i) { return std::clamp<std::size_t>(i, 1, line - 2); };
        const auto bend_u = [&](std::size_t i, std::size_t j) {
            i = inside(i);
            return at(i - 1, j) - 2.0f * at(i, j) + at(i + 1, j);
        };
        const auto bend_v = [&](std::size_t i, std::size_t j) {
            j = inside(j);
            return at(i, j - 1) - 2.0f * at(i, j) + at(i, j + 1);
        };
        for (std::size_t j = 0; j + 1 < line; ++j)
            for (std::size_t i = 0; i + 1 < line; ++i) {
                const Vec3f a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
                const float bent_u = height_off(bend_u(i, j), a, b, c, d);
                const float bent_v = height_off(bend_v(i, j), a, b, c, d);
                const float twist = height_off(a - b + c - d, a, b, c, d);
                errors[k] = std::max(errors[k], 0.125f * (bent_u + bent_v) + 0.25f * twist);
            }
        if (knot > 0) return;
        auto* triangles = m_triangles.data() + k * 2 * cells;
        for (std::size_t j = 0; j + 1 < line; ++j)
            for (std::size_t i = 0; i + 1 < line; ++i) {
                const auto v = static_cast<std::uint32_t>(k * line * line + j * line + i);
                const auto above = v + static_cast<std::uint32_t>(line);
                *triangles++ = {v, v + 1, above + 1};
                *triangles++ = {v, above + 1, above};
            }
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, patches.size(), 256),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          progress.check();
                          for (std::size_t k = range.begin(); k != range.end(); ++k)
                              for (int knot = 0; knot < m_knots; ++knot) evaluate(k, knot);
                      });
    m_errors.assign(m_shared.data().face_count(), 0.0f);
    for (std::size_t k = 0; k < patches.size(); ++k)
        m_errors[patches[k].face] = std::max(m_errors[patches[k].face], errors[k]);
}

void RayMesh::put_still_first() {
    std::vector<bool> moves(point_count(), false);
    for (int knot = 1; knot < m_knots; ++knot)
        for (std::size_t v = 0; v < moves.size(); ++v)
            if (points(knot)[v] != points(0)[v]) moves[v] = true;
    std::vector<std::uint32_t> order(m_triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto moving = std::stable_partition(order.begin(), order.end(), [&](std::uint32_t k) {
        return std::ranges::none_of(m_triangles[k], [&](std::uint32_t v) { return moves[v]; });
    });
    m_still = static_cast<std::size_t>(moving - order.begin());
    if (m_still == 0) return;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    triangles.reserve(order.size());
    for (const std::uint32_t k : order) triangles.push_back(m_triangles[k]);
    m_triangles = std::move(triangles);
    m_order = std::move(order);
}

std::vector<RTCGeometry> RayMesh::hand_over(RTCDevice device) {
    bool allocated = true;
    // Embree reads 16 bytes at the last vertex.
    constexpr std::size_t kPadding = 16 - sizeof(Vec3f);
    std::vector<RTCBuffer> knots;
    for (int knot = 0; knot < m_knots && allocated; ++knot) {
        knots.push_back(rtcNewBuffer(device, point_count() * sizeof(Vec3f) + kPadding));
        void* data = knots.back() ? rtcGetBufferData(knots.back()) : nullptr;
        allocated = data != nullptr;
        if (allocated) std::ranges::copy(points(knot), static_cast<Vec3f*>(data));
    }
    std::vector<RTCGeometry> handed;
    const auto add = [&](std::size_t first, std::size_t last, int knot_count) {
        if (first == last) return;
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        handed.push_back(geometry);
        rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(knot_count));
        for (int knot = 0; knot < knot_count; ++knot)
            rtcSetGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(knot),
                                 RTC_FORMAT_FLOAT3, knots[static_cast<std::size_t>(knot)], 0,
                                 sizeof(Vec3f), point_count());
        void* indices =
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(std::uint32_t), last - first);
        allocated = indices != nullptr;
        if (allocated)
            std::copy(m_triangles.begin() + static_cast<std::ptrdiff_t>(first),
                      m_triangles.begin() + static_cast<std::ptrdiff_t>(last),
                      static_cast<std::array<std::uint32_t, 3>*>(indices));
    };
    if (allocated) add(0, m_still, 1);
    if (allocated) add(m_still, m_triangles.size(), m_knots);
    for (RTCBuffer buffer : knots)
        if (buffer) rtcReleaseBuffer(buffer);
    std::vector<Vec3f>().swap(m_points);
    std::vector<std::array<std::uint32_t, 3>>().swap(m_triangles);
    if (allocated) return handed;
    for (RTCGeometry geometry : handed) rtcReleaseGeometry(geometry);
    return {};
}

std::string RayMesh::size() const {
    return std::to_string(m_triangles.size()) + " triangles";
}

float RayMesh::extent(std::uint32_t face) const {
    return face < m_extents.size() ? m_extents[face] : m_extent;
}

float RayMesh::error(std::uint32_t face) const {
    return face < m_errors.size() ? m_errors[face] : 0.0f;
}

void RayMesh::locate(std::uint32_t part, std::uint32_t triangle, float u, float v,
                     ShadowHit& hit) const {
    if (!m_order.empty()) triangle = m_order[part == 0 ? triangle : m_still + triangle];
    hit.geometry = &m_shared;
    const GeometryData& data = m_shared.data();
    const auto& patches = m_shared.patches();
    const auto cells = static_cast<std::uint32_t>(m_side * m_side);
    const bool polygons = !m_patches.empty();
    const std::uint32_t half = (polygons ? m_patches[triangle] : triangle) & 1u;
    hit.patch = &patches[polygons ? m_patches[triangle] / 2 : triangle / (2 * cells)];
    hit.slot = data.material_index.empty() ? 0 : data.material_index[hit.patch->face];
    if (hit.patch->kind == PatchKind::Triangle) {
        hit.uv = {u, v};
        return;
    }
    // Triangles (0, 1, 2) and (0, 2, 3) of a cell, corner 0 at its origin.
    const Vec2d in_cell = half ? Vec2d(u, u + v) : Vec2d(u + v, v);
    const std::uint32_t cell = polygons ? 0 : triangle % (2 * cells) / 2;
    const auto side = static_cast<std::uint32_t>(m_side);
    hit.uv = (Vec2d(cell % side, cell / side) + in_cell) / static_cast<double>(m_side);
}

std::size_t RayMesh::bytes() const {
    return m_points.size() * sizeof(Vec3f) + m_triangles.size() * sizeof(m_triangles[0]) +
           (m_patches.size() + m_errors.size() + m_order.size()) * 4 + m_shared.bytes() +
           m_extents.size() * sizeof(float);
}

}  // namespace granita
