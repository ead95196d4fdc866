// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/tile_cache.h"

#include <algorithm>
#include <functional>
#include <string>
#include <thread>
#include <utility>

namespace granita {

void Tile::fill(const Vec4f& color) {
    const std::size_t texel = byte_size(shape.type), end = shape.byte_count();
    for (std::size_t at = 0; at < end; at += texel)
        store_texel(color, texels.get() + at, shape.type);
}

TileCache::TileCache(std::uint64_t limit_bytes, Report& report)
    : m_limit(limit_bytes), m_report(report) {}

TileCache::~TileCache() = default;

// Everything here is sequentially consistent: either the reader's epoch is seen when retired tiles
// are freed, or the reader sees that their slots are empty.
TileCache::ReadScope::ReadScope(TileCache& cache) {
    const std::size_t first = std::hash<std::thread::id>()(std::this_thread::get_id());
    for (std::size_t k = first;; ++k) {
        m_epoch = &cache.m_readers[k % kReaders].epoch;
        std::uint64_t nobody = 0;
        if (m_epoch->compare_exchange_strong(nobody, cache.m_epoch.load())) return;
        if (k % kReaders == first % kReaders && k != first) std::this_thread::yield();
    }
}

TileCache::ReadScope::~ReadScope() {
    m_epoch->store(0);
}

const Tile* TileCache::insert(TileSlot& slot, std::unique_ptr<Tile> tile, bool used) {
    tile->slot = &slot;
    tile->used.store(used, std::memory_order_relaxed);
    const Tile* address = tile.get();
    const std::lock_guard lock(m_mutex);
    m_bytes += address->shape.byte_count();
    m_clock.push_back(std::move(tile));
    slot.tile.store(address);
    if (m_bytes > m_limit) trim();
    return address;
}

std::unique_ptr<Tile> TileCache::read_spilled(const TileSlot& slot, const TileShape& shape) {
    auto tile = std::make_unique<Tile>(shape);
    if (!m_spill.read(slot.spilled, tile->texels.get(), shape.byte_count())) {
        tile->fill(kMagenta);
        m_report.warn("textures", "their temporary file cannot be read, parts are shown magenta");
    }
    return tile;
}

void TileCache::trim() {
    std::size_t retired = 0;
    while (m_bytes > m_limit && m_can_spill && m_clock.size() > 1) {
        if (m_hand >= m_clock.size()) m_hand = 0;
        const Tile& tile = *m_clock[m_hand];
        if (tile.used.exchange(false, std::memory_order_relaxed)) {
            ++m_hand;
            continue;
        }
        const std::size_t bytes = tile.shape.byte_count();
        TileSlot& slot = *tile.slot;
        if (slot.spilled == TileSlot::kNowhere &&
            !m_spill.write(tile.texels.get(), bytes, slot.spilled)) {
            m_can_spill = false;
            m_report.warn("textures",
                          "take more memory than they are given, for want of a temporary file: " +
                              m_spill.error());
            break;
        }
        slot.tile.store(nullptr);
        m_bytes -= bytes;
        m_retired_bytes += bytes;
        m_retired.push_back({std::move(m_clock[m_hand]), m_epoch.load()});
        // The newest takes its place, behind the hand: what has just come is not asked for its use
        // yet.
        if (m_hand + 1 < m_clock.size()) m_clock[m_hand] = std::move(m_clock.back());
        m_clock.pop_back();
        ++m_hand;
        ++retired;
    }
    if (retired == 0) return;
    // Who begins from here on finds the slots empty.
    m_epoch.fetch_add(1);
    if (m_retired.size() >= m_free_at) {
        free_retired();
        m_free_at = m_retired.size() + kBatch;
    }
}

void TileCache::free_retired() {
    std::uint64_t oldest = UINT64_MAX;
    for (const Reader& reader : m_readers)
        if (const std::uint64_t epoch = reader.epoch.load()) oldest = std::min(oldest, epoch);
    std::erase_if(m_retired, [&](const Retired& entry) {
        if (entry.epoch >= oldest) return false;
        m_retired_bytes -= entry.tile->shape.byte_count();
        return true;
    });
}

void TileCache::set_limit(std::uint64_t bytes) {
    const std::lock_guard lock(m_mutex);
    m_limit = bytes;
    if (m_bytes > m_limit) trim();
    free_retired();
}

bool TileCache::has_plenty_for(std::uint64_t bytes) const {
    const std::lock_guard lock(m_mutex);
    const std::uint64_t held = m_bytes + m_retired_bytes;
    return held < m_limit && bytes <= (m_limit - held) / 4;
}

std::uint64_t TileCache::byte_count() const {
    const std::lock_guard lock(m_mutex);
    return m_bytes + m_retired_bytes;
}

}  // namespace granita
