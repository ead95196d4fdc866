// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "shade/lights/light_source.h"

namespace granita {

/// What a lamp's nodes make of its light, by the direction in which it leaves: a table over the
/// lamp's own directions, from straight ahead (-z) to straight behind.
class LightPattern {
  public:
    /// Of its entries, unit.
    static std::vector<Vec3f> directions();
    /// `values`: in these.
    explicit LightPattern(std::vector<Vec3f> values);

    Vec3f at(const Vec3f& direction) const;
    /// Mean of the channels, where that is largest.
    float largest() const { return m_largest; }

  private:
    std::vector<Vec3f> m_values;  ///< [rows][columns]
    float m_largest = 0.0f;
};

/// Of the nodes of a scene's lights: [lights], nullptr where there are none; empty: nowhere.
using LightPatterns = std::vector<std::shared_ptr<const LightPattern>>;

/// A lamp whose light is that of `source` times a pattern.  `axes`: as LightFrame::axes.
std::unique_ptr<LightSource> with_pattern(std::unique_ptr<LightSource> source,
                                          std::shared_ptr<const LightPattern> pattern,
                                          const Mat3d& axes);

}  // namespace granita
