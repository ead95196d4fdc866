// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dice/grid.h"
#include "dice/knots.h"
#include "math/projection.h"

namespace granita {

/// Once positions are set at every knot: whether the grid moves (where it does not, one knot is
/// kept), the vertices' positions at the frame time (in
/// `p`) and its swept bounds.
void finish_motion(Grid& grid, const Knots& knots, const Projection& projection);

}  // namespace granita
