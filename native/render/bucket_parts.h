// SPDX-License-Identifier: GPL-3.0-or-later
// A bucket whose transparent lists do not fit into Options::list_memory: its tiles one by one, and
// where a tile's do not fit either, halves of it, down to a single pixel.  No fragment is dropped
// and no bit changes: a sample does not know which other samples are hidden with it.
#pragma once

#include <memory>
#include <vector>

#include "render/resolved_tile.h"
#include "render/shade_seen.h"

namespace granita {

std::unique_ptr<Hider> make_hider(const HiderFrame& settings, const ExecutorChoice& choice,
                                  const Rect& tiles, const Rect& pixels);

/// `pixels`: of these tiles; `grids`: all that their samples may see, from front to back.
std::vector<ResolvedTile> resolve_in_parts(Frame& frame, int bucket, const SampleTable& table,
                                           const Rect& tiles, const Rect& pixels,
                                           const HiddenGrids& grids);

}  // namespace granita
