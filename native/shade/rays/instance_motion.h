// SPDX-License-Identifier: GPL-3.0-or-later
// What moving casters sweep within the shutter, as a few boxes in shading space.
#pragma once

#include <vector>

#include "math/bounds.h"

namespace granita {

class InstanceMotion {
  public:
    bool empty() const { return m_boxes.empty(); }
    /// A caster's box in its own space, and the knots that take it to shading space.  Points move
    /// in straight lines between knots: the boxes at the knots hold all of their way.
    void add(const Bounds3f& box, const std::vector<Mat4d>& knots);
    /// Whether a segment (unit direction, metres, may be infinite) comes near any of them.
    bool meet(const Vec3f& start, const Vec3f& direction, float distance) const;

  private:
    std::vector<Bounds3f> m_boxes;
};

}  // namespace granita
