// SPDX-License-Identifier: GPL-3.0-or-later
// Separable pixel filters of any width.
#pragma once

#include "scene/options.h"

namespace granita {

/// f(x) f(y), each factor of unit integral.
///
/// BOX, GAUSSIAN and BLACKMAN_HARRIS mean with the same width what they mean in Cycles: BOX is as
/// wide; GAUSSIAN is exp(-8 x^2 / w^2) cut at 1.5 w; BLACKMAN_HARRIS reaches w to either side.  Of
/// the others `width` is the whole support in pixels, and the natural widths 2
/// (TENT), 4 (MITCHELL with B = C = 1/3, CATMULL_ROM, BSPLINE) and 6 (LANCZOS, three lobes) give
/// the classical filters.
class PixelFilter {
  public:
    /// Throws SceneError unless width is finite and positive.
    PixelFilter(FilterKind kind, float width);
    /// Half the support, pixels.
    float radius() const { return m_radius; }
    /// 1-D factor at distance d pixels from the centre; 0 outside the support.  A BOX holds its
    /// left end and not its right one, so that every sample belongs to one box.
    float evaluate(float d) const;
    /// The same unrounded, for |d| up to the radius, its end included.
    double value(double d) const { return m_scale * shape(d); }
    /// E(d): integral of the factor from -infinity to d, by Simpson's rule in double.
    double edge_response(double d) const;
    bool is_box() const { return m_kind == FilterKind::Box; }

  private:
    double shape(double d) const;  ///< before normalisation

    FilterKind m_kind;
    float m_width, m_radius, m_scale;
};

}  // namespace granita
