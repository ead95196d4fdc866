// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/thread_pool.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>

#include "base/parallel.h"
#include "no_new_threads.h"

namespace granita {
namespace {

TEST(ThreadPool, work_runs_once_on_every_thread) {
    ThreadPool pool(4);
    EXPECT_EQ(pool.size(), 4);
    for (int round = 0; round < 3; ++round) {
        // A call that waits for all others proves that each has a thread of its own.
        std::atomic<int> begun{0};
        std::mutex mutex;
        std::set<std::thread::id> threads;
        pool.run([&] {
            pool.run_on_all([&] {
                ++begun;
                while (begun < 4) std::this_thread::yield();
                const std::lock_guard lock(mutex);
                threads.insert(std::this_thread::get_id());
            });
        });
        EXPECT_EQ(begun, 4);
        EXPECT_EQ(threads.size(), 4u);
    }
}

TEST(ThreadPool, threads_without_work_of_their_own_take_pieces_of_a_loop) {
    ThreadPool pool(3);
    std::atomic<int> inside{0};
    pool.run([&] {
        // Three pieces that wait for each other: nobody gets past the loop on one thread.
        parallel_for(3, 1, [&](std::size_t, std::size_t) {
            ++inside;
            while (inside < 3) std::this_thread::yield();
        });
    });
    EXPECT_EQ(inside, 3);
}

TEST(ThreadPool, a_thread_that_waits_inside_a_loop_gets_no_other_work) {
    ThreadPool pool(4);
    std::atomic<bool> strayed{false};
    pool.run([&] {
        pool.run_on_all([&] {
            for (int i = 0; i < 200; ++i) {
                // As a lock that a bucket holds while it dices: the same thread must not come here
                // again before the loop is done.
                thread_local bool held = false;
                if (held) strayed = true;
                held = true;
                std::atomic<int> sum{0};
                parallel_for(64, 1, [&](std::size_t begin, std::size_t end) {
                    std::atomic<int> inner{0};
                    parallel_for(16, 1, [&](std::size_t b, std::size_t e) {
                        inner += static_cast<int>(e - b);
                    });
                    sum += inner * static_cast<int>(end - begin);
                });
                held = false;
                if (sum != 64 * 16) strayed = true;
            }
        });
    });
    EXPECT_FALSE(strayed);
}

TEST(ThreadPool, those_who_come_meanwhile_take_a_share_of_what_is_made_once) {
    ThreadPool pool(3);
    SharedOnce once;
    std::atomic<int> made{0}, inside{0};
    std::vector<int> values;  // written by one thread, read by all
    std::atomic<int> sum{0};
    pool.run([&] {
        pool.run_on_all([&] {
            once.call([&] {
                ++made;
                parallel_for(3, 1, [&](std::size_t, std::size_t) {
                    ++inside;
                    while (inside < 3) std::this_thread::yield();
                });
                values.assign(100, 1);
            });
            sum += std::accumulate(values.begin(), values.end(), 0);
        });
    });
    EXPECT_EQ(made, 1);
    EXPECT_EQ(sum, 300);
}

TEST(ThreadPool, what_failed_is_made_by_the_next) {
    ThreadPool pool(2);
    pool.run([&] {
        SharedOnce once;
        EXPECT_THROW(once.call([] { throw std::runtime_error("no"); }), std::runtime_error);
        int made = 0;
        once.call([&] { ++made; });
        once.call([&] { ++made; });
        EXPECT_EQ(made, 1);
    });
}

TEST(ThreadPool, an_exception_in_a_loop_comes_back_and_ends_no_other_loop) {
    ThreadPool pool(3);
    std::atomic<int> whole{0};
    pool.run([&] {
        EXPECT_THROW(parallel_for(8, 1,
                                  [&](std::size_t begin, std::size_t) {
                                      int pieces = 0;
                                      std::mutex mutex;
                                      parallel_for(50, 1, [&](std::size_t b, std::size_t e) {
                                          const std::lock_guard lock(mutex);
                                          pieces += static_cast<int>(e - b);
                                      });
                                      if (pieces == 50) ++whole;
                                      if (begin == 0) throw std::runtime_error("no");
                                      if (pieces != 50) whole = -1000;
                                  }),
                     std::runtime_error);
    });
    EXPECT_GT(whole, 0);
}

TEST(ThreadPool, goes_on_with_the_threads_that_can_be_made) {
    const NoNewThreads none;
    ThreadPool pool(1024);
    EXPECT_EQ(pool.size(), 1);
    std::atomic<int> calls{0}, pieces{0};
    pool.run([&] {
        pool.run_on_all([&] { ++calls; });
        parallel_for(100, 1, [&](std::size_t begin, std::size_t end) {
            pieces += static_cast<int>(end - begin);
        });
    });
    EXPECT_EQ(calls, 1);
    EXPECT_EQ(pieces, 100);
}

}  // namespace
}  // namespace granita
