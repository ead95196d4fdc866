// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/sample_store.h"

#include <algorithm>

#include "base/check.h"

namespace granita {

SurfaceId GridPool::add(const Grid& grid) {
    const SurfaceId base =
        m_grids.empty()
            ? 0
            : m_bases.back() + static_cast<SurfaceId>(m_grids.back()->micropolygon_count());
    GRANITA_CHECK(base < kNoSurface - static_cast<SurfaceId>(grid.micropolygon_count()));
    m_grids.push_back(&grid);
    m_bases.push_back(base);
    return base;
}

GridPool::Place GridPool::locate(SurfaceId id) const {
    const auto after = std::upper_bound(m_bases.begin(), m_bases.end(), id);
    GRANITA_DCHECK(after != m_bases.begin());
    const auto slot = static_cast<std::uint32_t>(after - m_bases.begin() - 1);
    return {m_grids[slot], slot, static_cast<int>(id - m_bases[slot])};
}

bool GridPool::before(SurfaceId a, SurfaceId b) const {
    const Place place_a = locate(a), place_b = locate(b);
    const auto order = place_a.grid->key <=> place_b.grid->key;
    return order != 0 ? order < 0 : place_a.micropolygon < place_b.micropolygon;
}

}  // namespace granita
