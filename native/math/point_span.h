// SPDX-License-Identifier: GPL-3.0-or-later
// Questions about many points at once, a vector of coordinates at a time.
#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "math/bounds.h"

namespace granita {

inline bool are_finite(std::span<const Vec3f> points) {
    constexpr std::uint32_t kExponent = 0x7f800000u;  // all ones: infinite or not a number
    std::uint32_t broken = 0;
    for (const Vec3f& p : points)
        for (int c = 0; c < 3; ++c)
            broken |= (std::bit_cast<std::uint32_t>(p[c]) & kExponent) == kExponent;
    return broken == 0;
}

/// Of points that are finite.
inline Bounds3f bounds_of(std::span<const Vec3f> points) {
    // Coordinate i of every fourth point: 12 are whole vectors, and each comes back to its lane.
    constexpr std::size_t kPoints = 4, kLanes = 3 * kPoints;
    Bounds3f box;
    float lo[kLanes], hi[kLanes];
    for (std::size_t i = 0; i < kLanes; ++i) lo[i] = box.lo.x, hi[i] = box.hi.x;
    std::size_t done = 0;
    for (; done + kPoints <= points.size(); done += kPoints) {
        const float* const from = &points[done].x;
        for (std::size_t i = 0; i < kLanes; ++i) {
            lo[i] = from[i] < lo[i] ? from[i] : lo[i];
            hi[i] = from[i] > hi[i] ? from[i] : hi[i];
        }
    }
    for (std::size_t i = 0; i < kLanes; i += 3) {
        box.lo = glm::min(box.lo, Vec3f(lo[i], lo[i + 1], lo[i + 2]));
        box.hi = glm::max(box.hi, Vec3f(hi[i], hi[i + 1], hi[i + 2]));
    }
    for (; done < points.size(); ++done) box.add(points[done]);
    return box;
}

}  // namespace granita
