// SPDX-License-Identifier: GPL-3.0-or-later
// A temporary file without a name that takes tiles which memory has no room for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <system_error>

#include "base/system.h"

namespace granita {

class TileSpill {
  public:
    /// Appends; the file is made by the first call, in the system's folder for temporary files, and
    /// takes at most 9/10 of what is free there.  Not thread-safe.
    /// @param offset  out: where it lies.
    /// @return false: there is no room, or no such file can be made; `error` says why.
    bool write(const std::byte* bytes, std::size_t count, std::uint64_t& offset);
    /// Thread-safe for what has been written.
    bool read(std::uint64_t offset, std::byte* bytes, std::size_t count) const;

    const std::string& error() const { return m_error; }

  private:
    std::error_code open();

    TemporaryFile m_file;
    std::uint64_t m_end = 0, m_most = 0;
    std::string m_error;
};

}  // namespace granita
