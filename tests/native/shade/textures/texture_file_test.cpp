// SPDX-License-Identifier: GPL-3.0-or-later
// Files are read as they are meant, whatever their layout; damaged ones are named, and nothing else
// happens.
#include "shade/textures/texture_file.h"

#include <gtest/gtest.h>

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

// Values: Blender's own conversion, image.pixels of a float file in that space (4.5), of .2, .5,
// .8.
TEST(TextureFile, colour_spaces_become_scene_linear) {
    EXPECT_FALSE(find_color_space("AgX Base sRGB"));
    EXPECT_FALSE(find_color_space("nonsense"));
    const auto white = [](const char* name) { return find_color_space(name)->linear(Vec3f(1.0f)); };
    for (const char* name : {"ACEScg", "Linear ACES", "Linear Rec.2020", "Display P3", "Rec.2020",
                             "sRGB", "Linear FilmLight E-Gamut", "Linear DCI-P3 D65"})
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(white(name)[k], 1.0f, 1e-3) << name;  // white is white
    EXPECT_NEAR(find_color_space("Rec.1886")->linear(Vec3f(0.5f)).x, std::pow(0.5f, 2.4f), 1e-6);
    EXPECT_NEAR(find_color_space("Filmic Log")->linear(Vec3f(0.606060606f)).x, 0.18f,
                1e-4);  // middle grey
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
