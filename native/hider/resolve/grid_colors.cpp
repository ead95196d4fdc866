// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/grid_colors.h"

#include <cstring>

namespace granita {
namespace {

/// Each vertex as the next, bit by bit: the buckets of a frame compare all that they show.
bool all_equal(const std::vector<Vec3f>& colors) {
    return std::memcmp(colors.data(), colors.data() + 1, (colors.size() - 1) * sizeof(Vec3f)) == 0;
}

}  // namespace

void GridColors::fill(const GridPool& pool, const std::vector<bool>& seen) {
    m_lookups.resize(pool.size());
    for (std::uint32_t slot = 0; slot < pool.size(); ++slot) {
        if (!seen[slot]) continue;
        const Grid& grid = pool.grid(slot);
        const std::vector<Vec3f>& radiance = grid.radiance;
        if (grid.holdout || grid.opacity_varies || radiance.empty()) continue;
        if (!all_equal(radiance)) continue;
        m_lookups[slot] = {radiance.front() + 0.0f, 1};  // no negative zeros
        m_any = true;
    }
}

bool GridColors::color(const GridPool& pool, std::span<const SurfaceId> ids, SampleColors& colors,
                       std::span<std::uint8_t> done) const {
    std::uint32_t all_known = 1;
    for (std::size_t s = 0; s < ids.size(); ++s) {
        if (ids[s] == kNoSurface) continue;
        // Also where it is not known, which is then done again: no branch that is hard to foretell.
        const Lookup& lookup = m_lookups[pool.slot(ids[s])];
        colors.red[s] = lookup.color.x;
        colors.green[s] = lookup.color.y;
        colors.blue[s] = lookup.color.z;
        colors.alpha[s] = 1.0f;
        done[s] = static_cast<std::uint8_t>(lookup.known);
        all_known &= lookup.known;
    }
    return all_known == 0;
}

}  // namespace granita
