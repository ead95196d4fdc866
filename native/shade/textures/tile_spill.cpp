// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/tile_spill.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace granita {

namespace {

std::string reason_of_errno() {
    return std::generic_category().message(errno);
}

}  // namespace

TileSpill::~TileSpill() {
    if (m_file >= 0) close(m_file);
}

bool TileSpill::open() {
    std::error_code failure;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(failure);
    if (failure) {
        m_error = failure.message();
        return false;
    }
    std::string name = (folder / "granita-tiles-XXXXXX").string();
    m_file = mkostemp(name.data(), O_CLOEXEC);
    if (m_file < 0) {
        m_error = reason_of_errno();
        return false;
    }
    unlink(name.c_str());  // it goes with its descriptor, whatever becomes of the process
    const auto space = std::filesystem::space(folder, failure);
    m_most = failure ? UINT64_MAX : space.available / 10 * 9;
    return true;
}

bool TileSpill::write(const std::byte* bytes, std::size_t count, std::uint64_t& offset) {
    if (!m_error.empty() || (m_file < 0 && !open())) return false;
    if (m_end + count > m_most) {
        m_error = "the disk is nearly full";
        return false;
    }
    for (std::size_t done = 0; done < count;) {
        const ssize_t step =
            pwrite(m_file, bytes + done, count - done, static_cast<off_t>(m_end + done));
        if (step < 0 && errno == EINTR) continue;
        if (step <= 0) {
            m_error = reason_of_errno();
            return false;
        }
        done += static_cast<std::size_t>(step);
    }
    offset = m_end;
    m_end += count;
    return true;
}

bool TileSpill::read(std::uint64_t offset, std::byte* bytes, std::size_t count) const {
    for (std::size_t done = 0; done < count;) {
        const ssize_t step =
            pread(m_file, bytes + done, count - done, static_cast<off_t>(offset + done));
        if (step < 0 && errno == EINTR) continue;
        if (step <= 0) return false;
        done += static_cast<std::size_t>(step);
    }
    return true;
}

}  // namespace granita
