// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_elements.h"

#include <algorithm>
#include <cmath>

namespace granita {
namespace {

bool is_moving(const GeometryData& data) {
    const std::size_t n = data.vertex_count();
    const auto differs = [n](const auto& values) {
        for (std::size_t i = n; i < values.size(); ++i)
            if (values[i] != values[i - n]) return true;
        return false;
    };
    return differs(data.points) || differs(data.radius);
}

}  // namespace

RayElements::RayElements(const GeometryData& data, float frame_time, bool located)
    : m_data(&data), m_knots(is_moving(data) ? data.knots : 1) {
    if (located) m_shared = std::make_unique<SharedElements>(data, frame_time, m_report);
    for (const Vec3f& p : data.points)
        if (is_finite(p))
            m_extent = std::max({m_extent, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    for (std::uint32_t c = 0; c < data.curve_sizes.size(); ++c) {
        if (data.curve_sizes[c] < 2) continue;
        m_curves.push_back(c);
        m_first_segment.push_back(m_segments);
        m_segments += static_cast<std::uint32_t>(data.curve_sizes[c]) - 1;
    }
}

std::string RayElements::size() const {
    return m_data->kind == GeometryKind::Curves
               ? std::to_string(m_segments) + " segments of curves"
               : std::to_string(m_data->vertex_count()) + " points";
}

void RayElements::write(int knot, std::size_t vertex, float* out) const {
    const std::size_t n = m_data->vertex_count();
    const std::size_t at = static_cast<std::size_t>(knot) * n + vertex;
    const Vec3f& p = m_data->points[at];
    const float radius = m_data->radius[m_data->radius.size() == n ? vertex : at];
    std::copy_n(&p.x, 3, out);
    out[3] = std::max(radius, 0.0f);
}

/// With the first and the last point of each curve repeated, as dicing does (catmull_rom.h).
void RayElements::fill_curves(int knot, float* out) const {
    std::size_t first = 0;
    for (const std::int32_t size : m_data->curve_sizes) {
        const auto last = first + static_cast<std::size_t>(size) - 1;
        if (size >= 2) {
            write(knot, first, out);
            for (std::size_t v = first; v <= last; ++v) write(knot, v, out += 4);
            write(knot, last, out += 4);
            out += 4;
        }
        first = last + 1;
    }
}

std::vector<RayPart> RayElements::hand_over(RTCDevice device) {
    const bool curves = m_data->kind == GeometryKind::Curves;
    const std::size_t count = curves ? m_segments + 3 * m_curves.size() : m_data->vertex_count();
    RTCGeometry geometry = rtcNewGeometry(
        device, curves ? RTC_GEOMETRY_TYPE_FLAT_CATMULL_ROM_CURVE : RTC_GEOMETRY_TYPE_SPHERE_POINT);
    rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(m_knots));
    bool allocated = true;
    for (int knot = 0; knot < m_knots && allocated; ++knot) {
        auto* vertices = static_cast<float*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(knot),
                                    RTC_FORMAT_FLOAT4, 4 * sizeof(float), count));
        allocated = vertices != nullptr;
        if (!allocated) break;
        if (curves)
            fill_curves(knot, vertices);
        else
            for (std::size_t v = 0; v < count; ++v) write(knot, v, vertices + 4 * v);
    }
    if (allocated && curves) {
        auto* index = static_cast<std::uint32_t*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT,
                                    sizeof(std::uint32_t), m_segments));
        allocated = index != nullptr;
        std::uint32_t first = 0;
        for (std::size_t c = 0; c < m_curves.size() && allocated; ++c) {
            const auto segments = static_cast<std::uint32_t>(m_data->curve_sizes[m_curves[c]]) - 1;
            for (std::uint32_t s = 0; s < segments; ++s) *index++ = first + s;
            first += segments + 3;
        }
    }
    if (allocated) return {{geometry}};
    rtcReleaseGeometry(geometry);
    return {};
}

void RayElements::locate(std::uint32_t, std::uint32_t primitive, float u, float v,
                         RayHit& hit) const {
    hit.elements = m_shared.get();
    if (m_curves.empty()) {
        hit.place = {primitive, primitive, primitive, 0.0};
        hit.slot = m_shared->slot(primitive);
        return;
    }
    const auto after = std::upper_bound(m_first_segment.begin(), m_first_segment.end(), primitive);
    const auto c = static_cast<std::size_t>(after - m_first_segment.begin()) - 1;
    const std::uint32_t curve = m_curves[c];
    const std::size_t point = m_shared->first_point(curve) + primitive - m_first_segment[c];
    hit.place = {curve, point, point + 1, u};
    hit.uv = {u, v};
    hit.slot = m_shared->slot(curve);
}

std::size_t RayElements::bytes() const {
    return sizeof(*this) + 4 * (m_curves.size() + m_first_segment.size()) +
           (m_shared ? m_shared->bytes() : 0);
}

}  // namespace granita
