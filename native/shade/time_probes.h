// SPDX-License-Identifier: GPL-3.0-or-later
// Points of a grid at which it is asked whether anything changes within the shutter.
#pragma once

#include <vector>

#include "shade/refined_points.h"

namespace granita {

/// One micropolygon of many, at several times each.
std::vector<RefinedPoint> time_probes(const Grid& grid);

/// Whether any of the [time_probes] values differs by more than the threshold from when the shutter
/// opens.
bool any_changes(const std::vector<Vec3f>& values, float threshold,
                 float (*difference)(const Vec3f&, const Vec3f&));

}  // namespace granita
