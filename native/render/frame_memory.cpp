// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame_memory.h"

#include <algorithm>
#include <chrono>

#include "base/system.h"

namespace granita {
namespace {

/// Between two looks: two threads take some ten megabytes meanwhile.
constexpr std::chrono::milliseconds kPause{10};

std::string mebibytes(std::uint64_t bytes) {
    return std::to_string(bytes >> 20) + " MiB";
}

}  // namespace

FrameMemory::FrameMemory(const Options& options, const Statistics& statistics)
    : m_limit(static_cast<std::uint64_t>(options.memory) << 20),
      m_before(process_memory()),
      m_statistics(statistics) {}

std::string FrameMemory::text(const ShadingSystem* shading) const {
    const std::uint64_t now = process_memory();
    std::string out = mebibytes(now) + " are taken";
    std::uint64_t known = 0;
    const auto name = [&](const char* owner, std::uint64_t bytes) {
        known += bytes;
        if (bytes >> 20) out += ", " + mebibytes(bytes) + " by " + owner;
    };
    name("Blender and the scene", m_before);
    name("grids of micropolygons", m_statistics.grid_bytes());
    name("what rays trace", m_statistics.peak_ray_bytes());
    name("textures", shading ? shading->textures().byte_count() : 0);
    if (now > known) name("what was being made", now - known);
    return out;
}

MemoryWatch::MemoryWatch(const FrameMemory& memory, const ShadingSystem* shading,
                         std::function<void(const std::string&)> fail)
    : m_memory(memory), m_shading(shading), m_fail(std::move(fail)) {
    if (memory.limit() > 0) m_thread = std::thread([this] { run(); });
}

MemoryWatch::~MemoryWatch() {
    {
        const std::lock_guard lock(m_mutex);
        m_ended = true;
    }
    m_changed.notify_all();
    if (m_thread.joinable()) m_thread.join();
}

void MemoryWatch::run() {
    const std::uint64_t limit = m_memory.limit();
    bool has_made_room = false;
    std::unique_lock lock(m_mutex);
    do {
        if (m_shading && !has_made_room && process_memory() > limit - limit / 8) {
            m_shading->textures().keep_within(limit / 16);
            return_freed_memory();
            has_made_room = true;
        }
        if (process_memory() <= limit) continue;
        m_fail("the frame wants more memory than " + mebibytes(limit) +
               ", its limit: " + m_memory.text(m_shading));
        return;
    } while (!m_changed.wait_for(lock, kPause, [this] { return m_ended; }));
}

}  // namespace granita
