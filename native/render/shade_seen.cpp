// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shade_seen.h"

#include <optional>

#include "base/parallel.h"
#include "base/stage_timer.h"
#include "render/neighbour_grids.h"

namespace granita {

void shade_grids(Frame& frame, int bucket, const HiddenGrids& grids, const std::vector<bool>& seen,
                 const std::vector<HiddenGrids>& around) {
    std::optional<NeighbourGrids> neighbours;
    if (around.empty()) neighbours.emplace(frame, bucket, grids, seen);
    // Towards the end of a frame threads are idle that take some of them.
    parallel_for(grids.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slot = begin; slot < end; ++slot) {
            frame.progress.check();
            if (!seen[slot]) continue;
            const auto beside = [&] {
                return neighbours ? neighbours->of(*grids[slot]) : around[slot];
            };
            grids[slot]->ensure_radiance(frame.shading, frame.statistics, beside,
                                         frame.visibility != nullptr);
        }
    });
}

std::vector<bool> shade_seen(Frame& frame, int bucket, const Hider& hider, const HiddenGrids& grids,
                             std::vector<HiddenGrids>* around) {
    std::vector<bool> seen;
    {
        const StageTimer timer(frame.statistics, Stage::Hide);
        seen = hider.seen_grids();
    }
    std::vector<HiddenGrids> unlisted;
    std::vector<HiddenGrids>& listed = around ? *around : unlisted;
    if (around) listed = all_neighbours(frame, bucket, grids, seen);
    shade_grids(frame, bucket, grids, seen, listed);
    return seen;
}

}  // namespace granita
