// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "math/vec.h"
#include "shade/bsdf/lobe.h"

namespace granita {

/// What points of a grid found each by chance, each [points].
struct NoisyValues {
    std::vector<Vec3f> values;
    std::vector<float> by_reach;      ///< 1 / metres within which values vary little
    std::vector<std::uint8_t> known;  ///< others tell nothing
    float least_reach = 0.0f;         ///< in steps of the grid, whatever `by_reach` says
};

/// [points] what neighbours of a grid found together.  Slopes stay: each point takes the plane that
/// fits its neighbours best (locally weighted regression, Cleveland 1979).  Of two the nearer reach
/// decides.
std::vector<Vec3f> share(const ShadingPoints& points, const NoisyValues& noisy);

}  // namespace granita
