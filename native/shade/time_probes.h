// SPDX-License-Identifier: GPL-3.0-or-later
// Points of a grid at which it is asked whether anything changes within the shutter.
#pragma once

#include <span>
#include <vector>

#include "shade/lights/lamp_sight.h"
#include "shade/refined_points.h"

namespace granita {

/// One micropolygon of `step`, or three of few, at several times each.  Where the frame time is not
/// in the middle of the shutter, so that what changes evenly does not cancel, also as corners are
/// lit: at the frame's place, over all of the shutter.
class TimeProbes {
  public:
    /// Micropolygons for each one that is asked: for light, which costs rays, and for what is told
    /// without.
    static constexpr int kOfLight = 29, kOfLooks = 3;

    TimeProbes(const Grid& grid, float frame_time, int step = kOfLight);
    /// The same of some where a shadow's edge comes by, as corners have seen: those that are asked
    /// blindly meet an edge in few of them by chance.
    TimeProbes(const Grid& grid, std::span<const LampSight> sights);

    std::vector<RefinedPoint> points;

    /// Whether any of the values at the points differs by more than the threshold from when the
    /// shutter opens, or their mean over it by an eighth of that from what corners have.
    bool any_changes(const std::vector<Vec3f>& values, float threshold,
                     float (*difference)(const Vec3f&, const Vec3f&)) const;

  private:
    void ask(const Grid& grid, int micropolygon);

    bool m_asks_corners = false;
};

}  // namespace granita
