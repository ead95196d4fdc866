// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/session.h"

#include <map>
#include <string>

namespace granita {

void Session::adopt(Scene& scene) {
    const std::lock_guard lock(m_mutex);
    std::multimap<std::string, std::size_t> by_name;
    for (std::size_t i = 0; i < m_before.size(); ++i) by_name.emplace(m_before[i].name, i);
    for (std::size_t i = 0; i < scene.geometries.size(); ++i) {
        const auto [first, last] = by_name.equal_range(scene.geometries[i].name);
        for (auto known = first; known != last; ++known)
            if (is_same(m_before[known->second], scene.geometries[i])) {
                scene.geometries.adopt(i, m_before, known->second);
                by_name.erase(known);
                ++m_adopted;
                break;
            }
    }
    m_before.share_all(scene.geometries);
    m_shading.geometry->keep_only(m_before);
    m_shading.rays->keep_only(m_before);
}

std::unique_ptr<PersistentVisibility> Session::take_visibility(const Scene& scene) {
    const std::lock_guard lock(m_mutex);
    for (auto& kept : m_visibility)
        if (kept->is_of_size(scene)) {
            std::unique_ptr<PersistentVisibility> found = std::move(kept);
            std::erase(m_visibility, nullptr);
            return found;
        }
    return nullptr;
}

void Session::keep(std::unique_ptr<PersistentVisibility> visibility) {
    if (!visibility) return;
    std::vector<std::unique_ptr<PersistentVisibility>> dropped;  // freed outside the lock
    const std::lock_guard lock(m_mutex);
    std::uint64_t bytes = visibility->bytes();
    std::vector<std::unique_ptr<PersistentVisibility>> kept;
    kept.push_back(std::move(visibility));
    for (auto& other : m_visibility) {
        const bool fits = bytes + other->bytes() <= PersistentVisibility::kMostBytes;
        const bool is_other_size = !other->is_of_size(kept.front()->scene());
        bytes += fits && is_other_size ? other->bytes() : 0;
        (fits && is_other_size ? kept : dropped).push_back(std::move(other));
    }
    m_visibility = std::move(kept);
}

}  // namespace granita
