// SPDX-License-Identifier: GPL-3.0-or-later
// All that is compiled of oneTBB's loops; the thread sanitizer sees base/fork_join.h in its place.
#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace granita::detail {
namespace {

/// Whether loops that this thread begins belong to what it makes in run_once(), so that those who
/// want that may take pieces of them.
thread_local bool shares_loops = false;

class Sharing {
  public:
    explicit Sharing(bool shares) : m_before(shares_loops) { shares_loops = shares; }
    ~Sharing() { shares_loops = m_before; }
    Sharing(const Sharing&) = delete;
    Sharing& operator=(const Sharing&) = delete;

  private:
    bool m_before;
};

}  // namespace

void run_loop(std::size_t count, std::size_t grain, LoopPiece piece, const void* loop) {
    const auto run = [&] {
        // Not bound to the loop around it: one that is cancelled by its own exception must not
        // leave out pieces of another's without a word.
        tbb::task_group_context context(tbb::task_group_context::isolated);
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, grain),
            [=](const tbb::blocked_range<std::size_t>& range) {
                const Sharing own(false);
                piece(loop, range.begin(), range.end());
            },
            context);
    };
    // A loop of its own would be closed to those who wait in run_once().
    if (shares_loops)
        run();
    else
        tbb::this_task_arena::isolate(run);
}

void run_once(tbb::collaborative_once_flag& flag, OnceMaker maker, const void* make) {
    tbb::collaborative_call_once(flag, [=] {
        const Sharing sharing(true);
        maker(make);
    });
}

}  // namespace granita::detail
