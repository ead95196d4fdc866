// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel_sort.h"

#include <gtest/gtest.h>

#include <random>

#include "base/thread_pool.h"

namespace granita {
namespace {

TEST(ParallelSort, as_the_standard_library_sorts) {
    std::mt19937 random(5);
    ThreadPool pool(3);
    pool.run([&] {
        // Around whole runs of 2^14, and numbers of runs that are no power of two.
        for (const std::size_t count : {0, 1, 2, 16384, 16385, 50000, 200003}) {
            std::vector<std::uint32_t> values(count);
            for (std::uint32_t& value : values) value = random() % 100000;
            std::vector<std::uint32_t> expected = values;
            std::sort(expected.begin(), expected.end());
            parallel_sort(values);
            EXPECT_EQ(values, expected) << count;
        }
    });
}

}  // namespace
}  // namespace granita
