// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/texel_converter.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace granita {
namespace {

/// Greens and blues change places, and reds are halved.
std::shared_ptr<const ColorSpace> swapped() {
    auto space = std::make_shared<ColorSpace>();
    space->matrix =
        Mat3f(Vec3f(0.5f, 0.0f, 0.0f), Vec3f(0.0f, 0.0f, 1.0f), Vec3f(0.0f, 1.0f, 0.0f));
    return space;
}

Vec4f only_texel(const TexelConverter& converter, const void* from) {
    std::array<std::byte, 16> out{};
    converter.convert(from, 1, out.data());
    return stored_texel(out.data(), converter.type());
}

TEST(TexelConverter, plain_bytes_stay_bytes_and_others_become_halves) {
    const std::uint8_t bytes[] = {10, 200, 30, 255};
    const TexelConverter plain(TexelConverter::From{});
    EXPECT_EQ(plain.type(), TexelType::Byte);
    EXPECT_TRUE(plain.encoded());
    EXPECT_FLOAT_EQ(only_texel(plain, bytes).y, 200 / 255.0f);

    TexelConverter::From from;
    from.space = swapped();
    const TexelConverter converter(from);
    EXPECT_EQ(converter.type(), TexelType::Half);
    EXPECT_FALSE(converter.encoded());
    const Vec4f texel = only_texel(converter, bytes);
    const auto light = [](int byte) { return ColorSpace{}.linear(Vec3f(float(byte) / 255.0f)).x; };
    EXPECT_NEAR(texel.x, 0.5f * light(10), 1e-6f);
    EXPECT_NEAR(texel.y, light(30), 1e-5f);
    EXPECT_NEAR(texel.z, light(200), 3e-4f);
    EXPECT_EQ(texel.w, 1.0f);
}

TEST(TexelConverter, curves_are_of_what_was_painted_not_of_its_product_with_alpha) {
    const std::uint8_t bytes[] = {51, 51, 51, 102};  // half of what alpha is
    TexelConverter::From from;
    from.space = swapped();
    from.is_associated = true;
    const float alpha = 102 / 255.0f, painted = ColorSpace{}.linear(Vec3f(0.5f)).x;
    EXPECT_NEAR(only_texel(TexelConverter(from), bytes).y, alpha * painted, 1e-4f);
    from.is_associated = false;
    EXPECT_NEAR(only_texel(TexelConverter(from), bytes).y, ColorSpace{}.linear(Vec3f(0.2f)).x,
                1e-4f);
    from.opaque = true;
    EXPECT_EQ(only_texel(TexelConverter(from), bytes).w, 1.0f);
}

TEST(TexelConverter, greys_alone_stay_grey) {
    TexelConverter::From from;
    from.space = swapped();
    from.channels = 1;
    const std::uint8_t bytes[] = {255, 128};
    const Vec4f grey = only_texel(TexelConverter(from), bytes);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(grey[k], 2.5f / 3.0f, 1e-3f);
    from.channels = 2;
    const Vec4f beside_alpha = only_texel(TexelConverter(from), bytes);
    EXPECT_NEAR(beside_alpha.x, 0.5f, 1e-3f);
    EXPECT_NEAR(beside_alpha.y, 1.0f, 1e-3f);
    EXPECT_NEAR(beside_alpha.w, 128 / 255.0f, 1e-3f);
}

TEST(TexelConverter, what_is_no_number_is_black) {
    auto space = std::make_shared<ColorSpace>();
    space->curve = ColorSpace::Curve::Table;
    space->table = {1.0f, 2.0f, 3.0f};
    TexelConverter::From from;
    from.space = space;
    from.type = TexelType::Float;
    const float floats[] = {NAN, -INFINITY, 0.5f, 1.0f};
    const Vec4f texel = only_texel(TexelConverter(from), floats);
    EXPECT_EQ(texel.x, 1.0f);  // of black
    EXPECT_TRUE(std::isfinite(texel.y));
    EXPECT_EQ(texel.z, 2.0f);
}

}  // namespace
}  // namespace granita
