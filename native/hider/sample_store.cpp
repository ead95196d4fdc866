// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/sample_store.h"

#include "base/check.h"

namespace granita {

SurfaceId GridPool::add(const Grid& grid) {
    const SurfaceId base = m_id_end, count = static_cast<SurfaceId>(grid.micropolygon_count());
    GRANITA_CHECK(base < kNoSurface - count);
    const auto slot = static_cast<std::uint32_t>(m_grids.size());
    m_grids.push_back(&grid);
    m_bases.push_back(base);
    m_id_end = base + count;
    m_pages.resize((static_cast<std::size_t>(m_id_end) + kPage - 1) / kPage, slot);
    return base;
}

void GridPool::set_opacity(std::span<const OpacityBounds> bounds) {
    GRANITA_DCHECK(m_bases.back() + bounds.size() == id_end());
    m_opacity.resize(m_bases.back());
    m_opacity.insert(m_opacity.end(), bounds.begin(), bounds.end());
}

GridPool::Place GridPool::locate(SurfaceId id) const {
    GRANITA_DCHECK(id / kPage < m_pages.size());
    const std::uint32_t slot = this->slot(id);
    return {m_grids[slot], slot, static_cast<int>(id - m_bases[slot])};
}

bool GridPool::before(SurfaceId a, SurfaceId b) const {
    const Place place_a = locate(a), place_b = locate(b);
    const auto order = place_a.grid->key <=> place_b.grid->key;
    return order != 0 ? order < 0 : place_a.micropolygon < place_b.micropolygon;
}

}  // namespace granita
