// SPDX-License-Identifier: GPL-3.0-or-later
// Each texel of a level is the mean of the light that it covers.
#include "shade/textures/texture_levels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

namespace granita {
namespace {

/// All texels of level k, as they are stored.
std::vector<Vec4f> texels_of(const TextureLevel& level) {
    std::vector<Vec4f> out;
    for (int y = 0; y < level.height; ++y)
        for (int x = 0; x < level.width; ++x) {
            const int across = x >> level.tile_columns, down = y >> level.tile_rows;
            const Tile* tile = level.slot(across, down).look();
            out.push_back(stored_texel(
                tile->at(x - (across << level.tile_columns), y - (down << level.tile_rows)),
                level.type));
        }
    return out;
}

struct Made {
    Report report;
    TileCache cache{1u << 30, report};
    TextureLevels levels;

    Made(int width, int height, TexelType type, const TexelDecoder& decoder,
         const std::vector<std::byte>& rows, int at_once = 1) {
        levels = make_levels(width, height, type);
        LevelWriter writer(levels, decoder, cache);
        const std::size_t row = byte_size(type) * width;
        for (int y = 0; y < height; y += at_once)
            writer.push(rows.data() + y * row, std::min(at_once, height - y));
    }
};

std::vector<std::byte> bytes_of(const std::vector<std::uint8_t>& values) {
    std::vector<std::byte> out(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) out[i] = std::byte{values[i]};
    return out;
}

TEST(TextureLevels, the_mean_of_black_and_white_is_half_the_light_in_srgb_too) {
    const Made made(2, 1, TexelType::Byte, {true, false},
                    bytes_of({0, 0, 0, 255, 255, 255, 255, 255}));
    ASSERT_EQ(made.levels.size(), 2u);
    EXPECT_EQ(made.levels[1].type, TexelType::Half);
    EXPECT_EQ(texels_of(made.levels[1])[0], Vec4f(0.5f, 0.5f, 0.5f, 1.0f));
}

TEST(TextureLevels, alpha_is_linear_beside_encoded_colours) {
    const Made made(2, 1, TexelType::Byte, {true, false},
                    bytes_of({255, 255, 255, 0, 255, 255, 255, 255}));
    EXPECT_EQ(texels_of(made.levels[1])[0].w, 0.5f);
}

// Sizes of all kinds: level k's texel covers the part of the image that is under it.
TEST(TextureLevels, every_texel_is_the_mean_of_what_it_covers) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> number(0.0f, 10.0f);
    for (const auto& [width, height] :
         {std::pair{1, 1}, {3, 1}, {5, 7}, {64, 64}, {65, 130}, {200, 3}}) {
        std::vector<float> values(static_cast<std::size_t>(width) * height * 4);
        for (float& v : values) v = number(random);
        std::vector<std::byte> rows(values.size() * sizeof(float));
        std::memcpy(rows.data(), values.data(), rows.size());
        const Made made(width, height, TexelType::Float, {}, rows, 7);
        EXPECT_EQ(made.levels.back().width, 1);
        EXPECT_EQ(made.levels.back().height, 1);
        for (std::size_t k = 1; k < made.levels.size(); ++k) {
            const TextureLevel &fine = made.levels[k - 1], &coarse = made.levels[k];
            const std::vector<Vec4f> from = texels_of(fine), to = texels_of(coarse);
            const double sx = double(fine.width) / coarse.width,
                         sy = double(fine.height) / coarse.height;
            for (int y = 0; y < coarse.height; ++y)
                for (int x = 0; x < coarse.width; ++x) {
                    double sum = 0.0;
                    for (int v = 0; v < fine.height; ++v)
                        for (int u = 0; u < fine.width; ++u) {
                            const double w =
                                std::min(u + 1.0, (x + 1) * sx) - std::max<double>(u, x * sx);
                            const double h =
                                std::min(v + 1.0, (y + 1) * sy) - std::max<double>(v, y * sy);
                            if (w > 0.0 && h > 0.0) sum += w * h * from[v * fine.width + u].x;
                        }
                    // Single precision, nine terms of at most 10.
                    EXPECT_NEAR(to[y * coarse.width + x].x, sum / (sx * sy), 1e-5)
                        << width << " x " << height << ", level " << k;
                }
        }
    }
}

/// Whether any texel of a level is there.
bool is_stored(const TextureLevel& level) {
    for (int i = 0; i < level.tiles_across * level.tiles_down; ++i)
        if (level.slots[i].look()) return true;
    return false;
}

// Coarse levels first, the rest by a second pass over the rows: as all by one.
TEST(TextureLevels, levels_made_apart_are_those_made_together) {
    std::mt19937 random(9);
    for (const auto& [width, height] : {std::pair{1, 1}, {5, 7}, {130, 65}, {128, 256}}) {
        std::vector<std::byte> rows(byte_size(TexelType::Byte) * width * height);
        for (std::byte& b : rows) b = std::byte(random() % 256);
        const TexelDecoder decoder{true, false};
        const Made whole(width, height, TexelType::Byte, decoder, rows);
        for (std::size_t first = 0; first < whole.levels.size(); ++first) {
            Report report;
            TileCache cache(1u << 30, report);
            const TextureLevels levels = make_levels(width, height, TexelType::Byte);
            LevelWriter(levels, decoder, cache, {first}).push(rows.data(), height);
            for (std::size_t k = 0; k < levels.size(); ++k)
                ASSERT_EQ(is_stored(levels[k]), k >= first);
            EXPECT_EQ(cache.byte_count(), byte_count_from(levels, first));
            if (first > 0)
                LevelWriter(levels, decoder, cache, {0, first}).push(rows.data(), height);
            EXPECT_EQ(cache.byte_count(), byte_count_from(levels, 0));
            for (std::size_t k = 0; k < levels.size(); ++k)
                ASSERT_EQ(texels_of(levels[k]), texels_of(whole.levels[k]))
                    << width << " x " << height << ", level " << k << ", first " << first;
        }
    }
}

TEST(TextureLevels, half_floats_are_rounded_to_the_nearest) {
    for (std::uint32_t h = 0; h < 0x7c00u; ++h) {
        const float exact = float_from_half(static_cast<std::uint16_t>(h));
        ASSERT_EQ(half_from_float(exact), h);
        ASSERT_EQ(half_from_float(-exact), h | 0x8000u);
        if (h == 0) continue;
        const float before = float_from_half(static_cast<std::uint16_t>(h - 1));
        const float middle =
            0.5f * (before + exact);  // exact in single precision: the even one wins
        ASSERT_EQ(half_from_float(middle), h & 1u ? h - 1 : h);
        ASSERT_EQ(half_from_float(std::nextafter(middle, 1e9f)), h);
    }
    EXPECT_EQ(float_from_half(0x0001), 0x1p-24f);
    EXPECT_EQ(float_from_half(0x3c00), 1.0f);
    EXPECT_EQ(float_from_half(half_from_float(1e9f)), kLargestHalf);
}

}  // namespace
}  // namespace granita
