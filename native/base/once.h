// SPDX-License-Identifier: GPL-3.0-or-later
// What is made once, by whichever thread comes first; the others stand still until it is there.
// Makers that have loops of their own are better off with SharedOnce (base/parallel.h).
//
// Not std::once_flag: an exception that leaves std::call_once is allowed by the standard, but not
// by what gcc's thread sanitizer puts in the place of pthread_once, where the next thread waits
// forever.
#pragma once

#include <atomic>
#include <cstdint>

namespace granita {

class Once {
  public:
    /// Runs `make` unless that has been done, and returns when it has been.  An exception goes to
    /// the thread that ran it; the next one tries again.
    template <class Make>
    void call(const Make& make) {
        while (m_state.load(std::memory_order_acquire) != kDone) {
            std::uint32_t state = kOpen;
            if (!m_state.compare_exchange_strong(state, kRunning, std::memory_order_acquire)) {
                m_state.wait(kRunning, std::memory_order_acquire);
                continue;
            }
            try {
                make();
            } catch (...) {
                leave(kOpen);
                throw;
            }
            leave(kDone);
        }
    }

    /// To be made anew.  No thread may be in call() meanwhile.
    void reset() { m_state.store(kOpen, std::memory_order_relaxed); }

  private:
    void leave(std::uint32_t state) {
        m_state.store(state, std::memory_order_release);
        m_state.notify_all();
    }

    static constexpr std::uint32_t kOpen = 0, kRunning = 1, kDone = 2;
    std::atomic<std::uint32_t> m_state{kOpen};
};

}  // namespace granita
