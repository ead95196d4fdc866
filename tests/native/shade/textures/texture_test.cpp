// SPDX-License-Identifier: GPL-3.0-or-later
// Look-ups return what the image holds, and means of its light however small it is seen.
#include "shade/textures/texture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/srgb.h"
#include "shade/textures/texel.h"
#include "shade/textures/texture_scene.h"

namespace granita {
namespace {

double mean_of(const std::vector<Vec4f>& colors) {
    double sum = 0.0;
    for (const Vec4f& c : colors) sum += c.x;
    return sum / static_cast<double>(colors.size());
}

double mean_light(const std::vector<std::uint8_t>& grey) {
    double sum = 0.0;
    for (const std::uint8_t g : grey) sum += linear_from_srgb(g / 255.0f);
    return sum / static_cast<double>(grey.size());
}

TEST(Texture, first_row_is_below) {
    const Image image = image_of(1, 2, {{1, 0, 0}, {0, 1, 0}}, "Non-Color");
    TextureMode closest;
    closest.filter = TextureFilter::Closest;
    EXPECT_EQ(Look(image).at({0.5f, 0.25f}, 0, closest), Vec4f(1, 0, 0, 1));
    EXPECT_EQ(Look(image).at({0.5f, 0.75f}, 0, closest), Vec4f(0, 1, 0, 1));
}

// Random blocks: the mean of light is that of the texels, whatever their size and the footprint's.
// Blocks of 1 are the hardest for filters of encoded numbers near one texel a pixel, of 4 from
// there to eight.
TEST(Texture, the_mean_of_light_is_kept_at_every_minification) {
    constexpr int kSize = 64;
    for (const int block : {1, 4}) {
        const auto grey = random_blocks(kSize, block, 7);
        const Image image = image_of_bytes(kSize, kSize, grey);
        const double truth = mean_light(grey);
        Look look(image);
        for (const float texels :
             {1.0f, 1.3f, 2.0f, 2.9f, 4.0f, 8.0f, 11.0f, 16.0f, 50.0f, 300.0f}) {
            const auto places = places_all_over(kSize, kSize, texels, texels, 0.0f);
            // Half floats are right to 5e-4; places are one a texel.
            EXPECT_NEAR(mean_of(look.at(places)) / truth, 1.0, 0.002)
                << "blocks of " << block << ", " << texels << " texels a pixel";
        }
    }
}

TEST(Texture, the_mean_of_light_is_kept_where_the_surface_is_tilted) {
    constexpr int kSize = 64;
    const auto grey = random_blocks(kSize, 4, 3);
    Look look(image_of_bytes(kSize, kSize, grey));
    for (const float shorter : {0.25f, 1.0f, 3.0f})
        for (const float ratio : {2.0f, 5.0f, 16.0f, 40.0f})
            for (const float angle : {0.0f, 0.6f, 1.5708f, 2.2f}) {
                if (shorter * ratio < 1.0f) continue;
                const auto places = places_all_over(kSize, kSize, shorter * ratio, shorter, angle);
                EXPECT_NEAR(mean_of(look.at(places)) / mean_light(grey), 1.0, 0.002)
                    << shorter << " x " << shorter * ratio << " turned " << angle;
            }
}

TEST(Texture, nothing_jumps_as_a_texture_shrinks) {
    constexpr int kSize = 64;
    const Image image = image_of_bytes(kSize, kSize, random_blocks(kSize, 1, 11));
    for (const TextureFilter filter :
         {TextureFilter::Linear, TextureFilter::Cubic, TextureFilter::Closest}) {
        Look look(image);
        TextureMode mode;
        mode.filter = filter;
        for (const float ratio : {1.0f, 3.7f, 30.0f}) {
            std::vector<Vec4f> before;
            for (float texels = 0.3f; texels < 40.0f; texels *= 1.01f) {
                const auto now =
                    look.at(places_all_over(6, kSize, texels * ratio, texels, 0.4f), mode);
                for (std::size_t i = 0; i < before.size(); ++i)
                    // No part of a footprint moves by more than its share, 1 %, of what differs
                    // by 1.
                    ASSERT_NEAR(before[i].x, now[i].x, 0.05) << texels << " x " << texels * ratio;
                before = now;
            }
        }
    }
}

// Cycles interpolates the bytes and decodes what comes out.
TEST(Texture, magnified_texels_are_interpolated_as_they_are_stored) {
    const Image image = image_of_bytes(2, 1, {0, 255});
    TextureMode mode;
    mode.extension = TextureExtension::Extend;
    for (const float texels : {0.0f, 0.1f, 0.5f})
        EXPECT_NEAR(Look(image).at({0.5f, 0.5f}, texels / 2, mode).x, linear_from_srgb(0.5f), 1e-6)
            << texels;
    EXPECT_NEAR(Look(image).at({0.5f, 0.5f}, 0.5f, mode).x, 0.5f, 1e-6);
}

TEST(Texture, a_footprint_over_everything_sees_the_mean) {
    std::vector<Vec3f> colors;
    for (int i = 0; i < 64 * 64; ++i) colors.push_back(Vec3f((i / 64 + i) % 2 ? 1.0f : 0.0f));
    const Image image = image_of(64, 64, colors, "sRGB");
    EXPECT_NEAR(Look(image).at({0.3f, 0.7f}, 1.0f).x, 0.5f, 1e-6);
}

TEST(Texture, a_footprint_across_stripes_sees_the_mean_of_their_light) {
    std::vector<std::uint8_t> grey;
    for (int i = 0; i < 64 * 64; ++i) grey.push_back(i % 2 ? 255 : 0);
    const TexturePlace across{{0.5f, 0.5f}, {8.0f / 64, 0}, {0, 1.0f / 64}};
    EXPECT_NEAR(Look(image_of_bytes(64, 64, grey)).at({across})[0].x, 0.5f, 1e-6);
}

// A leaf's mask: half of it is there, and where it is it is white.  Dividing after decoding
// gave 2.4.
TEST(Texture, divided_by_alpha_a_half_covered_texel_keeps_its_colour) {
    Image image;
    image.name = "Image";
    image.width = image.height = 8;
    for (int i = 0; i < 64; ++i) {
        const float a = i % 2 ? 1.0f : 0.0f, c = a * linear_from_srgb(200 / 255.0f);
        image.pixels.insert(image.pixels.end(), {c, c, c, a});
    }
    TextureMode mode;
    mode.unassociate = true;
    const Vec4f far = Look(image).at({0.5f, 0.5f}, 1.0f, mode);
    EXPECT_NEAR(far.x, linear_from_srgb(200 / 255.0f), 1e-3);  // a half float's 5e-4, and alpha's
    EXPECT_NEAR(far.w, 0.5f, 1e-6);
}

// Each texel is the light of its bytes, as floats of the same light are.
TEST(Texture, bytes_are_decoded_as_srgb_and_their_alpha_is_not) {
    Image image;
    image.name = "Image";
    image.width = 256;
    image.height = 2;
    for (int i = 0; i < 512; ++i) {
        const auto c = static_cast<std::uint8_t>(i % 256);
        const auto alpha = static_cast<std::uint8_t>(i < 256 ? 255 : 51);
        image.bytes.insert(image.bytes.end(), {c, c, c, alpha});
    }
    for (const char* mode : {"STRAIGHT", "NONE"}) {
        image.alpha_mode = mode;
        Look look(image);
        for (int i = 0; i < 512; ++i) {
            const Vec2f centre((float(i % 256) + 0.5f) / 256, (float(i / 256) + 0.5f) / 2);
            const Vec4f found = look.at(centre, 0.0f);
            EXPECT_NEAR(found.x, linear_from_srgb(float(i % 256) / 255), 1e-5) << i;
            const bool covered = i < 256 || image.alpha_mode == "NONE";
            EXPECT_NEAR(found.w, covered ? 1.0f : 0.2f, 1e-6) << i;
        }
    }
}

TEST(Texture, bytes_of_stripes_are_a_mean_of_their_light_from_far) {
    Image image;
    image.name = "Image";
    image.width = image.height = 64;
    for (int i = 0; i < 64 * 64; ++i) {
        const std::uint8_t c = i % 2 ? 255 : 0;
        image.bytes.insert(image.bytes.end(), {c, c, c, 255});
    }
    EXPECT_NEAR(Look(image).at({0.3f, 0.7f}, 1.0f).x, 0.5f, 1e-6);
}

TEST(Texture, the_rim_is_wrapped_as_asked) {
    const Image image = image_of(4, 1, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, "Non-Color");
    const auto at = [&](TextureExtension extension, float x) {
        TextureMode mode;
        mode.extension = extension;
        return Look(image).at({x, 0.5f}, 0.0f, mode);
    };
    EXPECT_FLOAT_EQ(at(TextureExtension::Repeat, 1.0f).x, 1.5f);  // between 3 and 0
    EXPECT_FLOAT_EQ(at(TextureExtension::Repeat, -7.625f).x, 1.0f);
    EXPECT_FLOAT_EQ(at(TextureExtension::Extend, 1.0f).x, 3.0f);
    EXPECT_FLOAT_EQ(at(TextureExtension::Extend, -90.0f).x, 0.0f);
    EXPECT_FLOAT_EQ(at(TextureExtension::Mirror, 1.125f).x, 3.0f);
    EXPECT_FLOAT_EQ(at(TextureExtension::Mirror, 1.875f).x, 0.0f);
    EXPECT_EQ(at(TextureExtension::Clip, 1.2f), Vec4f(0.0f));
    EXPECT_FLOAT_EQ(at(TextureExtension::Clip, 1.0f).w, 0.5f);
}

// Four columns.  What is wider than they are sees mostly the rim, or what is beyond it alone.
TEST(Texture, beams_wider_than_an_image_see_what_is_beyond_it) {
    const Image image = image_of(4, 1, {{3, 0, 0}, {1, 0, 0}, {2, 0, 0}, {4, 0, 0}}, "Non-Color");
    const auto seen = [&](TextureExtension extension, Vec2f from_to) {
        TextureMode mode;
        mode.extension = extension;
        const float width = from_to.y - from_to.x;
        const TexturePlace place{{from_to.x + width / 2, 0.5f}, {width, 0.0f}, {0.0f, 0.1f}};
        return Look(image).at({place}, mode)[0];
    };
    const float mean = 10.0f / 4;
    EXPECT_NEAR(seen(TextureExtension::Extend, {-5, 6}).x, (5 * 3 + 5 * 4 + mean) / 11, 1e-5);
    EXPECT_NEAR(seen(TextureExtension::Extend, {-1, 9}).x, (3 + 8 * 4 + mean) / 10, 1e-5);
    EXPECT_NEAR(seen(TextureExtension::Extend, {-6, -1}).x, 3.0f, 1e-5);
    EXPECT_NEAR(seen(TextureExtension::Extend, {2, 3}).x, 4.0f, 1e-5);
    EXPECT_NEAR(seen(TextureExtension::Extend, {4.99f, 5.01f}).x, 4.0f, 1e-4);
    for (const Vec2f beam : {Vec2f(-5, 6), Vec2f(-1, 9), Vec2f(-6, -1), Vec2f(4.99f, 5.01f)})
        EXPECT_NEAR(seen(TextureExtension::Extend, beam).w, 1.0f, 1e-4);
    EXPECT_NEAR(seen(TextureExtension::Clip, {-5, 6}).x, mean / 11, 1e-5);
    EXPECT_NEAR(seen(TextureExtension::Clip, {-1, 9}).x, mean / 10, 1e-5);
    EXPECT_EQ(seen(TextureExtension::Clip, {1, 3.5}), Vec4f(0.0f));
    EXPECT_NEAR(seen(TextureExtension::Clip, {-5, 6}).w, 1.0f / 11, 1e-6);
    EXPECT_NEAR(seen(TextureExtension::Repeat, {-5, 6}).x, mean, 1e-5);
}

TEST(Texture, places_that_are_no_numbers_are_black_and_footprints_that_are_none_see_everything) {
    const Image image = image_of(4, 1, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, "Non-Color");
    const float none = std::nanf(""), endless = INFINITY;
    for (const float x : {none, endless, -endless, 1e30f})
        EXPECT_EQ(Look(image).at({x, 0.5f}, 0.1f), Vec4f(0.0f)) << x;
    for (const float size : {none, endless, 1e30f, 1e9f})
        EXPECT_NEAR(Look(image).at({0.2f, 0.5f}, size).x, 1.5f, 1e-5) << size;
}

// Where memory is short levels are made as they are asked for.  Kinds of footprints and of rims,
// coarse ones first: each sees what it sees where all levels are there, and the file is decoded
// twice at most.
TEST(Texture, where_memory_is_short_look_ups_are_the_same) {
    constexpr int kSize = 512, kShort = 4;
    ImageFile file(".tif");
    ASSERT_TRUE(
        write_image(file, kSize, [](int, int x, int y) { return float((x * 7 + y * 13) % 256); }));
    const Image image = file.image("Non-Color");
    for (const TextureExtension extension :
         {TextureExtension::Repeat, TextureExtension::Extend, TextureExtension::Clip}) {
        ASSERT_TRUE(std::filesystem::exists(file.path()));
        Look all(image), few(image, kShort);
        TextureMode mode;
        mode.extension = extension;
        bool is_first = true;
        for (const float texels : {300.0f, 100.0f, 64.0f, 17.0f, 4.0f, 1.0f, 0.2f})
            for (const float ratio : {1.0f, 3.0f, 50.0f}) {
                auto places = places_all_over(8, kSize, texels, texels / ratio, 0.5f);
                for (TexturePlace& place : places) place.center = place.center * 1.5f - 0.25f;
                ASSERT_EQ(few.at(places, mode), all.at(places, mode))
                    << texels << " texels a pixel, " << ratio;
                // The first asks for level 8 where its footprint is not cut at the rim; one finer
                // is made with it: 4 x 4, 2 x 2 and 1 texels of four floats.
                if (is_first && extension != TextureExtension::Extend) {
                    EXPECT_EQ(few.byte_count(), (16u + 4u + 1u) * 16u);
                }
                is_first = false;
            }
        EXPECT_GT(all.byte_count(), 4u << 20);
        EXPECT_TRUE(few.warnings().empty());
    }
}

TEST(Texture, a_file_that_went_while_memory_was_short_keeps_what_was_read_of_it) {
    constexpr int kSize = 512, kShort = 4;
    for (const bool asked_finely : {false, true}) {
        ImageFile file(".tif");
        ASSERT_TRUE(write_image(file, kSize, [](int, int, int) { return 0.5f; }));
        Look look(file.image("Non-Color"), kShort);
        const Vec4f grey(0.5f, 0.5f, 0.5f, 1.0f);
        EXPECT_EQ(look.at({0.3f, 0.6f}, 0.25f), grey);
        if (asked_finely) {
            EXPECT_EQ(look.at({0.3f, 0.6f}, 0.0f), grey);
        }
        std::filesystem::remove(file.path());
        EXPECT_EQ(look.at({0.7f, 0.2f}, 0.25f), grey);
        EXPECT_EQ(look.at({0.7f, 0.2f}, 0.0f), asked_finely ? grey : Vec4f(1, 0, 1, 1));
        EXPECT_EQ(look.at({0.7f, 0.2f}, 0.25f), grey);
        EXPECT_EQ(look.warnings().size(), asked_finely ? 0u : 1u);
    }
}

TEST(Texture, missing_file_is_magenta_and_named) {
    Image image;
    image.name = "Image";
    image.path = "/nowhere/at/all.png";
    Look look(image);
    EXPECT_EQ(look.at({0.5f, 0.5f}, 0), Vec4f(1, 0, 1, 1));
    ASSERT_EQ(look.warnings().size(), 1u);
    EXPECT_EQ(look.warnings()[0].datablock, "image 'Image'");
}

}  // namespace
}  // namespace granita
