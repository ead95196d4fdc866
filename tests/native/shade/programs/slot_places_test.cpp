// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/programs/slot_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace granita::test {
namespace {

struct TestStep {
    std::vector<int> reads, writes;
};

SlotPlaces place(const std::vector<int>& widths, const std::vector<int>& written_first,
                 const std::vector<TestStep>& steps, const std::vector<int>& roots) {
    std::vector<SlotUse> uses;
    for (const TestStep& step : steps) uses.push_back({step.reads, step.writes});
    return place_slots(widths, written_first, uses, roots);
}

TEST(SlotPlaces, AChainNeedsTwoPlaces) {
    // 0 -> 1 -> 2 -> 3 -> 4: what is read stays while the next is written.
    std::vector<TestStep> steps;
    for (int i = 0; i < 4; ++i) steps.push_back({{i}, {i + 1}});
    const SlotPlaces places = place({1, 1, 1, 1, 1}, {0}, steps, {4});
    EXPECT_EQ(places.floats_a_point, 2);
    EXPECT_NE(places.first[3], places.first[4]);
}

TEST(SlotPlaces, RootsAndWhatIsReadLateStay) {
    // 0 is read by the last step, 1 is a root.
    const std::vector<TestStep> steps = {{{0}, {1}}, {{1}, {2}}, {{2}, {3}}, {{3, 0}, {4}}};
    const SlotPlaces places = place({3, 3, 3, 3, 3}, {0}, steps, {1, 4});
    EXPECT_EQ(places.floats_a_point, 12);
}

TEST(SlotPlaces, ConstantsHaveNone) {
    const SlotPlaces places = place({1}, {}, {{{-1, -1}, {0}}}, {0});
    EXPECT_EQ(places.floats_a_point, 1);
    EXPECT_EQ(places.first[0], 0);
}

TEST(SlotPlaces, WhatNobodyReadsIsWrittenNowhereElse) {
    // 1 is written beside 2 and never read; 3 may lie there once that is over.
    const SlotPlaces places = place({1, 1, 1, 1}, {0}, {{{0}, {1, 2}}, {{2}, {3}}}, {3});
    EXPECT_NE(places.first[1], places.first[2]);
    EXPECT_EQ(places.floats_a_point, 3);
}

/// Runs the steps on numbers that tell who wrote them.
bool reads_what_was_written(const SlotPlaces& places, const std::vector<int>& widths,
                            const std::vector<int>& written_first,
                            const std::vector<TestStep>& steps, const std::vector<int>& roots) {
    std::vector<int> memory(static_cast<std::size_t>(places.floats_a_point), -1);
    const auto write = [&](int slot) {
        for (int i = 0; i < widths[slot]; ++i) memory[places.first[slot] + i] = slot;
    };
    const auto holds = [&](int slot) {
        const auto begin = memory.begin() + places.first[slot];
        return std::all_of(begin, begin + widths[slot], [&](int who) { return who == slot; });
    };
    std::ranges::for_each(written_first, write);
    for (const TestStep& step : steps) {
        std::ranges::for_each(step.writes, write);
        // Reading goes on while results are written.
        if (!std::ranges::all_of(step.reads, holds) || !std::ranges::all_of(step.writes, holds))
            return false;
    }
    return std::ranges::all_of(roots, holds);
}

TEST(SlotPlaces, NothingIsWrittenOverWhatIsReadLater) {
    std::mt19937 random(7);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    int shared = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        std::vector<int> widths, loaded, roots;
        std::vector<TestStep> steps;
        const auto add_slot = [&] {
            widths.push_back(below(2) ? 1 : 3);
            return static_cast<int>(widths.size()) - 1;
        };
        for (int i = 1 + below(4); i > 0; --i) loaded.push_back(add_slot());
        for (int i = 1 + below(30); i > 0; --i) {
            TestStep step;
            for (int k = below(4); k > 0; --k)
                step.reads.push_back(below(static_cast<int>(widths.size())));
            for (int k = 1 + below(2); k > 0; --k) step.writes.push_back(add_slot());
            steps.push_back(step);
        }
        for (int i = 1 + below(3); i > 0; --i)
            roots.push_back(below(static_cast<int>(widths.size())));
        const SlotPlaces places = place(widths, loaded, steps, roots);
        ASSERT_TRUE(reads_what_was_written(places, widths, loaded, steps, roots)) << trial;
        shared += places.floats_a_point < std::accumulate(widths.begin(), widths.end(), 0);
    }
    EXPECT_GT(shared, 1000);
}

}  // namespace
}  // namespace granita::test
