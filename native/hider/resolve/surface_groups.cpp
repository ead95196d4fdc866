// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/surface_groups.h"

#include <algorithm>
#include <bit>

namespace granita {

bool SurfaceGroups::sort(std::span<const SurfaceId> ids, std::span<const std::uint8_t> done) {
    const std::size_t slots = std::bit_ceil(2 * std::clamp<std::size_t>(ids.size(), 1, kMost));
    const int shift = 32 - std::countr_zero(slots);
    m_slots.assign(slots, 0);
    m_group.resize(ids.size());
    m_ids.clear();
    m_begin.assign(2, 0);  // two ahead: counts become ends, and the walk below makes them begins
    for (std::size_t s = 0; s < ids.size(); ++s) {
        m_group[s] = 0;
        if (ids[s] == kNoSurface || done[s] != 0) continue;
        std::size_t slot = ids[s] * 0x9e3779b1u >> shift;
        while (m_slots[slot] != 0 && m_ids[m_slots[slot] - 1u] != ids[s])
            slot = (slot + 1) & (slots - 1);
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

void SurfaceGroups::take_samples(const TileSamples& samples) {
    for (std::vector<float> TileSamples::*values :
         {&TileSamples::x, &TileSamples::y, &TileSamples::t, &TileSamples::u, &TileSamples::v,
          &TileSamples::inverse_focus}) {
        const std::vector<float>& from = samples.*values;
        std::vector<float>& to = m_sorted.*values;
        to.resize(from.empty() ? 0 : m_samples.size() + kPadding);
        if (from.empty()) continue;
        for (std::size_t i = 0; i < m_samples.size(); ++i)
            to[i] = from[static_cast<std::size_t>(m_samples[i])];
    }
}

}  // namespace granita
