// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/tile_spill.h"

#include <filesystem>
#include <system_error>

namespace granita {

std::error_code TileSpill::open() {
    std::error_code failure;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(failure);
    if (!failure) failure = m_file.open(folder);
    if (failure) return failure;
    const auto space = std::filesystem::space(folder, failure);
    m_most = failure ? UINT64_MAX : space.available / 10 * 9;
    return {};
}

bool TileSpill::write(const std::byte* bytes, std::size_t count, std::uint64_t& offset) {
    if (!m_error.empty()) return false;
    std::error_code failure;
    if (!m_file.is_open()) failure = open();
    if (!failure && m_end + count > m_most) {
        m_error = "the disk is nearly full";
        return false;
    }
    if (!failure) failure = m_file.write(m_end, {bytes, count});
    if (failure) {
        m_error = failure.message();
        return false;
    }
    offset = m_end;
    m_end += count;
    return true;
}

bool TileSpill::read(std::uint64_t offset, std::byte* bytes, std::size_t count) const {
    return !m_file.read(offset, {bytes, count});
}

}  // namespace granita
