// SPDX-License-Identifier: GPL-3.0-or-later
// One bucket, in the order of the paper's listing (9.3.3), with shading moved behind visibility.
#pragma once

#include <vector>

#include "render/frame.h"

namespace granita {

/// Finished pixels of the film that this bucket completed.  Throws Cancelled.
std::vector<Tile> render_bucket(Frame& frame, int bucket);

}  // namespace granita
