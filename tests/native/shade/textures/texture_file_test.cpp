// SPDX-License-Identifier: GPL-3.0-or-later
// Files are read as they are meant, whatever their layout; damaged ones are named, and nothing else
// happens.
#include "shade/textures/texture_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "shade/textures/image_mutations.h"
#include "shade/textures/texture_filter.h"
#include "shade/textures/texture_scene.h"

namespace granita {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(TextureFile, levels_of_a_tiled_file_are_served_as_they_are) {
    for (const char* suffix : {".tif", ".exr"}) {
        ImageFile file(suffix);
        // No mean of the finer ones: what is seen is the file's own.
        ASSERT_TRUE(write_image(
            file, 128, [](int level, int, int) { return 100.0f + level; }, 64, true));
        Look look(file.image("Non-Color"));
        EXPECT_FLOAT_EQ(look.at({0.3f, 0.3f}, 1.0f / 128).x, 100.0f) << suffix;
        EXPECT_FLOAT_EQ(look.at({0.3f, 0.3f}, 2.0f / 128).x, 101.0f) << suffix;
        EXPECT_FLOAT_EQ(look.at({0.3f, 0.3f}, 8.0f / 128).x, 103.0f) << suffix;
        EXPECT_FLOAT_EQ(look.at({0.3f, 0.3f}, 1.0f).x, 107.0f) << suffix;
    }
}

TEST(TextureFile, a_tiled_file_without_levels_is_given_some) {
    ImageFile file(".exr");
    ASSERT_TRUE(write_image(
        file, 100, [](int, int x, int) { return x % 2 ? 3.0f : 1.0f; }, 24));
    Look look(file.image("Non-Color"));
    EXPECT_FLOAT_EQ(look.at({0.305f, 0.3f}, 0.0f).x, 1.0f);
    EXPECT_FLOAT_EQ(look.at({0.3f, 0.3f}, 2.0f / 100).x, 2.0f);
}

// In bytes of sRGB, 200 half covered is 200 * 128 / 255 = 100.4; of their light it would be 146.
TEST(TextureFile, alpha_of_png_multiplies_what_is_stored) {
    for (const OIIO::TypeDesc& type : {OIIO::TypeUInt8, OIIO::TypeUInt16}) {
        ImageFile file(".png");
        OIIO::ImageSpec spec(2, 1, 4, type);
        spec.attribute("oiio:UnassociatedAlpha", 1);
        const float c = 200 / 255.0f, a = 128 / 255.0f;
        const float texels[] = {c, c, c, a, c, c, c, 1.0f};
        const auto out = OIIO::ImageOutput::create(file.path());
        ASSERT_TRUE(out && out->open(file.path(), spec) &&
                    out->write_image(OIIO::TypeFloat, texels) && out->close());
        Image image = file.image("sRGB");
        image.alpha_mode = "STRAIGHT";
        Look look(image);
        const Vec4f half = look.at({0.25f, 0.5f}, 0.0f), whole = look.at({0.75f, 0.5f}, 0.0f);
        const bool bytes = type == OIIO::TypeUInt8;
        EXPECT_NEAR(half.x, linear_from_srgb(bytes ? 100 / 255.0f : c * a), bytes ? 1e-5 : 1e-4);
        EXPECT_NEAR(whole.x, linear_from_srgb(c), 1e-4);
        EXPECT_NEAR(half.w, a, 1e-4);
    }
}

// What is said of alpha, whatever the format says of it: OpenEXR is always associated, PNG never.
// Bytes are rounded, and their products cut off: 1.5 / 255.
TEST(TextureFile, alpha_is_what_it_is_said_to_be) {
    for (const char* suffix : {".png", ".exr"}) {
        ImageFile file(suffix);
        OIIO::ImageSpec spec(1, 1, 4,
                             suffix == std::string(".png") ? OIIO::TypeUInt8 : OIIO::TypeHalf);
        spec.attribute("oiio:UnassociatedAlpha", 1);
        const float texel[] = {0.2f, 0.4f, 0.6f, 0.8f};
        const auto out = OIIO::ImageOutput::create(file.path());
        ASSERT_TRUE(out && out->open(file.path(), spec) &&
                    out->write_image(OIIO::TypeFloat, texel) && out->close());
        for (const char* mode : {"ASSOCIATED", "UNASSOCIATED"}) {
            Image image = file.image("scene_linear");
            image.alpha_mode = mode;
            const Vec4f found = Look(image).at({0.5f, 0.5f}, 0.0f);
            const float times = mode == std::string("ASSOCIATED") ? 1.0f : 0.8f;
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], texel[k] * times, 6e-3) << mode;
            EXPECT_NEAR(found.w, 0.8f, 1e-3);
        }
    }
}

