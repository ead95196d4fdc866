// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace granita {

/// Tells the thread sanitizer what it cannot see, as oneTBB is not built with it: what was written
/// before a fork is there for the forked pieces, and what they wrote is there after the join.
/// Nothing in other builds.  Lives from before the fork to after the join.
class ForkJoin {
  public:
    ForkJoin() { release(&m_fork); }
    ~ForkJoin() { join(); }
    ForkJoin(const ForkJoin&) = delete;
    ForkJoin& operator=(const ForkJoin&) = delete;

    void join() const { acquire(&m_join); }

    /// Lives on the thread that runs a piece, while it does.
    class Piece {
      public:
        explicit Piece(const ForkJoin& order) : m_order(order) { acquire(&order.m_fork); }
        ~Piece() { release(&m_order.m_join); }
        Piece(const Piece&) = delete;
        Piece& operator=(const Piece&) = delete;

      private:
        const ForkJoin& m_order;
    };

  private:
#ifdef __SANITIZE_THREAD__
    static void release(const char* at) {
        __tsan_release(const_cast<char*>(at));
    }
    static void acquire(const char* at) {
        __tsan_acquire(const_cast<char*>(at));
    }
#else
    static void release(const char*) {}
    static void acquire(const char*) {}
#endif
    char m_fork = 0, m_join = 0;
};

}  // namespace granita
