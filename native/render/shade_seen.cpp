// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shade_seen.h"

namespace granita {

std::vector<bool> shade_seen(Frame& frame, const Hider& hider, const HiddenGrids& grids) {
    std::vector<bool> seen;
    {
        const StageTimer timer(frame.statistics, Stage::Hide);
        seen = hider.seen_grids();
    }
    for (std::size_t slot = 0; slot < grids.size(); ++slot) {
        frame.progress.check();
        if (seen[slot]) grids[slot]->ensure_radiance(frame.shading);
    }
    return seen;
}

}  // namespace granita
