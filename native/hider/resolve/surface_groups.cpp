// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/surface_groups.h"

namespace granita {

bool SurfaceGroups::sort(std::span<const SurfaceId> ids) {
    m_slots.assign(std::size_t{1} << kSlotBits, 0);
    m_group.resize(ids.size());
    m_ids.clear();
    m_begin.assign(2, 0);  // two ahead: counts become ends, and the walk below makes them begins
    for (std::size_t s = 0; s < ids.size(); ++s) {
        m_group[s] = 0;
        if (ids[s] == kNoSurface) continue;
        std::uint32_t slot = ids[s] * 0x9e3779b1u >> (32 - kSlotBits);
        while (m_slots[slot] != 0 && m_ids[m_slots[slot] - 1u] != ids[s])
            slot = (slot + 1) & ((1u << kSlotBits) - 1u);
        if (m_slots[slot] == 0) {
            if (m_ids.size() == kMost) return false;
            m_ids.push_back(ids[s]);
            m_begin.push_back(0);
            m_slots[slot] = static_cast<std::uint16_t>(m_ids.size());
        }
        m_group[s] = m_slots[slot];
        ++m_begin[m_slots[slot] + 1u];
    }
    for (std::size_t g = 1; g < m_begin.size(); ++g) m_begin[g] += m_begin[g - 1];
    m_samples.resize(m_begin.back());
    for (std::size_t s = 0; s < ids.size(); ++s)
        if (m_group[s] != 0) m_samples[m_begin[m_group[s]]++] = static_cast<std::int32_t>(s);
    m_begin.pop_back();
    return true;
}

}  // namespace granita
