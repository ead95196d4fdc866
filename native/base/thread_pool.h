// SPDX-License-Identifier: GPL-3.0-or-later
// The threads of one frame.  They are Granita's own, not oneTBB's: as many as the artist asked for
// whatever Blender's own tasks do, and what they keep in thread_local memory goes with the frame.
#pragma once

#include <functional>
#include <memory>

#include "base/fork_join.h"

namespace granita {

class ThreadPool {
  public:
    /// Threads that work, the caller's among them.  Where the system lets fewer be made, those
    /// there are; oneTBB's own (which Embree's builds use) are then left out.
    explicit ThreadPool(int wanted);
    /// Joins.
    ~ThreadPool();
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    /// At least 1, at most what was wanted.
    int size() const;

    /// Runs `work` on this thread, which becomes the pool's: the others take their share of its
    /// loops (base/parallel.h).
    void run(const std::function<void()>& work);
    /// Inside run(): runs `work` on every thread and returns when all calls have.  A thread whose
    /// call has returned takes its share of the others' loops.  `work` does not throw.
    template <class Work>
    void run_on_all(const Work& work) {
        struct Calls {
            const Work& work;
            ForkJoin order;
        };
        const Calls calls{work, {}};
        const auto call = [](const void* of) {
            const Calls& calls = *static_cast<const Calls*>(of);
            const ForkJoin::Piece piece(calls.order);
            calls.work();
        };
        call_on_all(call, &calls);
    }

  private:
    void call_on_all(void (*call)(const void*), const void* calls);

    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace granita
