// SPDX-License-Identifier: GPL-3.0-or-later
// Levels keep the light of what they cover; look-ups return what the image holds.
#include "shade/texture_pyramid.h"

#include <gtest/gtest.h>

#include "shade/texture.h"

namespace granita {
namespace {

Image image_of(int width, int height, const std::vector<Vec3f>& colors, const char* space) {
    Image image;
    image.name = "Image";
    image.colorspace = space;
    image.width = width;
    image.height = height;
    for (const Vec3f& c : colors) image.pixels.insert(image.pixels.end(), {c.x, c.y, c.z, 1.0f});
    return image;
}

TEST(TexturePyramid, the_mean_of_black_and_white_is_half_the_light_in_srgb_too) {
    TextureLevel level{2, 1, {0, 0, 0, 255, 255, 255, 255, 255}, {}};
    const TextureLevel half = half_level(level, TexelKind::EncodedByte);
    ASSERT_EQ(half.bytes.size(), 4u);
    EXPECT_EQ(half.bytes[0], 188);  // sRGB's byte for one half
}

TEST(TexturePyramid, alpha_is_linear_beside_encoded_colours) {
    TextureLevel level{2, 1, {255, 255, 255, 0, 255, 255, 255, 255}, {}};
    EXPECT_EQ(half_level(level, TexelKind::EncodedByte).bytes[3], 128);
    TextureLevel floats{2, 1, {}, {1, 1, 1, 0, 1, 1, 1, 0.5f}};
    EXPECT_FLOAT_EQ(half_level(floats, TexelKind::EncodedFloat).floats[3], 0.25f);
}

TEST(TexturePyramid, odd_sizes_lose_no_texel) {
    TextureLevel level{3, 1, {}, {3, 0, 0, 1, 6, 0, 0, 1, 9, 0, 0, 1}};
    const TextureLevel half = half_level(level, TexelKind::LinearFloat);
    EXPECT_EQ(half.width, 1);
    EXPECT_FLOAT_EQ(half.floats[0], 6.0f);
}

struct Look {
    Scene scene;
    Statistics statistics;
    Report report;

    Vec4f at(const Image& image, Vec2f center, float size, TextureMode mode = {}) {
        return at(image, TexturePlace{center, Vec2f(size, 0), Vec2f(0, size)}, mode);
    }
    Vec4f at(const Image& image, const TexturePlace& place, TextureMode mode = {}) {
        scene.images = {image};
        TextureStore store(scene, statistics, report);
        std::vector<Vec4f> out;
        store.find("Image", "node 'N'")->look_up(mode, {place}, out);
        return out[0];
    }
};

TEST(Texture, first_row_is_below) {
    const Image image = image_of(1, 2, {{1, 0, 0}, {0, 1, 0}}, "Non-Color");
    TextureMode closest;
    closest.filter = TextureFilter::Closest;
    EXPECT_EQ(Look().at(image, {0.5f, 0.25f}, 0, closest), Vec4f(1, 0, 0, 1));
    EXPECT_EQ(Look().at(image, {0.5f, 0.75f}, 0, closest), Vec4f(0, 1, 0, 1));
}

TEST(Texture, a_footprint_over_everything_sees_the_mean) {
    std::vector<Vec3f> colors;
    for (int i = 0; i < 64 * 64; ++i) colors.push_back(Vec3f((i / 64 + i) % 2 ? 1.0f : 0.0f));
    const Image image = image_of(64, 64, colors, "sRGB");
    EXPECT_NEAR(Look().at(image, {0.3f, 0.7f}, 1.0f).x, 0.5f, 0.01f);
}

TEST(Texture, a_footprint_across_stripes_sees_the_mean_of_their_light) {
    std::vector<Vec3f> colors;
    for (int i = 0; i < 64 * 64; ++i) colors.push_back(Vec3f(i % 2 ? 1.0f : 0.0f));
    for (const char* space : {"sRGB", "Non-Color"}) {
        const Image image = image_of(64, 64, colors, space);
        const TexturePlace across{{0.5f, 0.5f}, {8.0f / 64, 0}, {0, 1.0f / 64}};
        EXPECT_NEAR(Look().at(image, across).x, 0.5f, 0.03f) << space;
    }
}

TEST(Texture, missing_file_is_magenta_and_named) {
    Look look;
    Image image;
    image.name = "Image";
    image.path = "/nowhere/at/all.png";
    EXPECT_EQ(look.at(image, {0.5f, 0.5f}, 0), Vec4f(1, 0, 1, 1));
    ASSERT_EQ(look.report.warnings().size(), 1u);
    EXPECT_EQ(look.report.warnings()[0].datablock, "image 'Image'");
}

}  // namespace
}  // namespace granita
