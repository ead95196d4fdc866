// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/fragment_lists.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "base/check.h"

namespace granita {
int FragmentLists::block_log2(std::uint32_t chunk) {
    const std::uint32_t layers = chunk == 0 ? kFirst : first_of(chunk);
    return std::countr_zero(layers * sizeof(FragmentLayer));
}

void FragmentLists::reset() {
    m_any = false;
    m_chunks.clear();
    m_counts.clear();
    order.clear();
}

void FragmentLists::begin(std::size_t slots, Arena& memory) {
    GRANITA_DCHECK(slots % kLanes == 0);
    m_memory = &memory;
    m_stride = 4;
    m_chunks.resize(slots / kLanes * m_stride);
    m_counts.resize(slots, 0);
}

void FragmentLists::clear() {
    if (!m_any) return;
    for (std::size_t i = 0; i < m_chunks.size(); ++i)
        if (m_chunks[i])
            m_memory->give(m_chunks[i], block_log2(static_cast<std::uint32_t>(i % m_stride)));
    m_any = false;
    std::fill(m_chunks.begin(), m_chunks.end(), nullptr);
    std::fill(m_counts.begin(), m_counts.end(), 0);
}

std::uint64_t FragmentLists::total() const {
    return std::accumulate(m_counts.begin(), m_counts.end(), std::uint64_t{0});
}

void FragmentLists::grow(std::size_t packet, std::uint32_t chunk) {
    if (chunk >= m_stride) {
        std::vector<FragmentLayer*> wider(packets() * 2 * m_stride);
        for (std::size_t p = 0; p < packets(); ++p)
            std::copy_n(&m_chunks[p * m_stride], m_stride, &wider[p * 2 * m_stride]);
        m_chunks.swap(wider);
        m_stride *= 2;
    }
    m_chunks[packet * m_stride + chunk] =
        static_cast<FragmentLayer*>(m_memory->take(block_log2(chunk)));
    m_any = true;
}

}  // namespace granita
