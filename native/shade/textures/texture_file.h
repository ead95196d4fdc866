// SPDX-License-Identifier: GPL-3.0-or-later
// An image file as texels: opened by a trusted reader, its header checked before anything is read.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>
#include <vector>

#include "scene/node_graph.h"
#include "shade/textures/texel_converter.h"

namespace granita {

/// What an image is stored as.
struct TextureHeader {
    int width = 0, height = 0;
    TexelType type = TexelType::Byte;
    bool encoded = false;    ///< numbers of sRGB, which are interpolated as they are
    bool has_alpha = false;  ///< that is not 1 everywhere by declaration
    std::string error;       ///< not empty: cannot be read, in words for the artist

    bool operator==(const TextureHeader&) const = default;
};

/// Not thread-safe.  An object is one reader of one file.
class TextureFile {
  public:
    explicit TextureFile(const Image& image);

    const TextureHeader& header() const { return m_header; }
    const std::string& error() const { return m_header.error; }

    /// Rows that read_rows can be asked for at once; a request begins at a multiple of it.
    int strip_rows() const { return m_strip; }
    /// @param out  [count][width] texels of the header's type, top row first.
    bool read_rows(int begin, int count, std::byte* out);

    /// The levels that the file itself has, where they are tiles from which a cache can be served;
    /// none else.
    struct FileLevel {
        int width = 0, height = 0, tile_columns = 0, tile_rows = 0;  ///< logarithms, of tiles
    };
    const std::vector<FileLevel>& tiled_levels() const { return m_levels; }
    /// @param out  [height][width] texels of the header's type, of the tile's part inside the
    /// level.
    bool read_tile(int level, int across, int down, std::byte* out);

  private:
    bool open(const Image& image);
    bool check(const OIIO::ImageSpec& spec);
    void find_levels();
    void associate(void* raw, std::size_t count) const;
    void convert(void* raw, std::size_t count, std::byte* out) const;
    void* raw_memory(std::size_t texels);
    OIIO::TypeDesc raw_type() const;

    std::unique_ptr<OIIO::ImageInput> m_input;
    OIIO::ImageSpec m_spec;
    TextureHeader m_header;
    TexelConverter m_converter;
    std::vector<FileLevel> m_levels;
    std::vector<std::byte> m_raw;
    TexelType m_raw_type = TexelType::Byte;
    int m_channels = 0, m_strip = 64;
    bool m_associate = false;  ///< its reader leaves the product with alpha to us
};

}  // namespace granita
