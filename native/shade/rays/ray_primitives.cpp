// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_primitives.h"

#include <algorithm>
#include <numeric>

namespace granita {

template <std::size_t N>
void RayPrimitives<N>::put_still_first() {
    if (knots == 1) return;
    std::vector<bool> moves(point_count(), false);
    for (int knot = 1; knot < knots; ++knot)
        for (std::size_t v = 0; v < moves.size(); ++v)
            if (at(knot)[v] != at(0)[v]) moves[v] = true;
    std::vector<std::uint32_t> order(indices.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto moving = std::stable_partition(order.begin(), order.end(), [&](std::uint32_t k) {
        return std::ranges::none_of(indices[k], [&](std::uint32_t v) { return moves[v]; });
    });
    m_still = static_cast<std::size_t>(moving - order.begin());
    if (m_still == 0) return;
    std::vector<std::array<std::uint32_t, N>> sorted;
    sorted.reserve(order.size());
    for (const std::uint32_t k : order) sorted.push_back(indices[k]);
    indices = std::move(sorted);
    m_order = std::move(order);
}

template <std::size_t N>
std::vector<RayPart> RayPrimitives<N>::hand_over(RTCDevice device) {
    bool allocated = true;
    // Embree reads 16 bytes at the last vertex.
    constexpr std::size_t kPadding = 16 - sizeof(Vec3f);
    std::vector<RTCBuffer> buffers;
    for (int knot = 0; knot < knots && allocated; ++knot) {
        buffers.push_back(rtcNewBuffer(device, point_count() * sizeof(Vec3f) + kPadding));
        void* data = buffers.back() ? rtcGetBufferData(buffers.back()) : nullptr;
        allocated = data != nullptr;
        if (allocated) std::ranges::copy(at(knot), static_cast<Vec3f*>(data));
    }
    std::vector<RayPart> handed;
    const auto add = [&](std::size_t first, std::size_t last, int knot_count) {
        if (first == last) return;
        RTCGeometry geometry =
            rtcNewGeometry(device, N == 3 ? RTC_GEOMETRY_TYPE_TRIANGLE : RTC_GEOMETRY_TYPE_QUAD);
        handed.push_back({geometry, static_cast<std::uint32_t>(last - first), N, knot_count});
        rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(knot_count));
        for (int knot = 0; knot < knot_count; ++knot)
            rtcSetGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(knot),
                                 RTC_FORMAT_FLOAT3, buffers[static_cast<std::size_t>(knot)], 0,
                                 sizeof(Vec3f), point_count());
        void* to = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                           N == 3 ? RTC_FORMAT_UINT3 : RTC_FORMAT_UINT4,
                                           N * sizeof(std::uint32_t), last - first);
        allocated = to != nullptr;
        if (allocated)
            std::copy(indices.begin() + static_cast<std::ptrdiff_t>(first),
                      indices.begin() + static_cast<std::ptrdiff_t>(last),
                      static_cast<std::array<std::uint32_t, N>*>(to));
    };
    if (allocated) add(0, m_still, 1);
    if (allocated) add(m_still, indices.size(), knots);
    for (RTCBuffer buffer : buffers)
        if (buffer) rtcReleaseBuffer(buffer);
    std::vector<Vec3f>().swap(points);
    std::vector<std::array<std::uint32_t, N>>().swap(indices);
    if (allocated) return handed;
    for (const RayPart& part : handed) rtcReleaseGeometry(part.geometry);
    return {};
}

template struct RayPrimitives<3>;
template struct RayPrimitives<4>;

}  // namespace granita
