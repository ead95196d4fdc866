// SPDX-License-Identifier: GPL-3.0-or-later
// Where a part of a lamp's rays tells the rest: of points of a grid, the first rays of each are
// traced, and where those of a point and of all around it agree that nothing is in between, or that
// nothing comes through, what is left of its samples is taken for the same.  Shadows' edges are
// few; with one point in twenty in a penumbra three quarters of all rays are spared.
//
// Where V of a lamp is seen, all n rays around a point agree by chance V^n of the times, were they
// independent, and the rest is then wrong by 1 - V: by less than 1 / (e n) where V is near 1 all
// over, and over a whole penumbra by 1 / n^2, as much too bright at one end as too dark at the
// other.  n is 324 within a grid.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
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
    /// Once all have found theirs: points are told what those around them have.
    void share() {
        const std::size_t count = m_seen.size(), wide = m_columns ? m_columns : count;
        share_along(1, wide, m_columns ? kReach : kReachInRow);
        if (m_columns) share_along(wide, count / wide, kReach);
    }
    /// What the others of a point would find.
    Answer answer(std::size_t point) const {
        const Seen& seen = m_seen[point];
        if (seen.rays < kEnough) return Answer::None;
        return seen.what == kOpen     ? Answer::Open
               : seen.what == kClosed ? Answer::Closed
                                      : Answer::None;
    }

  private:
    /// Points to each side.  Separate faces lie in Morton order.
    static constexpr std::size_t kReach = 4, kReachInRow = 32;
    /// Those at a corner of a grid.
    static constexpr std::uint32_t kEnough = 4 * (kReach + 1) * (kReach + 1);
    static constexpr std::uint32_t kOpen = 1, kClosed = 2, kOther = 4;
    struct Seen {
        std::uint32_t rays = 0, what = 0;
    };

    /// In lines of `length` points, each `step` behind the one before.
    void share_along(std::size_t step, std::size_t length, std::size_t reach) {
        std::vector<Seen> shared(m_seen.size());
        for (std::size_t i = 0; i < m_seen.size(); ++i) {
            const std::size_t at = i / step % length, first = i - step * std::min(at, reach);
            const std::size_t last = i + step * std::min(length - 1 - at, reach);
            for (std::size_t j = first; j <= last; j += step) {
                shared[i].rays += m_seen[j].rays;
                shared[i].what |= m_seen[j].what;
            }
        }
        m_seen = std::move(shared);
    }

    std::size_t m_columns;
    std::vector<Seen> m_seen;
};

}  // namespace granita
