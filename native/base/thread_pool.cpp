// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/thread_pool.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

namespace granita {
namespace {

/// A thread that waits, and works while it waits, until `gate` goes.
struct Helper {
    std::unique_ptr<tbb::task_group> group = std::make_unique<tbb::task_group>();
    tbb::task_handle gate = shut(group);
    std::thread thread;

    /// A group whose defer() found no memory counts a task that is not there: whoever ends it waits
    /// for that, and the process ends.  It is left behind instead.
    static tbb::task_handle shut(std::unique_ptr<tbb::task_group>& group) {
        try {
            return group->defer([] {});
        } catch (...) {
            static_cast<void>(group.release());
            throw;
        }
    }
};

/// Whether so many threads more can be made: where oneTBB cannot make one it fails a build.
bool is_room_for(int threads) {
    std::vector<std::jthread> probes;
    try {
        for (int i = 0; i < threads; ++i) probes.emplace_back([] {});
    } catch (const std::system_error&) {
        return false;
    }
    return true;
}

}  // namespace

struct ThreadPool::Impl {
    /// Every slot is reserved for threads that come from outside: oneTBB's own never join.
    explicit Impl(int slots) : arena(slots, static_cast<unsigned>(slots)) {}

    bool add_helper() {
        auto helper = std::make_unique<Helper>();
        const auto help = [this, group = helper->group.get()] {
            arena.execute([group] { group->wait(); });
        };
        try {
            helper->thread = std::thread(help);
        } catch (const std::system_error&) {
            return false;
        }
        helpers.push_back(std::move(helper));
        return true;
    }

    tbb::task_arena arena;
    std::vector<std::unique_ptr<Helper>> helpers;
    std::optional<tbb::global_control> limit;  ///< of oneTBB's own threads
};

ThreadPool::ThreadPool(int wanted) : m_impl(std::make_unique<Impl>(std::max(wanted, 1))) {
    while (size() < wanted && m_impl->add_helper()) {
    }
    const bool room = size() >= wanted && is_room_for(wanted - 1);
    m_impl->limit.emplace(tbb::global_control::max_allowed_parallelism,
                          room ? static_cast<std::size_t>(size()) : 1);
}

ThreadPool::~ThreadPool() {
    for (const auto& helper : m_impl->helpers) helper->gate = {};
    for (const auto& helper : m_impl->helpers) helper->thread.join();
}

int ThreadPool::size() const {
    return static_cast<int>(m_impl->helpers.size()) + 1;
}

void ThreadPool::run(const std::function<void()>& work) {
    m_impl->arena.execute(work);
}

void ThreadPool::call_on_all(void (*call)(const void*), const void* calls) {
    // Not a task_group: where there is no memory for one of its tasks it waits for ever.
    tbb::parallel_for(
        0, size(), [=](int) { call(calls); }, tbb::simple_partitioner());
}

}  // namespace granita
