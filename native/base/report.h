// SPDX-License-Identifier: GPL-3.0-or-later
// What could not be rendered as asked, collected for the artist: nothing is dropped silently.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace granita {

struct Warning {
    std::string datablock;  ///< e.g. "object 'Cube'"
    std::string message;
    std::uint64_t count = 1;  ///< how often the same warning was raised
};

/// Thread-safe list of warnings.  Equal warnings are counted, not repeated.
class Report {
  public:
    void warn(const std::string& datablock, const std::string& message, std::uint64_t count = 1);
    /// Sorted by datablock, then message: independent of thread timing.
    std::vector<Warning> warnings() const;
    /// Says all of another one.
    void add(const Report& other);
    /// Says what of another one was not said yet.
    void add_new(const Report& other);

  private:
    mutable std::mutex m_mutex;
    std::map<std::pair<std::string, std::string>, std::uint64_t> m_warnings;
};

}  // namespace granita
