// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "math/projection.h"

namespace granita {

/// A lens that opens, closes or focuses elsewhere within the shutter: radius and focus distance at
/// equidistant knots, each straight in between.
///
/// Only samples know it.  A lens point (u, v) at the time t shifts what lies at depth z by u R(t)
/// (z / F(t) - 1): u R(t) / R_widest is a point of the widest lens, and 1 / F(t) one more
/// coordinate of the sample.  So knots of the lens multiply no knots of geometry, and the shift is
/// exact where both move.
class LensKnots {
  public:
    LensKnots() = default;  ///< still: Projection has it
    /// `knots`: (radius, focus distance) [K], metres, K > 0, radii at least 0 and distances above.
    /// Sets the lens of `projection` to what they span; knots that are all the same are a still
    /// lens.
    LensKnots(const std::vector<Vec2d>& knots, Projection& projection);

    bool moves() const { return !m_knots.empty(); }
    bool refocuses() const { return m_least_inverse < m_most_inverse; }
    /// Radius at the shutter's time t in [0, 1], as a part of the widest.
    float opening(float t) const { return static_cast<float>(at(t).x / m_widest); }
    /// 1 / focus distance at the time t, never outside what Projection's range says.
    float inverse_focus(float t) const;
    bool operator==(const LensKnots&) const = default;

  private:
    Vec2d at(float t) const;

    std::vector<Vec2d> m_knots;
    double m_widest = 1.0;
    float m_least_inverse = 0.0f, m_most_inverse = 0.0f;
};

}  // namespace granita
