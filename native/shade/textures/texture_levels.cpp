// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/texture_levels.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace granita {

namespace {

TexelType coarser_type(TexelType type) {
    return type == TexelType::Float ? TexelType::Float : TexelType::Half;
}

}  // namespace

TextureLevel::TextureLevel(int w, int h, TexelType t, int columns, int rows)
    : width(w),
      height(h),
      tile_columns(columns),
      tile_rows(rows),
      tiles_across(((w - 1) >> columns) + 1),
      tiles_down(((h - 1) >> rows) + 1),
      type(t),
      slots(std::make_unique<TileSlot[]>(static_cast<std::size_t>(tiles_across) * tiles_down)) {}

TileShape TextureLevel::shape(int across, int down) const {
    return {type, std::min(width - (across << tile_columns), 1 << tile_columns),
            std::min(height - (down << tile_rows), 1 << tile_rows)};
}

std::uint64_t byte_count_from(const TextureLevels& levels, std::size_t begin) {
    std::uint64_t sum = 0;
    for (std::size_t k = begin; k < levels.size(); ++k)
        sum += TileShape{levels[k].type, levels[k].width, levels[k].height}.byte_count();
    return sum;
}

TextureLevels make_levels(int width, int height, TexelType type) {
    TextureLevels levels;
    levels.emplace_back(width, height, type);
    while (width > 1 || height > 1) {
        width = std::max(1, width / 2);
        height = std::max(1, height / 2);
        levels.emplace_back(width, height, coarser_type(type));
    }
    return levels;
}

LevelWriter::LevelWriter(const TextureLevels& levels, const TexelDecoder& decoder, TileCache& cache,
                         LevelRange stored)
    : m_levels(levels),
      m_decoder(decoder),
      m_cache(cache),
      m_stored{stored.begin, std::min(stored.end, levels.size())},
      m_parts(m_stored.end) {
    for (std::size_t k = 0; k < m_parts.size(); ++k) {
        Part& part = m_parts[k];
        const auto width = static_cast<std::size_t>(levels[k].width);
        const int rows = std::min(levels[k].height, 1 << levels[k].tile_rows);
        if (k >= m_stored.begin) part.strip.resize(width * rows * byte_size(levels[k].type));
        part.light.resize(width);
        if (k == 0) continue;
        part.mean.assign(width, Vec4f(0.0f));
        part.later.assign(width, Vec4f(0.0f));
        for (int x = 0; x < levels[k].width; ++x)
            part.covers.push_back(cover_of(x, levels[k - 1].width, levels[k].width));
    }
}

/// Texel i of `coarse` covers [i, i + 1) fine / coarse of the finer ones: two, or where `fine` is
/// odd three, the outer ones in part.  In units of 1 / coarse of a finer texel all of that is whole
/// numbers.
LevelWriter::Cover LevelWriter::cover_of(int i, int fine, int coarse) {
    Cover cover;
    const std::int64_t begin = std::int64_t{i} * fine, end = begin + fine;
    cover.first = static_cast<int>(begin / coarse);
    for (int k = 0; k < 3; ++k) {
        const std::int64_t from = std::int64_t{cover.first + k} * coarse;
        const std::int64_t part = std::min(end, from + coarse) - std::max(begin, from);
        cover.weight[k] =
            static_cast<float>(std::max<std::int64_t>(part, 0)) / static_cast<float>(fine);
    }
    return cover;
}

void LevelWriter::push(const std::byte* rows, int count) {
    const TextureLevel& level = m_levels.front();
    const std::size_t texel = byte_size(level.type), row = texel * level.width;
    for (int y = 0; y < count; ++y, rows += row) {
        if (m_parts.size() > 1) {
            std::vector<Vec4f>& light = m_parts[0].light;
            for (int x = 0; x < level.width; ++x)
                light[x] = m_decoder.light(rows + x * texel, level.type);
        }
        store_row(0, rows);
    }
}

/// The newest row, whose light is in its part already.
void LevelWriter::store_row(std::size_t k, const std::byte* stored) {
    const TextureLevel& level = m_levels[k];
    Part& part = m_parts[k];
    const int mask = (1 << level.tile_rows) - 1;
    const int at = part.row++ & mask;
    if (k >= m_stored.begin) {
        const std::size_t row = byte_size(level.type) * level.width;
        std::memcpy(part.strip.data() + row * at, stored, row);
        if (at == mask || part.row == level.height) write_tiles(k);
    }
    if (k + 1 < m_parts.size()) pass_on(k);
}

/// The newest row of a level, to the one or two of the next that it is part of.
void LevelWriter::pass_on(std::size_t k) {
    Part& to = m_parts[k + 1];
    const std::vector<Vec4f>& light = m_parts[k].light;
    const int fine = m_levels[k].height, coarse = m_levels[k + 1].height;
    const int across = m_levels[k].width, less = m_levels[k + 1].width;
    const int y = m_parts[k].row - 1;
    for (int target = to.row; target < std::min(to.row + 2, coarse); ++target) {
        const Cover cover = cover_of(target, fine, coarse);
        const int at = y - cover.first;
        if (at < 0 || at > 2 || cover.weight[at] == 0.0f) continue;
        const float w = cover.weight[at];
        std::vector<Vec4f>& mean = target == to.row ? to.mean : to.later;
        if (across == 2 * less) {
            for (int x = 0; x < less; ++x)
                mean[x] += (light[2 * x] + light[2 * x + 1]) * (0.5f * w);
            continue;
        }
        for (int x = 0; x < less; ++x) {
            const Cover& part = to.covers[x];
            for (int i = 0; i < 3; ++i)
                if (part.weight[i] != 0.0f) mean[x] += light[part.first + i] * (part.weight[i] * w);
        }
    }
    if ((std::int64_t{to.row} + 1) * fine <= (std::int64_t{y} + 1) * coarse) finish_row(k + 1);
}

void LevelWriter::finish_row(std::size_t k) {
    Part& part = m_parts[k];
    const TextureLevel& level = m_levels[k];
    const std::size_t texel = byte_size(level.type);
    part.light.swap(part.mean);
    part.mean.swap(part.later);
    std::fill(part.later.begin(), part.later.end(), Vec4f(0.0f));
    std::vector<std::byte> stored;
    if (k >= m_stored.begin) stored.resize(texel * level.width);
    for (std::size_t at = 0; at < stored.size(); at += texel)
        store_texel(part.light[at / texel], stored.data() + at, level.type);
    store_row(k, stored.data());
}

void LevelWriter::write_tiles(std::size_t k) {
    const TextureLevel& level = m_levels[k];
    const Part& part = m_parts[k];
    const int down = (part.row - 1) >> level.tile_rows;
    const std::size_t texel = byte_size(level.type), row = texel * level.width;
    for (int across = 0; across < level.tiles_across; ++across) {
        auto tile = std::make_unique<Tile>(level.shape(across, down));
        const std::size_t bytes = texel * tile->shape.width;
        const std::byte* from =
            part.strip.data() + texel * (std::size_t(across) << level.tile_columns);
        for (int y = 0; y < tile->shape.height; ++y)
            std::memcpy(tile->texels.get() + y * bytes, from + y * row, bytes);
        m_cache.insert(level.slot(across, down), std::move(tile), false);
    }
}

}  // namespace granita
