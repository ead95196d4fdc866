// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/fragment_lists.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "base/check.h"

namespace granita {
namespace {

constexpr std::size_t kLayerBytes = FragmentLists::kLanes * sizeof(Fragment);

int block_log2(std::uint32_t capacity) {
    return std::countr_zero(capacity * kLayerBytes);
}

}  // namespace

void FragmentLists::reset() {
    m_any = false;
    m_packets.clear();
    m_counts.clear();
    order.clear();
}

void FragmentLists::begin(std::size_t slots, SlabMemory& memory) {
    GRANITA_DCHECK(slots % kLanes == 0);
    m_memory = &memory;
    m_packets.resize(slots / kLanes);
    m_counts.resize(slots, 0);
}

void FragmentLists::clear() {
    if (!m_any) return;
    for (Packet& packet : m_packets)
        if (packet.capacity > 0) m_memory->give(packet.layers, block_log2(packet.capacity));
    m_any = false;
    std::fill(m_packets.begin(), m_packets.end(), Packet{});
    std::fill(m_counts.begin(), m_counts.end(), 0);
}

std::uint64_t FragmentLists::total() const {
    return std::accumulate(m_counts.begin(), m_counts.end(), std::uint64_t{0});
}

void FragmentLists::grow(Packet& packet) {
    const std::uint32_t capacity = std::max(2u, 2 * packet.capacity);
    auto* const layers = static_cast<Fragment*>(m_memory->take(block_log2(capacity)));
    if (packet.capacity > 0) {
        std::copy_n(packet.layers, std::size_t{packet.capacity} * kLanes, layers);
        m_memory->give(packet.layers, block_log2(packet.capacity));
    }
    packet = {layers, capacity};
    m_any = true;
}

}  // namespace granita
