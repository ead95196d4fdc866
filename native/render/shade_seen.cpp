// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shade_seen.h"

#include "base/parallel.h"
#include "base/stage_timer.h"

namespace granita {

void shade_grids(const Frame& frame, const HiddenGrids& grids, const std::vector<bool>& seen) {
    // Towards the end of a frame threads are idle that take some of them.
    parallel_for(grids.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slot = begin; slot < end; ++slot) {
            frame.progress.check();
            if (seen[slot])
                grids[slot]->ensure_radiance(frame.shading, frame.statistics,
                                             frame.visibility != nullptr);
        }
    });
}

std::vector<bool> shade_seen(Frame& frame, const Hider& hider, const HiddenGrids& grids) {
    std::vector<bool> seen;
    {
        const StageTimer timer(frame.statistics, Stage::Hide);
        seen = hider.seen_grids();
    }
    shade_grids(frame, grids, seen);
    return seen;
}

}  // namespace granita
