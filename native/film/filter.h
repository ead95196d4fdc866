// SPDX-License-Identifier: GPL-3.0-or-later
// Separable pixel filters of any width.
#pragma once

#include "scene/options.h"

namespace granita {

/// f(x) f(y), each of unit integral.  BOX, GAUSSIAN and BLACKMAN_HARRIS take Cycles' width; of the
/// others `width` is the whole support in pixels (design, section 3).
class PixelFilter {
  public:
    PixelFilter(FilterKind kind, float width);
    /// Half the support, pixels.
    float radius() const { return m_radius; }
    /// 1-D factor at distance d pixels from the centre; 0 outside the support.
    float evaluate(float d) const;
    /// E(d): integral of the factor from -infinity to d.  Closed form or dense quadrature in
    /// double; for tests and strobing rules.
    double edge_response(double d) const;

  private:
    FilterKind m_kind;
    float m_width, m_radius, m_scale;
};

}  // namespace granita
