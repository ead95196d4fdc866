// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "math/bounds.h"
#include "shade/bsdf/bsdf.h"
#include "shade/lights/light_node.h"

namespace granita {

/// A point as lamps light it, or neighbours together: where they are, and a bound on what their
/// lobes reflect.
class LightReceiver {
  public:
    /// `receives`: Instance::receives.
    explicit LightReceiver(std::uint64_t receives) : m_receives(receives) {}

    void clear();
    /// `reach`: where the point is over the shutter.
    void add(const Bounds3f& reach, const PointBsdf& bsdf);
    /// Once all are added.
    LightReceiverView view() const;
    std::uint64_t receives() const { return m_receives; }

  private:
    std::uint64_t m_receives;
    Bounds3f m_box;
    std::vector<LobeReach> m_lobes, m_of_point;
};

}  // namespace granita