// Tiles and levels that are served as the file has them.
TEST(TextureFile, alpha_of_tiles_is_what_it_is_said_to_be) {
    ImageFile file(".tif");
    const auto out = OIIO::ImageOutput::create(file.path());
    ASSERT_TRUE(out);
    for (int size = 64, level = 0; size > 0; size /= 2, ++level) {
        OIIO::ImageSpec spec(size, size, 4, OIIO::TypeFloat);
        spec.tile_width = spec.tile_height = 16;
        spec.attribute("textureformat", "Plain Texture");
        spec.attribute("oiio:UnassociatedAlpha", 1);
        std::vector<float> texels;
        for (int i = 0; i < size * size; ++i) texels.insert(texels.end(), {0.2f, 0.4f, 0.6f, 0.5f});
        const auto mode = level ? OIIO::ImageOutput::AppendSubimage : OIIO::ImageOutput::Create;
        ASSERT_TRUE(out->open(file.path(), spec, mode) &&
                    out->write_image(OIIO::TypeFloat, texels.data()));
    }
    ASSERT_TRUE(out->close());
    Image image = file.image("scene_linear");
    for (const char* mode : {"ASSOCIATED", "UNASSOCIATED"}) {
        image.alpha_mode = mode;
        const float times = mode == std::string("ASSOCIATED") ? 1.0f : 0.5f;
        for (const float width : {0.0f, 0.1f})
            EXPECT_NEAR(Look(image).at({0.4f, 0.6f}, width).y, 0.4f * times, 1e-3f) << mode;
    }
}

TEST(TextureFile, what_is_no_number_is_black) {
    ImageFile file(".exr");
    const float values[] = {NAN, INFINITY, -INFINITY, 4.0f};
    ASSERT_TRUE(write_image(file, 2, [&](int, int x, int y) { return values[y * 2 + x]; }));
    EXPECT_FLOAT_EQ(Look(file.image("Non-Color")).at({0.5f, 0.5f}, 1.0f).x, 1.0f);
}

void put32(Bytes& to, std::uint32_t value) {
    for (int k = 3; k >= 0; --k) to.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
}

Bytes png_of(std::uint32_t width, std::uint32_t height) {
    Bytes png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    put32(png, 13);
    for (const char c : {'I', 'H', 'D', 'R'}) png.push_back(static_cast<std::uint8_t>(c));
    put32(png, width);
    put32(png, height);
    for (const int c : {8, 6, 0, 0, 0}) png.push_back(static_cast<std::uint8_t>(c));
    put32(png, 0);  // checksums
    put32(png, 0);
    for (const char c : {'I', 'D', 'A', 'T'}) png.push_back(static_cast<std::uint8_t>(c));
    put32(png, 0);
    seal_png(png);
    return png;
}

Bytes radiance_of(const std::string& size) {
    const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n";
    return {head.begin(), head.end()};
}

TEST(TextureFile, headers_of_impossible_sizes_end_in_a_warning) {
    const std::pair<const char*, Bytes> files[] = {{".png", png_of(0x7fffffff, 0x7fffffff)},
                                                   {".png", png_of(70000, 3)},
                                                   {".png", png_of(65536, 65536)},
                                                   {".png", png_of(0, 0)},
                                                   {".png", png_of(20000, 20000)},
                                                   {".hdr", radiance_of("-Y 0 +X 0")},
                                                   {".hdr", radiance_of("-Y 0 +X 100")},
                                                   {".hdr", radiance_of("-Y -5 +X 2147483647")},
                                                   {".hdr", radiance_of("-Y 60000 +X 60000")}};
    for (const auto& [suffix, bytes] : files) {
        ImageFile file(suffix);
        file.write(bytes);
        Look look(file.image());
        EXPECT_EQ(look.at({0.5f, 0.5f}, 0.1f), kMagenta);
        ASSERT_EQ(look.warnings().size(), 1u);
        EXPECT_EQ(look.warnings()[0].datablock, "image 'Image'");
    }
}

TEST(TextureFile, no_attribute_of_openexr_takes_more_than_its_file_has) {
    // A comment of 2 GiB, of which the file has nothing.
    const std::string_view header("\x76\x2f\x31\x01\x02\0\0\0comments\0string\0\xff\xff\xff\x7f",
                                  28);
    ImageFile file(".exr");
    file.write({header.begin(), header.end()});
    rusage before{}, after{};
    getrusage(RUSAGE_SELF, &before);
    EXPECT_EQ(read_texture_header(file.image()).error, "its header is damaged");
    getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100 * 1024);  // KiB
}

