// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/render_job.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "base/error.h"
#include "base/progress.h"
#include "render/frame.h"
#include "render/render_bucket.h"

namespace granita {

struct RenderJob::Impl {
    std::shared_ptr<const Scene> scene;
    gl::ContextOptions gpu;
    Statistics statistics;
    Report reports[2];  ///< of the device that was chosen, and of the CPU in its place
    std::atomic<int> attempt{0};
    Progress progress;
    std::string device;
    gl::DeviceUse device_use;

    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Tile> tiles;
    std::exception_ptr failure;
    bool finished = false;
    std::thread driver;

    void fail(std::exception_ptr error) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::move(error);
        progress.cancel();
    }

    void deliver(std::vector<Tile> ready) {
        if (ready.empty()) return;
        const std::lock_guard lock(mutex);
        for (Tile& tile : ready) tiles.push_back(std::move(tile));
        changed.notify_all();
    }

    int thread_count() const {
        if (scene->options.threads > 0) return scene->options.threads;
        return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    }

    /// One task a bucket, taken in spiral order (decision 14).  Where OpenGL fails, no further
    /// bucket is begun, and the first GlError comes back.
    void render(ExecutorChoice choice) {
        Frame frame(*scene, statistics, reports[attempt], progress, std::move(choice));
        {
            const std::lock_guard lock(mutex);
            device = frame.choice.device;
        }
        progress.add_done(-progress.done());
        progress.set_total(frame.layout.count());
        const std::vector<int> order = frame.layout.spiral();
        std::atomic<std::size_t> next{0};
        std::optional<GlError> lost;
        gl::GlThread* const gl = frame.choice.gl.get();
        const auto work = [&] {
            if (gl != nullptr) gl->clock().add_worker(1);
            try {
                for (std::size_t i = next++; i < order.size(); i = next++) {
                    deliver(render_bucket(frame, order[i]));
                    progress.add_done(1);
                }
            } catch (const GlError& error) {
                next = order.size();
                const std::lock_guard lock(mutex);
                if (!lost) lost = error;
            } catch (...) {
                fail(std::current_exception());
            }
            if (gl != nullptr) gl->clock().add_worker(-1);
        };
        // While one waits for the device, another dices and shades the next bucket.
        const int count = thread_count() + (gl != nullptr ? 1 : 0);
        std::vector<std::thread> workers;
        for (int i = 1; i < count; ++i) workers.emplace_back(work);
        work();
        for (std::thread& worker : workers) worker.join();
        if (gl != nullptr) {
            const std::lock_guard lock(mutex);
            device_use = gl->clock().use();
        }
        progress.check();
        if (lost) throw *lost;
    }

    void run() {
        try {
            // Embree and OpenImageIO use TBB: the artist's thread limit holds for them too.
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(thread_count()));
            std::optional<GlError> lost;
            try {
                render(choose_executor(*scene, reports[0], gpu));
            } catch (const GlError& error) {
                lost = error;
            }
            if (lost) {
                attempt = 1;
                render(cpu_instead(*scene, *lost, reports[1]));
            }
        } catch (...) {
            fail(std::current_exception());
        }
        const std::lock_guard lock(mutex);
        finished = true;
        changed.notify_all();
    }
};

RenderJob::RenderJob(std::shared_ptr<const Scene> scene, const gl::ContextOptions& gpu)
    : m_impl(std::make_unique<Impl>()) {
    m_impl->scene = std::move(scene);
    m_impl->gpu = gpu;
    m_impl->driver = std::thread([impl = m_impl.get()] { impl->run(); });
}

RenderJob::~RenderJob() {
    cancel();
    if (m_impl->driver.joinable()) m_impl->driver.join();
}

std::vector<Tile> RenderJob::take_tiles(double seconds) {
    std::unique_lock lock(m_impl->mutex);
    m_impl->changed.wait_for(lock, std::chrono::duration<double>(seconds),
                             [&] { return !m_impl->tiles.empty() || m_impl->finished; });
    std::vector<Tile> taken(std::make_move_iterator(m_impl->tiles.begin()),
                            std::make_move_iterator(m_impl->tiles.end()));
    m_impl->tiles.clear();
    return taken;
}

bool RenderJob::done() const {
    const std::lock_guard lock(m_impl->mutex);
    return m_impl->finished && m_impl->tiles.empty();
}

double RenderJob::fraction() const {
    const long total = buckets_total();
    return total > 0 ? static_cast<double>(buckets_done()) / static_cast<double>(total) : 0.0;
}

long RenderJob::buckets_done() const {
    return m_impl->progress.done();
}
long RenderJob::buckets_total() const {
    return m_impl->progress.total();
}
void RenderJob::cancel() {
    m_impl->progress.cancel();
}

void RenderJob::finish() {
    if (m_impl->driver.joinable()) m_impl->driver.join();
    if (m_impl->failure) std::rethrow_exception(m_impl->failure);
}

const Statistics& RenderJob::statistics() const {
    return m_impl->statistics;
}
const Report& RenderJob::report() const {
    return m_impl->reports[m_impl->attempt];
}
gl::DeviceUse RenderJob::device_use() const {
    const std::lock_guard lock(m_impl->mutex);
    return m_impl->device_use;
}
std::string RenderJob::device() const {
    return m_impl->device;
}

}  // namespace granita
