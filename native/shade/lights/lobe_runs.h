// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "shade/lights/lit_point.h"

namespace granita {

/// Says where each point starts in the sequences of the closure's lobes.  Where all points take as
/// many samples of a lobe, at their place times that many: then aligned squares of points take
/// aligned runs.  Where Fresnel or masks make them differ, runs adjoin in the order of the places:
/// no stratum is drawn twice or left out.
/// @param lobe_count of the closure.
/// @param placed points are no neighbours, and go by their places alone.
void place_lobe_samples(std::vector<LitPoint>& points, std::size_t lobe_count, bool placed);

}  // namespace granita
