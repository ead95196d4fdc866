// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/luminance.h"
#include "math/vec.h"

namespace granita {

/// How points see a lamp that is small from where they are: its shadows are as sharp as what casts
/// them, and as thin.
class LampSight {
  public:
    explicit LampSight(std::uint32_t l) : lamp(l) {}

    std::uint32_t lamp;  ///< of LampSet
    /// [points] what is let through of what its samples send there, if that is alike for all; less
    /// than 0 where it is not, and where none arrives.  Empty: nowhere.
    std::vector<float> through;
    std::vector<Vec3f> light;  ///< [points] reflected, were nothing in between

    /// A sample of one of `count` points.
    void add(std::size_t point, std::size_t count, const Vec3f& reflected, const Vec3f& seen) {
        if (m_is_wide) return;
        if (through.empty()) {
            through.resize(count, kNone);
            light.resize(count, Vec3f(0.0f));
        }
        const float now = luminance(seen);
        float& before = through[point];
        if (before == kNone)
            before = now;
        else if (!(std::abs(now - before) < kAlike))
            before = kDiffers;
        light[point] += reflected;
    }
    /// Whether some of a point's samples meet what others do not: a shadow's edge is there, at some
    /// time.
    bool differs(std::size_t point) const { return through[point] == kDiffers; }
    /// Too wide at some point, and so no lamp of these.
    void is_wide() { m_is_wide = true; }
    bool is_told() const { return !m_is_wide && !through.empty(); }

  private:
    static constexpr float kNone = -1.0f, kDiffers = -2.0f, kAlike = 0.05f;

    bool m_is_wide = false;
};

}  // namespace granita