/// Of 32-bit floats, whose tiles are all at the same place: their data are not there.
Bytes tiff_of(std::uint32_t width, std::uint32_t height, std::uint32_t tile,
              std::uint16_t channels) {
    Bytes tiff;
    const auto put = [&tiff](std::uint32_t value, int bytes) {
        for (int k = 0; k < bytes; ++k) tiff.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
    };
    const std::uint32_t tiles = (width / tile) * (height / tile);
    struct Tag {
        std::uint32_t number, bytes, count, value;
    };
    const Tag tags[] = {{256, 4, 1, width},
                        {257, 4, 1, height},
                        {258, 2, channels, 32},
                        {259, 2, 1, 1},
                        {262, 2, 1, 2},
                        {277, 2, 1, channels},
                        {284, 2, 1, 1},
                        {322, 4, 1, tile},
                        {323, 4, 1, tile},
                        {324, 4, tiles, 8},
                        {325, 4, tiles, tile * 4},
                        {339, 2, channels, 3}};
    put(0x002a4949, 4);
    put(8, 4);
    put(std::size(tags), 2);
    std::uint32_t apart = 8 + 2 + 12 * std::size(tags) + 4;
    for (const Tag& tag : tags) {
        put(tag.number, 2);
        put(tag.bytes == 2 ? 3 : 4, 2);
        put(tag.count, 4);
        const bool fits = tag.bytes * tag.count <= 4;
        put(fits ? tag.value : apart, 4);
        if (!fits) apart += tag.bytes * tag.count;
    }
    put(0, 4);
    for (const Tag& tag : tags)
        for (std::uint32_t k = 0; tag.bytes * tag.count > 4 && k < tag.count; ++k)
            put(tag.value, static_cast<int>(tag.bytes));
    return tiff;
}

/// Of this process until now.
std::uint64_t peak_of_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
}

TEST(TextureFile, headers_of_large_tiles_take_no_memory) {
    // A row of tiles as texels: 2 GiB; a tile of many channels: 4 GiB.
    for (const Bytes& bytes : {tiff_of(65536, 16384, 2048, 4), tiff_of(4096, 4096, 4096, 64)}) {
        ImageFile file(".tif");
        file.write(bytes);
        const std::uint64_t before = peak_of_memory();
        Look look(file.image());
        EXPECT_EQ(look.at({0.5f, 0.5f}, 0.1f), kMagenta);
        ASSERT_EQ(look.warnings().size(), 1u);
        EXPECT_NE(look.warnings()[0].message.find("too large"), std::string::npos)
            << look.warnings()[0].message;
        EXPECT_LT(peak_of_memory() - before, std::uint64_t{256} << 20);
    }
}

TEST(TextureFile, what_is_no_file_of_an_image_is_named) {
    ImageFile empty(".png"), text(".jpg"), sgi(".rgb");
    empty.write({});
    text.write({'h', 'e', 'l', 'l', 'o'});
    sgi.write({0x01, 0xda, 0, 1, 0, 2});
    for (const auto& [file, why] :
         {std::pair{&empty, "empty"}, {&text, "not known"}, {&sgi, "SGI"}}) {
        const TextureFile read(file->image());
        EXPECT_NE(read.error().find(why), std::string::npos) << read.error();
    }
    Image pipe;
    pipe.path = "/dev/zero";
    EXPECT_EQ(TextureFile(pipe).error(), "it is no file");
}

// The same as bench/damaged_images.cpp, which runs a hundred thousand in processes of their own.
TEST(TextureFile, damaged_files_are_pictures_or_warnings) {
    for (const SeedFormat& format : kSeedFormats) {
        ImageFile seed(format.suffix);
        if (!write_seed(format, seed.path())) continue;
        const Bytes whole = seed.read();
        std::mt19937 random(1);
        ImageFile damaged(format.suffix);
        for (int k = 0; k < 12; ++k) {
            damaged.write(mutated(whole, random));
            Look look(damaged.image());
            for (const float size : {0.0f, 0.1f, 1.0f}) {
                const Vec4f seen = look.at({0.4f, 0.6f}, size);
                for (int c = 0; c < 4; ++c)
                    ASSERT_TRUE(std::isfinite(seen[c]))
                        << format.suffix << ' ' << format.compression << ' ' << k;
                if (seen == kMagenta) {
                    ASSERT_EQ(look.warnings().size(), 1u);
                }
            }
        }
    }
}

}  // namespace
}  // namespace granita
