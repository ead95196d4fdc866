// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shade_seen.h"

#include <algorithm>

namespace granita {
namespace {

/// By slot (arrival order).
std::vector<bool> seen_grids(const std::vector<TileStore>& stores, const GridPool& pool) {
    // A mark for each micropolygon, and one for nothing: no question a sample.
    const SurfaceId end = pool.id_end();
    std::vector<char> marks(static_cast<std::size_t>(end) + 1, 0);
    for (const TileStore& store : stores) {
        for (const SurfaceId id : store.id) marks[std::min(id, end)] = 1;
        for (const Fragment& fragment : store.lists.fragments) marks[fragment.id] = 1;
    }
    std::vector<bool> seen(pool.size(), false);
    auto next = marks.begin();
    for (std::uint32_t slot = 0; slot < pool.size(); ++slot) {
        const auto first = next;
        next += pool.grid(slot).micropolygon_count();
        seen[slot] = std::find(first, next, 1) != next;
    }
    return seen;
}

}  // namespace

void shade_seen(Frame& frame, const std::vector<TileStore>& stores, const GridPool& pool,
                const HiddenGrids& grids) {
    std::vector<bool> seen;
    {
        const StageTimer timer(frame.statistics, Stage::Hide);
        seen = seen_grids(stores, pool);
    }
    for (std::size_t slot = 0; slot < grids.size(); ++slot) {
        frame.progress.check();
        if (seen[slot]) grids[slot]->ensure_radiance(frame.shading);
    }
}

}  // namespace granita
