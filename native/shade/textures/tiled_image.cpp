// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/tiled_image.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <span>
#include <utility>
#include <vector>

namespace granita {

namespace {

/// Of the rows that are decoded at once.
constexpr int kRows = 64;

/// Of bytes that the scene holds.
TexelConverter converter_of(const Image& image) {
    return TexelConverter({.space = image.space,
                           .opaque = image.alpha_mode == "NONE",
                           .is_associated = image.has_products()});
}

}  // namespace

void OpenFiles::opened(Entry& entry) {
    const std::lock_guard lock(m_mutex);
    m_open.push_back(&entry);
    for (auto candidate = m_open.begin(); m_open.size() > m_most && *candidate != &entry;) {
        // One that is being read stays open.
        std::unique_lock idle((*candidate)->mutex, std::try_to_lock);
        if (!idle) {
            ++candidate;
            continue;
        }
        (*candidate)->file.reset();
        candidate = m_open.erase(candidate);
    }
}

void OpenFiles::forget(Entry& entry) {
    const std::lock_guard lock(m_mutex);
    m_open.remove(&entry);
}

TextureHeader read_texture_header(const Image& image) {
    if (image.is_file()) return TextureFile(image).header();
    TextureHeader header;
    header.width = image.width;
    header.height = image.height;
    header.has_alpha = image.alpha_mode != "NONE";
    if (image.bytes.empty()) {
        header.type = TexelType::Float;
    } else {
        const TexelConverter converter = converter_of(image);
        header.encoded = converter.encoded();
        header.type = converter.type();
    }
    return header;
}

TiledImage::TiledImage(const Image& image, const TextureHeader& header, bool unassociate,
                       std::shared_ptr<TileCache> cache, std::shared_ptr<OpenFiles> files)
    : m_image(image),
      m_header(header),
      m_decoder{header.encoded, unassociate},
      m_cache(std::move(cache)),
      m_files(std::move(files)) {}

TiledImage::~TiledImage() {
    m_files->forget(m_entry);
}

bool TiledImage::make_ready(int finest, const Progress* progress) {
    if (finest >= m_finest.load(std::memory_order_acquire)) return true;
    const std::lock_guard lock(m_decoding);
    if (finest >= m_finest.load(std::memory_order_relaxed)) return true;
    if (m_error.empty()) {
        try {
            decode(finest, progress);
        } catch (const std::exception& failure) {  // no memory for it, say
            m_error = failure.what();
            if (m_error.empty()) m_error = "it cannot be read";
        }
        if (m_error.empty()) m_finest.store(m_being_made, std::memory_order_release);
    }
    if (m_error.empty()) return true;
    if (progress) progress->check();  // what was not decoded for that is no damaged image
    return false;
}

void TiledImage::decode(int finest, const Progress* progress) {
    if (m_image.is_file()) {
        decode_file(finest, progress);
    } else if (m_image.bytes.empty()) {
        decode_pixels(finest, progress);
    } else {
        decode_bytes(finest, progress);
    }
}

/// Of the levels that are to be made now.
LevelWriter TiledImage::writer_for(int finest) {
    LevelRange stored;
    if (m_levels.empty()) {
        m_levels = make_levels(m_header.width, m_header.height, m_header.type);
        if (!m_cache->has_plenty_for(byte_count_from(m_levels, 0)))
            stored.begin = static_cast<std::size_t>(std::clamp(finest - 1, 0, level_count() - 1));
    } else {
        stored.end = static_cast<std::size_t>(m_finest.load(std::memory_order_relaxed));
    }
    m_being_made = static_cast<int>(stored.begin);
    return LevelWriter(m_levels, m_decoder, *m_cache, stored);
}

void TiledImage::decode_file(int finest, const Progress* progress) {
    auto file = std::make_unique<TextureFile>(m_image);
    m_error = file->error();
    if (!m_error.empty()) return;
    if (m_levels.empty()) {
        // What is asked for was reckoned from the header that was seen first.
        if (!(file->header() == m_header)) finest = 0;
        m_header = file->header();
        m_decoder.encoded = m_header.encoded;
    } else if (!(file->header() == m_header) || !file->tiled_levels().empty()) {
        m_error = "it has changed meanwhile";
        return;
    }
    if (!file->tiled_levels().empty()) {
        // Bytes of coarser levels become light when their tiles are read.
        const TexelType coarser =
            m_header.type == TexelType::Float ? TexelType::Float : TexelType::Half;
        for (const auto& level : file->tiled_levels()) {
            m_levels.emplace_back(level.width, level.height,
                                  m_levels.empty() ? m_header.type : coarser, level.tile_columns,
                                  level.tile_rows);
            const TextureLevel& made = m_levels.back();
            for (int i = 0; i < made.tiles_across * made.tiles_down; ++i)
                made.slots[i].spilled = TileSlot::kInItsFile;
        }
        return;
    }
    LevelWriter writer = writer_for(finest);
    const int rows = (kRows + file->strip_rows() - 1) / file->strip_rows() * file->strip_rows();
    std::vector<std::byte> strip(byte_size(m_header.type) * m_header.width *
                                 std::min(rows, m_header.height));
    for (int y = 0; y < m_header.height; y += rows) {
        if (progress) progress->check();
        const int count = std::min(rows, m_header.height - y);
        if (!file->read_rows(y, count, strip.data())) {
            m_error = file->error();
            return;
        }
        writer.push(strip.data(), count);
    }
}

/// Pixels come with their lowest row first.
void TiledImage::decode_pixels(int finest, const Progress* progress) {
    LevelWriter writer = writer_for(finest);
    const std::size_t texel = byte_size(m_header.type);
    std::vector<std::byte> row(texel * m_header.width);
    for (int y = m_header.height - 1; y >= 0; --y) {
        if (progress) progress->check();
        const float* c = m_image.pixels.data() + static_cast<std::size_t>(y) * m_header.width * 4;
        for (int x = 0; x < m_header.width; ++x, c += 4) {
            Vec4f color(c[0], c[1], c[2], m_image.alpha_mode == "NONE" ? 1.0f : c[3]);
            for (int k = 0; k < 4; ++k)
                if (!std::isfinite(color[k])) color[k] = 0.0f;
            store_texel(color, row.data() + x * texel, m_header.type);
        }
        writer.push(row.data(), 1);
    }
}

/// So do bytes.
void TiledImage::decode_bytes(int finest, const Progress* progress) {
    LevelWriter writer = writer_for(finest);
    const TexelConverter converter = converter_of(m_image);
    const auto width = static_cast<std::size_t>(m_header.width);
    std::vector<std::byte> row(byte_size(m_header.type) * width);
    for (int y = m_header.height - 1; y >= 0; --y) {
        if (progress) progress->check();
        const std::size_t begin = static_cast<std::size_t>(y) * width * 4;
        converter.convert(m_image.bytes.data() + begin, width, row.data());
        writer.push(row.data(), 1);
    }
}

const Tile* TiledImage::reload(int level, int across, int down) {
    const TextureLevel& from = m_levels[static_cast<std::size_t>(level)];
    return m_cache->reload(from.slot(across, down), from.shape(across, down),
                           [&] { return read_tile(level, across, down); });
}

std::unique_ptr<Tile> TiledImage::read_tile(int level, int across, int down) {
    const TextureLevel& from = m_levels[static_cast<std::size_t>(level)];
    const TileShape shape = from.shape(across, down);
    auto tile = std::make_unique<Tile>(shape);
    TileShape stored = shape;
    stored.type = m_header.type;
    std::vector<std::byte> texels;
    std::byte* to = tile->texels.get();
    if (stored.type != shape.type) {
        texels.resize(stored.byte_count());
        to = texels.data();
    }
    if (!read_stored_tile(level, across, down, to)) {
        m_is_damaged = true;
        tile->fill(kMagenta);
        return tile;
    }
    const std::size_t count = static_cast<std::size_t>(shape.width) * shape.height;
    for (std::size_t i = 0; level > 0 && i < count; ++i) {
        const Vec4f light = m_decoder.light(to + i * byte_size(stored.type), stored.type);
        store_texel(light, tile->texels.get() + i * byte_size(shape.type), shape.type);
    }
    return tile;
}

bool TiledImage::read_stored_tile(int level, int across, int down, std::byte* out) {
    const std::lock_guard lock(m_entry.mutex);
    try {
        if (!m_entry.file) {
            m_entry.file = std::make_unique<TextureFile>(m_image);
            m_files->opened(m_entry);
        }
        TextureFile& file = *m_entry.file;
        // What was closed may have become another file meanwhile.
        return file.header().type == m_header.type &&
               std::ranges::equal(file.tiled_levels(), m_levels,
                                  [](const auto& a, const auto& b) {
                                      return a.width == b.width && a.height == b.height &&
                                             a.tile_columns == b.tile_columns &&
                                             a.tile_rows == b.tile_rows;
                                  }) &&
               file.read_tile(level, across, down, out);
    } catch (const std::exception&) {
        return false;
    }
}

}  // namespace granita
