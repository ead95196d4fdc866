// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/udim_texture.h"

#include <gtest/gtest.h>

#include <limits>

namespace granita {
namespace {

/// Says which tile it is, and where in it a place lies.
class Numbered : public Texture {
  public:
    explicit Numbered(float number) : m_number(number) {}
    void look_up(const TextureMode&, const std::vector<TexturePlace>& places,
                 std::vector<Vec4f>& out) const override {
        out.clear();
        for (const TexturePlace& place : places)
            out.emplace_back(m_number, place.center.x, place.center.y, place.along_u.x);
    }

  private:
    float m_number;
};

TEST(UdimTexture, a_place_is_read_in_its_tile) {
    const UdimTexture texture({{1001, std::make_shared<Numbered>(1.0f)},
                               {1010, std::make_shared<Numbered>(10.0f)},
                               {1012, std::make_shared<Numbered>(12.0f)}});
    const std::vector<TexturePlace> places = {
        {{1.25f, 1.5f}, {7.0f, 0.0f}}, {{0.5f, 0.75f}}, {{9.5f, 0.25f}}, {{-0.25f, 0.5f}}};
    std::vector<Vec4f> seen;
    texture.look_up({}, places, seen);
    ASSERT_EQ(seen.size(), places.size());
    EXPECT_EQ(seen[0], Vec4f(12.0f, 0.25f, 0.5f, 7.0f));
    EXPECT_EQ(seen[1], Vec4f(1.0f, 0.5f, 0.75f, 0.0f));
    EXPECT_EQ(seen[2], Vec4f(10.0f, 0.5f, 0.25f, 0.0f));
    EXPECT_EQ(seen[3], Vec4f(1.0f, -0.25f, 0.5f, 0.0f));
}

TEST(UdimTexture, places_without_a_tile_are_magenta) {
    const UdimTexture texture({{1001, std::make_shared<Numbered>(1.0f)}});
    const float far = std::numeric_limits<float>::max();
    const float none = std::numeric_limits<float>::quiet_NaN();
    std::vector<Vec4f> seen;
    texture.look_up({},
                    {{{1.5f, 0.5f}},
                     {{10.5f, 0.5f}},
                     {{-1.5f, 0.5f}},
                     {{0.5f, -2.0f}},
                     {{far, far}},
                     {{none, 0.0f}}},
                    seen);
    ASSERT_EQ(seen.size(), 6u);
    for (const Vec4f& texel : seen) EXPECT_EQ(texel, Vec4f(1.0f, 0.0f, 1.0f, 1.0f));
}

}  // namespace
}  // namespace granita
