// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/box_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

bool overlap(const Bounds3f& a, const Bounds3f& b) {
    for (int c = 0; c < 3; ++c)
        if (a.lo[c] > b.hi[c] || a.hi[c] < b.lo[c]) return false;
    return true;
}

Bounds3f box_around(const Vec3f& middle, const Vec3f& half) {
    Bounds3f box;
    box.add(middle - half);
    box.add(middle + half);
    return box;
}

/// How often each is visited.
std::vector<int> visits(const BoxCells& cells, std::size_t count, const Bounds3f& box) {
    std::vector<int> times(count, 0);
    cells.each_near(box, [&](std::uint32_t index) { ++times[index]; });
    return times;
}

TEST(BoxCells, VisitsWhatOverlapsOnceEach) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> anywhere(-1.0f, 1.0f), part(0.0f, 1.0f);
    // Thick, flat, along a line, and some that are large among small ones.
    for (const Vec3f wide : {Vec3f(1, 1, 1), Vec3f(9, 0, 3), Vec3f(0, 5, 0), Vec3f(0, 0, 0)}) {
        std::vector<Bounds3f> boxes;
        for (int i = 0; i < 700; ++i) {
            const Vec3f at(anywhere(random), anywhere(random), anywhere(random));
            boxes.push_back(box_around(wide * at, (i % 50 ? 0.02f : 0.7f) * part(random) * wide));
        }
        const BoxCells cells(boxes);
        for (int i = 0; i < 100; ++i) {
            const Vec3f at(anywhere(random), anywhere(random), anywhere(random));
            const Bounds3f asked = box_around(1.2f * wide * at, 0.2f * part(random) * wide);
            const std::vector<int> times = visits(cells, boxes.size(), asked);
            for (std::size_t j = 0; j < boxes.size(); ++j) {
                ASSERT_LE(times[j], 1) << j;
                ASSERT_TRUE(times[j] == 1 || !overlap(boxes[j], asked)) << j;
            }
        }
    }
}

TEST(BoxCells, HoldsNoneAndOne) {
    const Bounds3f everywhere = box_around(Vec3f(0.0f), Vec3f(kInfinity));
    EXPECT_TRUE(visits(BoxCells(), 0, everywhere).empty());
    EXPECT_TRUE(visits(BoxCells(std::vector<Bounds3f>{}), 0, everywhere).empty());
    const std::vector<Bounds3f> one{box_around(Vec3f(3.0f), Vec3f(0.0f))};
    EXPECT_EQ(visits(BoxCells(one), 1, everywhere), std::vector<int>{1});
}

/// A thousand that lie over one another would each lie in all cells.
TEST(BoxCells, FewCellsHoldWideBoxes) {
    const std::vector<Bounds3f> wide(4000, box_around(Vec3f(0.0f), Vec3f(1.0f, 1.0f, 0.1f)));
    const BoxCells cells(wide);
    EXPECT_EQ(visits(cells, wide.size(), wide.front()), std::vector<int>(wide.size(), 1));
    EXPECT_LE(cells.entries(), 4 * wide.size());
}

/// Nothing is known of where such a box is: it is asked about all the same.
TEST(BoxCells, AsksWithoutNumbers) {
    const std::vector<Bounds3f> boxes(300, box_around(Vec3f(1.0f), Vec3f(0.5f)));
    const Vec3f none(std::numeric_limits<float>::quiet_NaN());
    const std::vector<int> times = visits(BoxCells(boxes), boxes.size(), Bounds3f{none, none});
    EXPECT_LE(*std::ranges::max_element(times), 1);
}

}  // namespace
}  // namespace granita
