// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/layer_table.h"

#include "base/object_pool.h"

namespace granita {

LayerTable::~LayerTable() {
    if (!m_filled) return;
    ObjectPool<std::vector<LayerLook>>::give(std::move(m_lookups));
    ObjectPool<std::vector<LayerRow>>::give(std::move(m_rows));
}

void LayerTable::fill() {
    if (m_filled) return;
    m_filled = true;
    m_lookups = ObjectPool<std::vector<LayerLook>>::take();
    m_rows = ObjectPool<std::vector<LayerRow>>::take();
    m_lookups.clear();
    m_rows.clear();
    m_lookups.resize(m_pool.id_end());
    for (std::uint32_t slot = 0; slot < m_pool.size(); ++slot) {
        if (!m_seen[slot]) continue;
        const Grid& grid = m_pool.grid(slot);
        if (!grid.opacity.empty()) add(grid, m_pool.base(slot));
    }
}

const GridColors& LayerTable::grid_colors() {
    if (!m_has_colors) m_colors.fill(m_pool, m_seen);
    m_has_colors = true;
    return m_colors;
}

void LayerTable::add(const Grid& grid, SurfaceId base) {
    const auto first = static_cast<std::uint32_t>(m_rows.size());
    bool varies = false;
    const bool shaded = !grid.radiance.empty() && !grid.holdout;
    for (int v = 0; v < grid.vertex_count(); ++v) {
        const Vec3f& o = grid.opacity[v];
        const Vec3f r = shaded ? grid.radiance[v] : Vec3f(0.0f);
        m_rows.push_back({o.x, o.y, o.z, r.x, r.y, r.z, 0.0f, 0.0f});
    }
    for (int m = 0; m < grid.micropolygon_count(); ++m) {
        const Grid::Corners c = grid.corners(m);
        const int corners[4] = {c.v0, c.v1, c.v2, c.v3};
        LayerLook& look = m_lookups[base + static_cast<SurfaceId>(m)];
        const LayerRow& at = m_rows[first + static_cast<std::uint32_t>(c.v0)];
        if (grid.holdout) look.flags |= LayerLook::kHoldout;
        for (const int v : corners) {
            const LayerRow& row = m_rows[first + static_cast<std::uint32_t>(v)];
            if (row != at) look.flags |= LayerLook::kVaries;
            if (row[0] != row[1] || row[0] != row[2]) look.flags |= LayerLook::kColored;
        }
        if (look.flags & LayerLook::kVaries) {
            varies = true;
            for (int k = 0; k < 4; ++k)
                look.row[k] = first + static_cast<std::uint32_t>(corners[k]);
            continue;
        }
        for (int k = 0; k < 6; ++k) look.value[k] = k < 3 ? clamp_opacity(at[k]) : at[k];
    }
    if (!varies) m_rows.resize(first);
}

}  // namespace granita
