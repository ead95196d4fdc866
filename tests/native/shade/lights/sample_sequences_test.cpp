// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "math/sampling.h"

namespace granita {
namespace {

// 64 points of an aligned run: one in every elementary interval of area 1 / 64.
void expect_net(const SobolPoints& points, std::uint32_t first) {
    for (int across = 1; across <= 64; across *= 2) {
        std::vector<int> cells(64);
        for (std::uint32_t i = 0; i < 64; ++i) {
            const Vec2f p = points(first + i);
            const int x = static_cast<int>(p.x * static_cast<float>(across));
            const int y = static_cast<int>(p.y * static_cast<float>(64 / across));
            ++cells[static_cast<std::size_t>(y * across + x)];
        }
        for (const int count : cells) ASSERT_EQ(count, 1) << across << " at " << first;
    }
}

TEST(SampleSequences, aligned_runs_are_nets_in_any_order) {
    const SobolPoints points(7);
    for (const std::uint32_t first : {0u, 64u, 4096u, 1u << 20}) {
        expect_net(points, first);
        expect_net(points.shuffled(11), first);
        expect_net(points.shuffled(12), first);
    }
}

// What a sample of a pixel draws for a lamp must not follow from where in the pixel it is: of 1024
// samples, 64 are in each of 4 x 4 cells of any two coordinates.
TEST(SampleSequences, a_shuffled_one_is_tied_to_no_other) {
    double worst_shuffled = 0.0, worst_plain = 0.0;
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
        const SobolPoints pixel(seed), plain(seed + 100);
        const auto worst = [&](const SobolPoints& lamp) {
            std::array<int, 16> cells{};
            for (std::uint32_t i = 0; i < 1024; ++i)
                ++cells[static_cast<std::size_t>(static_cast<int>(4 * pixel(i).x) * 4 +
                                                 static_cast<int>(4 * lamp(i).x))];
            double most = 0.0;
            for (const int count : cells) most = std::max(most, std::abs(count - 64.0));
            return most;
        };
        worst_shuffled = std::max(worst_shuffled, worst(plain.shuffled(seed + 200)));
        worst_plain = std::max(worst_plain, worst(plain));
    }
    // Five standard deviations of a count of 64; by the same index, cells are empty or four times
    // full.
    EXPECT_LT(worst_shuffled, 5 * 8.0);
    EXPECT_GT(worst_plain, 60.0);
}

}  // namespace
}  // namespace granita
