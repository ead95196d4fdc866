// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/edge_rate.h"

#include <random>

#include "dice/dice_scene.h"

namespace granita::testing {
namespace {

// In perspective and through a lens too, moving or not.
TEST(EdgeRate, by_length_alone_says_what_it_says_in_full) {
    std::mt19937 random(3);
    const auto between = [&](float lo, float hi) {
        return std::uniform_real_distribution<float>(lo, hi)(random);
    };
    long sure = 0, all = 0, deepest = 0;
    for (const bool perspective : {false, true})
        for (const bool lens : {false, true})
            for (const int knots : {1, 2, 3}) {
                DiceScene s(cube(1.0f));
                if (perspective) s.perspective();
                s.view.projection.focus = 60.0;
                if (lens) s.view.projection.lens_radius = perspective ? 4.0 : 20.0;
                const EdgeRate rate(s.view);
                for (int i = 0; i < 2000; ++i) {
                    Vec3f start[3], middle[3], end[3];
                    std::vector<Bounds3f> boxes(static_cast<std::size_t>(knots));
                    const Vec3f a(between(-20, 20), between(-20, 20), between(50, 90));
                    const float length = std::exp2(between(-2, 4));
                    const Vec3f side =
                        length * Vec3f(between(-1, 1), between(-1, 1), between(-1, 1));
                    const Vec3f way(between(-20, 20), between(-20, 20), between(-9, 9));
                    for (int k = 0; k < knots; ++k) {
                        start[k] = a + way * static_cast<float>(k);
                        end[k] = start[k] + side * (1.0f + 0.2f * static_cast<float>(k));
                        middle[k] = 0.5f * (start[k] + end[k]);
                        boxes[static_cast<std::size_t>(k)].add(start[k]);
                        boxes[static_cast<std::size_t>(k)].add(end[k]);
                    }
                    if (!rate.in_frame(boxes)) continue;
                    ++all;
                    const int levels = rate.sure_levels(start, end, knots);
                    if (levels == EdgeRate::kUnsure) continue;
                    ++sure;
                    deepest += levels > 1;
                    EXPECT_EQ(levels, rate.levels(start, middle, end, knots, 25));
                }
            }
    EXPECT_GT(all, 10000);
    EXPECT_GT(sure, all * 7 / 10);
    EXPECT_GT(deepest, all / 20);
}

}  // namespace
}  // namespace granita::testing
