// SPDX-License-Identifier: GPL-3.0-or-later
// The map of many points to the disc of a lens, compiled for every SIMD target and chosen at run
// time (Highway).
#pragma once

#include <cstddef>

namespace granita {

/// In place: (u[i], v[i]) in [0, 1)^2 become points of the unit disc, i < count.
void map_to_disc(float* u, float* v, std::size_t count);

}  // namespace granita
