// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps that samples of lobes have met.
#pragma once

#include "shade/lights/lamp_set.h"

namespace granita {

/// Adds its light to the grid; of lamps with nodes it waits in LitGrid::met_lamps, so that these
/// are asked about many at once.
void add_met(const LampSet& set, LitGrid& grid, MetLamp met);
void deliver_met(LitGrid& grid);

}  // namespace granita
