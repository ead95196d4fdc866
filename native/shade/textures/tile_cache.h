// SPDX-License-Identifier: GPL-3.0-or-later
// Tiles of all textures in bounded memory.
//
// A tile that is in memory is read without a lock: its slot holds its address.  Those that no
// look-up has read for a while leave by the clock algorithm (Corbato 1968), into a temporary file
// the first time. What has left is freed once every reader that could have seen it is done
// (epoch-based reclamation, Fraser 2004): a ReadScope writes down the epoch at which it began.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "base/report.h"
#include "shade/textures/texel.h"
#include "shade/textures/tile_spill.h"

namespace granita {

struct TileShape {
    TexelType type = TexelType::Byte;
    int width = 0, height = 0;  ///< texels; at an image's rim less than elsewhere
    std::size_t byte_count() const {
        return byte_size(type) * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
};

struct TileSlot;

const Vec4f kMagenta(1.0f, 0.0f, 1.0f, 1.0f);

/// Texels of one tile, [height][width][4], top row first.
struct Tile {
    explicit Tile(const TileShape& s)
        : shape(s), texels(std::make_unique_for_overwrite<std::byte[]>(s.byte_count())) {}
    /// For what cannot be read.
    void fill(const Vec4f& color);
    TileShape shape;
    std::unique_ptr<std::byte[]> texels;
    TileSlot* slot = nullptr;
    mutable std::atomic<bool> used{false};  ///< since the clock's hand last came by

    const std::byte* at(int x, int y) const {
        return texels.get() +
               byte_size(shape.type) * (static_cast<std::size_t>(y) * shape.width + x);
    }
};

/// Where a tile is.
struct TileSlot {
    static constexpr std::uint64_t kNowhere = UINT64_MAX;  ///< in memory alone
    static constexpr std::uint64_t kInItsFile = UINT64_MAX - 1;
    std::atomic<const Tile*> tile{nullptr};
    std::uint64_t spilled = kNowhere;  ///< or its offset in the temporary file

    /// Inside a ReadScope; nullptr where it is not in memory.
    const Tile* look() const {
        const Tile* found = tile.load();
        if (found && !found->used.load(std::memory_order_relaxed))
            found->used.store(true, std::memory_order_relaxed);
        return found;
    }
};

class TileCache {
  public:
    /// @param limit_bytes  of texels; where no temporary file can be made, it is exceeded and
    /// `report` says so.
    TileCache(std::uint64_t limit_bytes, Report& report);
    ~TileCache();
    TileCache(const TileCache&) = delete;
    TileCache& operator=(const TileCache&) = delete;

    /// While it lives, tiles found in slots stay in memory.  To be kept short.
    class ReadScope {
      public:
        explicit ReadScope(TileCache& cache);
        ~ReadScope();
        ReadScope(const ReadScope&) = delete;
        ReadScope& operator=(const ReadScope&) = delete;

      private:
        std::atomic<std::uint64_t>* m_epoch;
    };

    /// Takes a tile in.  `used` is false for what nobody has asked for yet: it leaves first.
    const Tile* insert(TileSlot& slot, std::unique_ptr<Tile> tile, bool used);

    /// The tile of a slot that was found empty: read again, by one thread.  `read` makes one from
    /// its file.
    template <class Read>
    const Tile* reload(TileSlot& slot, const TileShape& shape, const Read& read) {
        const std::lock_guard lock(m_loading[stripe(slot)]);
        if (const Tile* found = slot.look()) return found;
        return insert(
            slot, slot.spilled == TileSlot::kInItsFile ? read() : read_spilled(slot, shape), true);
    }

    void set_limit(std::uint64_t bytes);

    /// Of all tiles in memory, those included that wait for their last readers.
    std::uint64_t byte_count() const;
    /// Whether so much more is little beside what there is room for.
    bool has_plenty_for(std::uint64_t bytes) const;

  private:
    /// More threads at once than this wait for each other.
    static constexpr std::size_t kReaders = 512;
    static constexpr std::size_t kStripes = 64;
    static constexpr std::size_t kBatch = 32;  ///< of tiles that leave
    struct alignas(64) Reader {
        std::atomic<std::uint64_t> epoch{0};  ///< 0: nobody reads
    };
    struct Retired {
        std::unique_ptr<const Tile> tile;
        std::uint64_t epoch;
    };

    static std::size_t stripe(const TileSlot& slot) {
        return reinterpret_cast<std::uintptr_t>(&slot) / sizeof(TileSlot) % kStripes;
    }
    std::unique_ptr<Tile> read_spilled(const TileSlot& slot, const TileShape& shape);
    void trim();
    void free_retired();

    std::uint64_t m_limit;
    Report& m_report;
    std::array<Reader, kReaders> m_readers;
    std::atomic<std::uint64_t> m_epoch{1};
    std::array<std::mutex, kStripes> m_loading;

    mutable std::mutex m_mutex;  ///< of what follows
    std::vector<std::unique_ptr<const Tile>> m_clock;
    std::size_t m_hand = 0;
    std::uint64_t m_bytes = 0;          ///< of m_clock
    std::uint64_t m_retired_bytes = 0;  ///< of m_retired
    std::vector<Retired> m_retired;
    std::size_t m_free_at = kBatch;  ///< so many tiles that have left: readers are looked through
    TileSpill m_spill;
    bool m_can_spill = true;
};

}  // namespace granita
