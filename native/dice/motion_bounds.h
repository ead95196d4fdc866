// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dice/grid.h"
#include "dice/knots.h"
#include "math/projection.h"

namespace granita {

/// Once lifespan and positions at every knot are set: whether the grid moves (where it does not,
/// one knot is kept).  What is still and appears or vanishes has equal knots:
/// all that follows then knows it as something that depends on time.
void find_motion(Grid& grid);
/// The same, and its swept bounds.
void motion_bounds(Grid& grid, const Projection& projection);
/// Then, where it moves: `p` of the vertices, their positions at the frame time.
void set_frame_positions(Grid& grid, const Knots& knots);
/// Or `p` of the points that lie on vertices, ShadingPositions::anchors.
void set_point_positions(Grid& grid, const Knots& knots);

}  // namespace granita
