// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sorted_runs.h"

#include <gtest/gtest.h>

namespace granita {
namespace {

using Runs = std::vector<std::vector<std::uint32_t>>;

TEST(SortedRuns, numbers_of_one_key_come_together_in_their_order) {
    const int keys[] = {2, 1, 2, 1, 3};
    std::vector<std::uint32_t> order;
    Runs runs;
    for_sorted_runs(
        order, 5, [&](std::uint32_t i) { return keys[i]; },
        [&](std::span<const std::uint32_t> run) { runs.emplace_back(run.begin(), run.end()); });
    EXPECT_EQ(runs, (Runs{{1, 3}, {0, 2}, {4}}));
}

TEST(SortedRuns, of_more_than_the_most_they_come_in_several_runs) {
    const int keys[] = {2, 1, 1, 1, 1, 1};
    std::vector<std::uint32_t> order;
    Runs runs;
    for_sorted_runs(
        order, 6, [&](std::uint32_t i) { return keys[i]; },
        [&](std::span<const std::uint32_t> run) { runs.emplace_back(run.begin(), run.end()); }, 2);
    EXPECT_EQ(runs, (Runs{{1, 2}, {3, 4}, {5}, {0}}));
}

}  // namespace
}  // namespace granita
