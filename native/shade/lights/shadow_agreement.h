// SPDX-License-Identifier: GPL-3.0-or-later
// Where a part of a lamp's rays tells the rest: of points of a grid, the first rays of each are
// traced, and where those of a point and of all around it agree that nothing is in between, or that
// nothing comes through, what is left of its samples is taken for the same.  Shadows' edges are
// few; with one point in twenty in a penumbra three quarters of all rays are spared.
//
// In a penumbra that lets V through, all n rays around a point agree by chance V^n of the times,
// which is then wrong by 1 - V: on the whole by 1 / n^2, as much too bright outside of shadows as
// too dark inside.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/vec.h"

namespace granita {

class ShadowAgreement {
  public:
    enum class Answer : std::uint8_t { None, Open, Closed };

    /// Of a grid; `columns`: as ShadingPoints's.
    ShadowAgreement(std::size_t points, std::size_t columns) : m_columns(columns), m_seen(points) {}

    /// What a first ray of a point finds.
    void add(std::size_t point, const Vec3f& through) {
        Seen& seen = m_seen[point];
        ++seen.rays;
        seen.what |= through == Vec3f(1.0f) ? kOpen : through == Vec3f(0.0f) ? kClosed : kOther;
    }
    /// What the others of a point would.
    Answer answer(std::size_t point) const {
        const std::size_t wide = m_columns ? m_columns : m_seen.size();
        const std::size_t reach = m_columns ? kReach : kReachInRow;
        const std::size_t column = point % wide, row = point / wide;
        const std::size_t rows = m_columns ? m_seen.size() / wide : 1;
        Seen all;
        for (std::size_t v = row - std::min(row, reach); v < std::min(row + reach + 1, rows); ++v)
            for (std::size_t u = column - std::min(column, reach);
                 u < std::min(column + reach + 1, wide); ++u) {
                const Seen& seen = m_seen[v * wide + u];
                all.rays += seen.rays;
                all.what |= seen.what;
            }
        if (all.rays < kEnough) return Answer::None;
        return all.what == kOpen     ? Answer::Open
               : all.what == kClosed ? Answer::Closed
                                     : Answer::None;
    }

  private:
    /// Points to each side.  Separate faces lie in Morton order.
    static constexpr std::size_t kReach = 2, kReachInRow = 16;
    static constexpr std::uint32_t kEnough = 32;
    static constexpr std::uint32_t kOpen = 1, kClosed = 2, kOther = 4;
    struct Seen {
        std::uint32_t rays = 0, what = 0;
    };

    std::size_t m_columns;
    std::vector<Seen> m_seen;
};

}  // namespace granita
