// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "math/vec.h"
#include "scene/lifespan.h"

namespace granita {

/// Uniform numbers -> shutter times with the density of the shutter's opening: the inverse of the
/// opening's integral, so that every sample has the same weight.
class ShutterWarp {
  public:
    /// `opening`: relative opening at equidistant times of [0, 1], linear in between; empty or
    /// without area means a box.  Negative values count as 0.
    explicit ShutterWarp(const std::vector<float>& opening);
    bool is_box() const { return m_time.empty(); }
    float time(float uniform) const {
        if (m_time.empty()) return uniform;
        const float place = uniform * kCells;
        const int cell = place < kCells ? static_cast<int>(place) : kCells - 1;
        return m_time[cell] +
               (place - static_cast<float>(cell)) * (m_time[cell + 1] - m_time[cell]);
    }

    /// The number that time() turns into this one of [0, 1].
    float uniform(float time) const;
    /// The part of the shutter's light, from and to, for which something is there.
    Vec2f exposed(const Lifespan& life) const {
        return {uniform(std::clamp(life.open, 0.0f, 1.0f)),
                uniform(std::clamp(life.close, 0.0f, 1.0f))};
    }

  private:
    static constexpr int kCells = 4096;
    std::vector<float> m_time;  ///< [kCells + 1]
};

}  // namespace granita
