// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the device's latency is hidden: how long it worked, and how much of that some other
// thread worked beside it instead of waiting.
#pragma once

#include <chrono>
#include <mutex>

namespace granita::gl {

struct DeviceUse {
    double seconds = 0.0;         ///< during which the device's thread ran jobs
    double hidden_seconds = 0.0;  ///< of these, during which a worker did not wait
};

/// Any thread may call.
class DeviceClock {
  public:
    /// A worker begins (1) or ends (-1).
    void add_worker(int change) {
        set([&] { m_workers += change; });
    }
    /// A worker begins (1) or ends (-1) waiting for a job.
    void add_waiting(int change) {
        set([&] { m_waiting += change; });
    }
    /// A job begins (1) or ends (-1); jobs nest.
    void add_job(int change) {
        set([&] { m_jobs += change; });
    }
    DeviceUse use() {
        set([] {});
        const std::lock_guard lock(m_mutex);
        return m_use;
    }

  private:
    template <class Change>
    void set(const Change& change) {
        const std::lock_guard lock(m_mutex);
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - m_last).count();
        if (m_jobs > 0) m_use.seconds += seconds;
        if (m_jobs > 0 && m_workers > m_waiting) m_use.hidden_seconds += seconds;
        m_last = now;
        change();
    }

    std::mutex m_mutex;
    std::chrono::steady_clock::time_point m_last = std::chrono::steady_clock::now();
    int m_workers = 0, m_waiting = 0, m_jobs = 0;
    DeviceUse m_use;
};

}  // namespace granita::gl
