// SPDX-License-Identifier: GPL-3.0-or-later
// Nested parallelism (decision 14): loops inside a bucket's work, of which threads that have
// nothing else to do take a share (base/thread_pool.h).
//
// Schedulers that steal work let a thread which waits for its loop run any other task meanwhile.
// Here it never gets another bucket, nor anything else that might want a lock which it already
// holds: each loop is isolated, and whoever waits inside it runs only pieces of it (oneTBB: "work
// isolation").  Threads that wait for nothing take pieces of any loop.
//
// A loop's pieces must not use what the caller of the loop keeps in thread_local memory.
#pragma once

#include <tbb/collaborative_call_once.h>

#include <cstddef>

#include "base/fork_join.h"
#include "base/stage_timer.h"

namespace granita {

namespace detail {

using LoopPiece = void (*)(const void* loop, std::size_t begin, std::size_t end);
void run_loop(std::size_t count, std::size_t grain, LoopPiece piece, const void* loop);

using OnceMaker = void (*)(const void* make);
void run_once(tbb::collaborative_once_flag& flag, OnceMaker maker, const void* make);

}  // namespace detail

/// Calls body(begin, end) for ranges that tile [0, count), none split below `grain`.  The first
/// exception of a piece comes back here; pieces not yet begun are then left out.
template <class Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
    if (count == 0) return;
    if (count <= grain) return body(std::size_t{0}, count);
    struct Loop {
        const Body& body;
        StageTimer::Current stage;
        ForkJoin order;
    };
    const Loop loop{body, StageTimer::current(), {}};
    const auto piece = [](const void* of, std::size_t begin, std::size_t end) {
        const Loop& loop = *static_cast<const Loop*>(of);
        const ForkJoin::Piece piece(loop.order);
        const StageShare share(loop.stage);
        loop.body(begin, end);
    };
    detail::run_loop(count, grain, piece, &loop);
}

/// Like std::once_flag and std::call_once, but threads that come meanwhile take a share of the
/// loops in `make` instead of standing still.  An exception goes to the thread that ran `make`; the
/// next one tries again.
class SharedOnce {
  public:
    template <class Make>
    void call(const Make& make) {
        struct Once {
            const Make& make;
            const ForkJoin& order;
        };
        const Once once{make, m_order};
        const auto maker = [](const void* of) {
            const Once& once = *static_cast<const Once*>(of);
            const ForkJoin::Piece piece(once.order);
            once.make();
        };
        detail::run_once(m_flag, maker, &once);
        m_order.join();
    }

  private:
    tbb::collaborative_once_flag m_flag;
    ForkJoin m_order;
};

}  // namespace granita
