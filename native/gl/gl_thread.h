// SPDX-License-Identifier: GPL-3.0-or-later
// One thread owns OpenGL (decision 14): it makes the context and runs the jobs of other threads in
// the order of their arrival.
//
//   GlThread thread;                                   // GlError: no usable OpenGL
//   auto pixels = thread.run([&] { ...OpenGL...; return pixels; });   // exceptions come back
//
// Everything that owns an OpenGL name is made and destroyed inside a job.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>

#include "gl/device_clock.h"
#include "gl/egl_context.h"

namespace granita::gl {

class GlThread {
  public:
    /// Returns once the context exists.
    explicit GlThread(const ContextOptions& options = {});
    /// Runs what is queued, then destroys the context.
    ~GlThread();
    GlThread(const GlThread&) = delete;
    GlThread& operator=(const GlThread&) = delete;

    const ContextInfo& info() const { return m_info; }

    /// Any thread.  The future carries the job's result or exception.
    template <class Job>
    auto submit(Job job) -> std::future<std::invoke_result_t<Job&>> {
        using Result = std::invoke_result_t<Job&>;
        auto task =
            std::make_shared<std::packaged_task<Result()>>([this, job = std::move(job)]() mutable {
                const Counted running(m_clock, &DeviceClock::add_job);  // until the result is there
                return job();
            });
        auto result = task->get_future();
        if (std::this_thread::get_id() == m_thread.get_id())
            (*task)();  // a job that waits for a job must not wait for itself
        else
            push([task] { (*task)(); });
        return result;
    }

    /// submit() and wait.
    template <class Job>
    auto run(Job job) -> std::invoke_result_t<Job&> {
        const Counted waiting(m_clock, &DeviceClock::add_waiting);
        return submit(std::move(job)).get();
    }

    DeviceClock& clock() { return m_clock; }

  private:
    /// 1 more during its life.
    class Counted {
      public:
        Counted(DeviceClock& clock, void (DeviceClock::*add)(int)) : m_clock(clock), m_add(add) {
            (m_clock.*m_add)(1);
        }
        ~Counted() { (m_clock.*m_add)(-1); }
        Counted(const Counted&) = delete;
        Counted& operator=(const Counted&) = delete;

      private:
        DeviceClock& m_clock;
        void (DeviceClock::*m_add)(int);
    };
    void push(std::function<void()> job);
    void work(const ContextOptions& options, std::promise<ContextInfo>& started);

    ContextInfo m_info;
    DeviceClock m_clock;
    std::mutex m_mutex;
    std::condition_variable m_wake;
    std::deque<std::function<void()>> m_jobs;
    bool m_stop = false;
    std::thread m_thread;
};

}  // namespace granita::gl
