// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/readback.h"

#include <gtest/gtest.h>

#include <vector>

#include "gl/gl_thread.h"

namespace granita::gl {
namespace {

TEST(Readback, is_what_the_source_was_when_it_began) {
    GlThread thread;
    Readback whole, part, texels, nothing;
    thread.run([&] {
        const Buffer numbers = Buffer::of(std::vector<std::uint32_t>{1, 2, 3, 4});
        whole = Readback(numbers, 0, numbers.size());
        part = Readback(numbers, 4, 8);
        numbers.write(0, std::vector<std::uint32_t>{9, 9, 9, 9});
        const Texture texture(GL_RGBA32F, 4, 2);
        const float half[] = {0.5f, 1.0f, 0.0f, 2.0f}, zero[] = {0.0f, 0.0f, 0.0f, 0.0f};
        texture.clear({0, 0, 4, 2}, zero);
        texture.clear({2, 1, 1, 1}, half);
        texels = Readback(texture, {1, 1, 2, 1});
        texture.clear({0, 0, 4, 2}, zero);
        nothing = Readback(Buffer::of(std::vector<int>{}), 0, 0);
    });
    thread.run([&] {
        nothing.wait();  // the last of them
    });
    const auto same = []<class T>(std::span<const T> values, const std::vector<T>& expected) {
        return std::vector<T>(values.begin(), values.end()) == expected;
    };
    EXPECT_TRUE(same(whole.values<std::uint32_t>(), {1, 2, 3, 4}));
    EXPECT_TRUE(same(part.values<std::uint32_t>(), {2, 3}));
    EXPECT_TRUE(same(texels.values<float>(), {0, 0, 0, 0, 0.5f, 1.0f, 0.0f, 2.0f}));
    EXPECT_TRUE(nothing.values<int>().empty());
    thread.run([&] {
        for (Readback* readback : {&whole, &part, &texels, &nothing}) *readback = {};
    });
}

}  // namespace
}  // namespace granita::gl
