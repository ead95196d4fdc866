// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/once.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace granita {
namespace {

TEST(Once, MakesOnceForAllThreads) {
    constexpr int kRounds = 200, kThreads = 4;
    for (int round = 0; round < kRounds; ++round) {
        Once once;
        int made = 0;  // no atomic: whoever returns must see what the maker wrote
        std::vector<std::thread> threads;
        for (int i = 0; i < kThreads; ++i)
            threads.emplace_back([&] {
                once.call([&] { ++made; });
                EXPECT_EQ(made, 1);
            });
        for (std::thread& thread : threads) thread.join();
    }
}

TEST(Once, TheNextOneTriesAgainAfterAnException) {
    Once once;
    std::atomic<int> tries = 0, failed = 0;
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i)
        threads.emplace_back([&] {
            try {
                once.call([&] {
                    if (++tries <= 2) throw std::runtime_error("no memory");
                });
            } catch (const std::runtime_error&) {
                ++failed;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(tries, 3);
    EXPECT_EQ(failed, 2);
}

TEST(Once, IsMadeAnewAfterReset) {
    Once once;
    int made = 0;
    const auto make = [&] { ++made; };
    once.call(make);
    once.call(make);
    EXPECT_EQ(made, 1);
    once.reset();
    once.call(make);
    EXPECT_EQ(made, 2);
}

}  // namespace
}  // namespace granita
