// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/gl_thread.h"

#include <optional>
#include <system_error>

#include "base/error.h"

namespace granita::gl {

GlThread::GlThread(const ContextOptions& options) {
    std::promise<ContextInfo> started;
    std::future<ContextInfo> info = started.get_future();
    try {
        m_thread = std::thread([this, &options, &started] { work(options, started); });
    } catch (const std::system_error& error) {
        throw GlError(std::string("no thread for OpenGL: ") + error.what());
    }
    try {
        m_info = info.get();
    } catch (...) {
        m_thread.join();
        throw;
    }
}

GlThread::~GlThread() {
    {
        const std::lock_guard lock(m_mutex);
        m_stop = true;
    }
    m_wake.notify_one();
    m_thread.join();
}

void GlThread::push(std::function<void()> job) {
    {
        const std::lock_guard lock(m_mutex);
        m_jobs.push_back(std::move(job));
    }
    m_wake.notify_one();
}

// `options` and `started` live in the constructor until `started` is set.
void GlThread::work(const ContextOptions& options, std::promise<ContextInfo>& started) {
    std::optional<EglContext> context;
    try {
        context.emplace(options);
    } catch (...) {
        eglReleaseThread();
        started.set_exception(std::current_exception());
        return;
    }
    started.set_value(context->info());
    for (;;) {
        std::function<void()> job;
        {
            std::unique_lock lock(m_mutex);
            m_wake.wait(lock, [this] { return m_stop || !m_jobs.empty(); });
            if (m_jobs.empty()) break;
            job = std::move(m_jobs.front());
            m_jobs.pop_front();
        }
        job();  // a packaged task: never throws
    }
    context.reset();
    eglReleaseThread();
}

}  // namespace granita::gl
