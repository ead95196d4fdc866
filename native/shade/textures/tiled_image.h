// SPDX-License-Identifier: GPL-3.0-or-later
// One image in tiles: decoded by the first thread that needs it, or served from its file tile by
// tile.
#pragma once

#include <atomic>
#include <climits>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "base/progress.h"
#include "scene/node_graph.h"
#include "shade/textures/texture_file.h"
#include "shade/textures/texture_levels.h"
#include "shade/textures/tile_cache.h"

namespace granita {

/// Files that are kept open to serve tiles, no more than `most` at once.
class OpenFiles {
  public:
    explicit OpenFiles(std::size_t most) : m_most(most) {}
    struct Entry {
        std::mutex mutex;
        std::unique_ptr<TextureFile> file;  ///< nullptr while it is closed
    };
    /// Called with the entry's mutex held, after its file was opened: closes one of the others.
    void opened(Entry& entry);
    void forget(Entry& entry);

  private:
    std::mutex m_mutex;
    std::size_t m_most;
    std::list<Entry*> m_open;  ///< the oldest first
};

class TiledImage {
  public:
    /// `image` has to outlive it.
    TiledImage(const Image& image, const TextureHeader& header, bool unassociate,
               std::shared_ptr<TileCache> cache, std::shared_ptr<OpenFiles> files);
    ~TiledImage();
    TiledImage(const TiledImage&) = delete;
    TiledImage& operator=(const TiledImage&) = delete;

    /// Makes its levels from `finest` on unless they are there; other threads that want them wait
    /// meanwhile.  Not inside a ReadScope.  Where the cache has plenty of room all are made, else
    /// `finest` and one finer: 40 images of 4096 x 4096 through 1 GiB spent their time writing
    /// levels to disk that nobody read.  What is asked for beyond that has the file decoded once
    /// more, for all the rest.
    /// @param progress  Asked meanwhile, and whoever finds it cancelled throws; it is then not to
    ///     be read later either.  May be absent.
    /// @return false: it cannot be read, and `error` says why.
    bool make_ready(int finest = 0, const Progress* progress = nullptr);
    const std::string& error() const { return m_error; }
    bool is_whole() const { return m_finest.load(std::memory_order_acquire) == 0; }

    const TextureHeader& header() const { return m_header; }
    const TexelDecoder& decoder() const { return m_decoder; }
    TileCache& cache() { return *m_cache; }

    // Once it is ready, of the levels from `finest` on:
    int level_count() const { return static_cast<int>(m_levels.size()); }
    const TextureLevel& level(int k) const { return m_levels[static_cast<std::size_t>(k)]; }
    /// Inside a ReadScope.
    const Tile* tile(int level, int across, int down) {
        const TileSlot& slot = m_levels[static_cast<std::size_t>(level)].slot(across, down);
        const Tile* found = slot.look();
        return found ? found : reload(level, across, down);
    }

    /// Tiles were met that its file does not give: they are magenta.
    bool is_damaged() const { return m_is_damaged; }

  private:
    void decode(int finest, const Progress* progress);
    void decode_file(int finest, const Progress* progress);
    void decode_pixels(int finest, const Progress* progress);
    void decode_bytes(int finest, const Progress* progress);
    LevelWriter writer_for(int finest);
    const Tile* reload(int level, int across, int down);
    std::unique_ptr<Tile> read_tile(int level, int across, int down);
    bool read_stored_tile(int level, int across, int down, std::byte* out);

    const Image& m_image;
    TextureHeader m_header;
    TexelDecoder m_decoder;
    std::shared_ptr<TileCache> m_cache;
    std::shared_ptr<OpenFiles> m_files;
    std::mutex m_decoding;
    std::atomic<int> m_finest{INT_MAX};  ///< of the levels that are there
    int m_being_made = 0;                ///< the finest of them
    TextureLevels m_levels;              ///< all of them from the first decoding on
    std::string m_error;                 ///< of the last decoding; there is none after it
    OpenFiles::Entry m_entry;
    std::atomic<bool> m_is_damaged{false};
};

/// What is known of an image without decoding it.
TextureHeader read_texture_header(const Image& image);

}  // namespace granita
