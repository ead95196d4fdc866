// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "dice/grid.h"
#include "math/projection.h"

namespace granita {

/// Square pixels that a grid's micropolygons cover, each counted by itself, with its vertices at
/// `p` [vertices] (camera space).
double visible_area(const Grid& grid, std::span<const Vec3f> p, const Projection& projection);

/// What each point of a grid of this area (square pixels) stands for, at a dicing rate.
void set_point_share(Grid& grid, double area, double rate);

}  // namespace granita
