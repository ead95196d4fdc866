// SPDX-License-Identifier: GPL-3.0-or-later
// The levels of one image (Williams 1983), in tiles.
//
// Level 0 is what the image stores.  Coarser levels hold light, linear half floats (floats where
// the image is of floats): each texel is the mean of what it covers, so that a far texture keeps
// its brightness.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "shade/textures/texel_decoder.h"
#include "shade/textures/tile_cache.h"

namespace granita {

struct TextureLevel {
    int width = 0, height = 0;            ///< texels
    int tile_columns = 6, tile_rows = 6;  ///< binary logarithms of a tile's texels
    int tiles_across = 0, tiles_down = 0;
    TexelType type = TexelType::Byte;
    std::unique_ptr<TileSlot[]> slots;  ///< [tiles_down][tiles_across]

    TextureLevel(int w, int h, TexelType t, int columns = 6, int rows = 6);
    TileSlot& slot(int across, int down) const {
        return slots[static_cast<std::size_t>(down) * tiles_across + across];
    }
    TileShape shape(int across, int down) const;
};

using TextureLevels = std::vector<TextureLevel>;

/// Of all texels from that level on.
std::uint64_t byte_count_from(const TextureLevels& levels, std::size_t begin);

/// Down to one texel, empty.
TextureLevels make_levels(int width, int height, TexelType type);

/// Levels from `begin` to before `end`, which is not 0.
struct LevelRange {
    std::size_t begin = 0, end = SIZE_MAX;
};

/// Fills levels from the rows of the finest, top row first.  Only as much is held as a row of tiles
/// of each level.
class LevelWriter {
  public:
    /// @param stored  Levels that are filled; what they hold does not depend on it.
    LevelWriter(const TextureLevels& levels, const TexelDecoder& decoder, TileCache& cache,
                LevelRange stored = {});
    /// @param rows  [count][width] texels of level 0's type.
    void push(const std::byte* rows, int count);

  private:
    /// One dimension of a texel: `first` and the two after it of the finer level, by the part that
    /// is covered.
    struct Cover {
        int first = 0;
        float weight[3] = {1.0f, 0.0f, 0.0f};
    };
    struct Part {
        std::vector<std::byte> strip;    ///< rows of the tiles being filled
        int row = 0;                     ///< that comes next
        std::vector<Vec4f> light;        ///< the newest row
        std::vector<Vec4f> mean, later;  ///< the row that comes next and the one after it, gathered
        std::vector<Cover> covers;       ///< [width], of the finer level
    };
    static Cover cover_of(int i, int fine, int coarse);
    void store_row(std::size_t level, const std::byte* stored);
    void pass_on(std::size_t finer);
    void finish_row(std::size_t level);
    void write_tiles(std::size_t level);

    const TextureLevels& m_levels;
    TexelDecoder m_decoder;
    TileCache& m_cache;
    LevelRange m_stored;
    std::vector<Part> m_parts;  ///< [m_stored.end]
};

}  // namespace granita
