// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/arena.h"

#include <algorithm>
#include <cstring>
#include <new>

#include "base/system.h"

namespace granita {
namespace {

constexpr std::size_t kSlab = std::size_t{1} << Arena::kSlabLog2;

}  // namespace

void Arena::Free::operator()(void* memory) const {
    ::operator delete (memory, std::align_val_t{kSlab});
}

Arena::Slab Arena::make(std::size_t bytes) {
    Slab slab(static_cast<std::byte*>(::operator new (bytes, std::align_val_t{kSlab})));
    want_huge_pages(slab.get(), bytes);
    return slab;
}

void* Arena::take(int log2) {
    const std::size_t bytes = std::size_t{1} << log2;
    m_bytes += bytes;
    if (log2 > kSlabLog2) return m_large.emplace_back(make(bytes)).get();
    if (void* block = m_given[log2]) {
        std::memcpy(&m_given[log2], block, sizeof block);
        return block;
    }
    // What is left of a slab is lost until clear(): blocks are small beside it.
    if (m_slab < m_slabs.size() && m_used + bytes > kSlab) {
        ++m_slab;
        m_used = 0;
    }
    if (m_slab == m_slabs.size()) m_slabs.push_back(make(kSlab));
    void* const block = m_slabs[m_slab].get() + m_used;
    m_used += bytes;
    return block;
}

void Arena::give(void* block, int log2) {
    m_bytes -= std::uint64_t{1} << log2;
    if (log2 > kSlabLog2) {
        std::erase_if(m_large, [&](const Slab& slab) { return slab.get() == block; });
        return;
    }
    std::memcpy(block, &m_given[log2], sizeof block);
    m_given[log2] = block;
}

void Arena::clear() {
    m_large.clear();
    std::fill(std::begin(m_given), std::end(m_given), nullptr);
    m_slab = m_used = 0;
    m_bytes = 0;
}

}  // namespace granita
