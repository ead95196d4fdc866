// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/report.h"

namespace granita {

void Report::warn(const std::string& datablock, const std::string& message, std::uint64_t count) {
    const std::lock_guard lock(m_mutex);
    m_warnings[{datablock, message}] += count;
}

std::vector<Warning> Report::warnings() const {
    const std::lock_guard lock(m_mutex);
    std::vector<Warning> list;
    for (const auto& [key, count] : m_warnings) list.push_back({key.first, key.second, count});
    return list;
}

void Report::add(const Report& other) {
    for (const Warning& w : other.warnings()) warn(w.datablock, w.message, w.count);
}

void Report::add_new(const Report& other) {
    const std::vector<Warning> list = other.warnings();
    const std::lock_guard lock(m_mutex);
    for (const Warning& w : list) m_warnings.try_emplace({w.datablock, w.message}, w.count);
}

}  // namespace granita
