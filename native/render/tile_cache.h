// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "hider/samples/sample_table.h"

namespace granita {

/// Samples of tiles that a thread has looked at last: things that lie side by side share them.
class TileCache {
  public:
    /// Of a table of all that `frame` numbers, until the next call.
    const TileSamples& samples(std::uint64_t frame, const SampleTable& table, Vec2i tile) {
        if (frame != m_frame) m_tiles.clear();
        m_frame = frame;
        const auto found = std::ranges::find_if(
            m_tiles, [&](const Entry& e) { return e.table == &table && e.tile == tile; });
        if (found != m_tiles.end()) {
            std::rotate(m_tiles.begin(), found, found + 1);
            return m_tiles.front().samples;
        }
        const std::size_t bytes = 5 * sizeof(float) * kTileSize * kTileSize *
                                  static_cast<std::size_t>(std::max(table.samples(), 1));
        if (m_tiles.size() * bytes < kMostBytes || m_tiles.size() < kFewest) m_tiles.emplace_back();
        std::rotate(m_tiles.begin(), m_tiles.end() - 1, m_tiles.end());
        Entry& entry = m_tiles.front();
        entry.table = &table;
        entry.tile = tile;
        table.fill_tile(tile, table.needs(), entry.samples);
        return entry.samples;
    }

  private:
    static constexpr std::size_t kMostBytes = 4 << 20, kFewest = 2;
    struct Entry {
        const SampleTable* table = nullptr;
        Vec2i tile{0};
        TileSamples samples;
    };
    std::uint64_t m_frame = 0;
    std::vector<Entry> m_tiles;  ///< latest first
};

}  // namespace granita
