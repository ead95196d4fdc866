// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "math/vec.h"
#include "shade/bsdf/lobe.h"

namespace granita {

/// What points of a grid found each by chance, each [points], a channel at a time.
struct NoisyValues {
    std::vector<Vec3f> values;
    std::vector<Vec3f> by_reach;  ///< 1 / metres within which values vary little
    std::vector<Vec3f> told;      ///< 1, or 0 where a point tells nothing of a channel
    float least_reach = 0.0f;     ///< in steps of the grid, whatever `by_reach` says
};

/// [points] what neighbours of a grid found together.  Slopes stay: each point takes the plane that
/// fits its neighbours best (locally weighted regression, Cleveland 1979).  Of two the nearer reach
/// decides.  Points count for as much as they asked (ShadingPoints::shares), hidden ones hardly.
std::vector<Vec3f> share(const ShadingPoints& points, const NoisyValues& noisy);

}  // namespace granita
