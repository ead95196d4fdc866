// SPDX-License-Identifier: GPL-3.0-or-later
// The memory that a frame may take (Options::memory), and what takes it.
//
// A thread of its own looks at what the process holds, so that nothing that takes memory has to
// ask: first what can be made again is given up, then the frame ends.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "base/statistics.h"
#include "scene/options.h"
#include "shade/shading_system.h"

namespace granita {

class FrameMemory {
  public:
    /// Begins with what the process holds now: Blender's and the scene's.
    FrameMemory(const Options& options, const Statistics& statistics);

    std::uint64_t limit() const { return m_limit; }
    /// What takes how much.  `shading`: whose textures count, or nullptr.
    std::string text(const ShadingSystem* shading) const;

  private:
    std::uint64_t m_limit, m_before;
    const Statistics& m_statistics;
};

/// Looks at the memory while it lives; does nothing where there is no limit.
class MemoryWatch {
  public:
    /// @param shading  whose textures are given up, or nullptr: it is not there yet.
    /// @param fail     gets the reason, once.
    MemoryWatch(const FrameMemory& memory, const ShadingSystem* shading,
                std::function<void(const std::string&)> fail);
    ~MemoryWatch();
    MemoryWatch(const MemoryWatch&) = delete;
    MemoryWatch& operator=(const MemoryWatch&) = delete;

  private:
    void run();

    const FrameMemory& m_memory;
    const ShadingSystem* m_shading;
    std::function<void(const std::string&)> m_fail;
    std::mutex m_mutex;
    std::condition_variable m_changed;
    bool m_ended = false;
    std::thread m_thread;
};

}  // namespace granita
