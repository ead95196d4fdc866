// SPDX-License-Identifier: GPL-3.0-or-later
// Cancel flag and fraction done, shared by the thread that owns the render and the workers.
#pragma once

#include <atomic>

#include "base/error.h"

namespace granita {

class Progress {
  public:
    void cancel() { m_cancelled.store(true, std::memory_order_relaxed); }
    bool cancelled() const { return m_cancelled.load(std::memory_order_relaxed); }
    /// Throws Cancelled.  Called at least every few milliseconds in every long loop.
    void check() const {
        if (cancelled()) throw Cancelled();
    }

    void set_total(long total) { m_total.store(total); }
    void add_done(long done) { m_done.fetch_add(done); }
    long total() const { return m_total.load(); }
    long done() const { return m_done.load(); }

  private:
    std::atomic<bool> m_cancelled{false};
    std::atomic<long> m_total{0};
    std::atomic<long> m_done{0};
};

}  // namespace granita
