// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/render_job.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <new>
#include <optional>
#include <system_error>
#include <thread>

#include "base/error.h"
#include "base/progress.h"
#include "base/stage_timer.h"
#include "base/system.h"
#include "base/thread_pool.h"
#include "render/frame.h"
#include "render/frame_memory.h"
#include "render/render_bucket.h"

namespace granita {

struct RenderJob::Impl {
    explicit Impl(std::shared_ptr<const Scene> s)
        : scene(std::move(s)),
          statistics(std::make_shared<Statistics>(scene->instances.size())),
          memory(scene->options, *statistics) {}

    std::shared_ptr<const Scene> scene;
    gl::ContextOptions gpu;
    std::shared_ptr<Session> session;
    std::shared_ptr<Statistics> statistics;
    Report reports[2];  ///< of the device that was chosen, and of the CPU in its place
    FrameMemory memory;
    std::atomic<int> attempt{0};
    Progress progress;
    std::string device;
    gl::DeviceUse device_use;

    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Tile> tiles;
    std::vector<std::pair<Rect, double>> bucket_seconds;  ///< each written by who renders it
    std::exception_ptr failure;
    bool finished = false;
    bool given_up = false;  ///< nobody takes tiles any more
    std::thread driver;

    void fail(std::exception_ptr error) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::move(error);
        progress.cancel();
    }
    void fail(const std::string& why) { fail(std::make_exception_ptr(Error(why))); }
    /// With what is being handled.
    void fail() {
        try {
            throw;
        } catch (const std::bad_alloc&) {
            fail("the system gives no more memory: " + memory.text(nullptr));
        } catch (...) {
            fail(std::current_exception());
        }
    }

    void deliver(std::vector<Tile> ready) {
        if (ready.empty()) return;
        const std::lock_guard lock(mutex);
        if (given_up) return;
        for (Tile& tile : ready) tiles.push_back(std::move(tile));
        changed.notify_all();
    }

    int thread_count() const {
        if (scene->options.threads > 0) return scene->options.threads;
        return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    }

    /// On threads of its own.  Where OpenGL fails, no further bucket is begun, and the first
    /// GlError comes back.
    void render(ExecutorChoice choice) {
        // While one waits for the device, another dices and shades the next bucket.
        const int wanted = thread_count() + (choice.gl ? 1 : 0);
        ThreadPool pool(wanted);
        if (pool.size() < wanted)
            reports[attempt].warn("render settings", "the system allowed " +
                                                         std::to_string(pool.size()) + " of " +
                                                         std::to_string(wanted) + " threads");
        pool.run([&] { render(pool, std::move(choice)); });
    }

    /// One task a bucket, taken in spiral order (decision 14).
    void render(ThreadPool& pool, ExecutorChoice choice) {
        const StageLedger ledger(*statistics);
        const auto give_up = [this](const std::string& why) { fail(why); };
        Frame frame = [&] {
            const MemoryWatch watch(memory, nullptr, give_up);
            return Frame(scene, statistics, reports[attempt], progress, std::move(choice), kept());
        }();
        const MemoryWatch watch(memory, &frame.shading, give_up);
        {
            const std::lock_guard lock(mutex);
            device = frame.choice.device;
        }
        progress.add_done(-progress.done());
        progress.set_total(frame.layout.count());
        const std::vector<int> order = frame.layout.spiral();
        bucket_seconds.assign(order.size(), {});
        std::atomic<std::size_t> next{0};
        std::optional<GlError> lost;
        gl::GlThread* const gl = frame.choice.gl.get();
        pool.run_on_all([&] {
            const StageLedger own(*statistics);
            if (gl != nullptr) gl->clock().add_worker(1);
            try {
                for (std::size_t i = next++; i < order.size(); i = next++) {
                    const double began = thread_seconds();
                    deliver(render_bucket(frame, order[i]));
                    bucket_seconds[i] = {frame.layout.pixels(order[i]), thread_seconds() - began};
                    progress.add_done(1);
                }
            } catch (const GlError& error) {
                next = order.size();
                const std::lock_guard lock(mutex);
                if (!lost) lost = error;
            } catch (...) {
                fail();
            }
            if (gl != nullptr) gl->clock().add_worker(-1);
        });
        if (gl != nullptr) {
            const std::lock_guard lock(mutex);
            device_use = gl->clock().use();
        }
        if (auto visibility = frame.take_visibility(); session && !lost)
            session->keep(std::move(visibility));
        progress.check();
        if (lost) throw *lost;
    }

    PersistentPicture kept() {
        if (!session) return {};
        return {session->shading(), session->take_visibility(*scene), true};
    }

    void run() {
        try {
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
            fail();
        }
        const std::lock_guard lock(mutex);
        finished = true;
        changed.notify_all();
    }
};

RenderJob::RenderJob(std::shared_ptr<const Scene> scene, const gl::ContextOptions& gpu,
                     std::shared_ptr<Session> session)
    : m_impl(std::make_unique<Impl>(std::move(scene))) {
    m_impl->gpu = gpu;
    m_impl->session = std::move(session);
    const auto run = [impl = m_impl.get()] { impl->run(); };
    try {
        m_impl->driver = std::thread(run);
    } catch (const std::system_error&) {
        run();  // not one thread more can be made: the frame is done when this returns
    }
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
    const std::lock_guard lock(m_impl->mutex);
    m_impl->given_up = true;
    m_impl->tiles.clear();
}

void RenderJob::finish() {
    if (m_impl->driver.joinable()) m_impl->driver.join();
    if (m_impl->failure) std::rethrow_exception(m_impl->failure);
}

std::vector<std::pair<Rect, double>> RenderJob::bucket_seconds() const {
    const std::lock_guard lock(m_impl->mutex);
    return m_impl->finished ? m_impl->bucket_seconds : decltype(m_impl->bucket_seconds){};
}

const Statistics& RenderJob::statistics() const {
    return *m_impl->statistics;
}
std::vector<DearObject> RenderJob::dearest_objects(std::size_t most) const {
    return granita::dearest_objects(*m_impl->scene, m_impl->statistics->objects(), most);
}
const Report& RenderJob::report() const {
    return m_impl->reports[m_impl->attempt];
}
gl::DeviceUse RenderJob::device_use() const {
    const std::lock_guard lock(m_impl->mutex);
    return m_impl->device_use;
}
std::string RenderJob::device() const {
    const std::lock_guard lock(m_impl->mutex);
    return m_impl->device;
}

}  // namespace granita
