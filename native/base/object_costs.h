// SPDX-License-Identifier: GPL-3.0-or-later
// What each object of a frame cost: seconds that threads were at its grids, dicing and shading
// them, and its micropolygons.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace granita {

/// Wall time, which costs a fortieth of a thread's own: what is compared are shares.
class Stopwatch {
  public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - m_start).count();
    }

  private:
    std::chrono::steady_clock::time_point m_start = std::chrono::steady_clock::now();
};

/// Thread-safe, relaxed: totals are read after the frame.
class ObjectCosts {
  public:
    /// Objects that are told apart; the costs of others are dropped.
    explicit ObjectCosts(std::size_t count) : m_costs(count) {}

    void add_seconds(std::size_t object, double seconds) {
        if (object < m_costs.size())
            m_costs[object].nanoseconds.fetch_add(static_cast<std::uint64_t>(seconds * 1e9),
                                                  std::memory_order_relaxed);
    }
    void add_micropolygons(std::size_t object, std::uint64_t n) {
        if (object < m_costs.size())
            m_costs[object].micropolygons.fetch_add(n, std::memory_order_relaxed);
    }
    std::size_t count() const { return m_costs.size(); }
    double seconds(std::size_t object) const {
        return 1e-9 * static_cast<double>(m_costs[object].nanoseconds.load());
    }
    std::uint64_t micropolygons(std::size_t object) const {
        return m_costs[object].micropolygons.load();
    }

  private:
    struct Cost {
        std::atomic<std::uint64_t> nanoseconds{0}, micropolygons{0};
    };
    std::vector<Cost> m_costs;
};

}  // namespace granita
