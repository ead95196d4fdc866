// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/kept_rays.h"

#include <algorithm>
#include <set>
#include <string>

#include "base/error.h"

namespace granita {
namespace {

bool add_bytes(void* user, ssize_t bytes, bool) {
    static_cast<std::atomic<long long>*>(user)->fetch_add(bytes, std::memory_order_relaxed);
    return true;
}

}  // namespace

KeptRays::KeptRays() : m_device(rtcNewDevice(nullptr)) {
    if (!m_device)
        throw Error("Embree cannot start: error " + std::to_string(rtcGetDeviceError(nullptr)));
    rtcSetDeviceMemoryMonitorFunction(m_device.get(), add_bytes, &m_bytes);
}

std::shared_ptr<const KeptRayShape> KeptRays::find(const RayKey& key) const {
    const std::lock_guard lock(m_mutex);
    const auto [first, last] = m_shapes.equal_range(key.data.get());
    for (auto shape = first; shape != last; ++shape)
        if (shape->second->key == key) return shape->second;
    return nullptr;
}

void KeptRays::add(std::shared_ptr<const KeptRayShape> made) {
    const std::lock_guard lock(m_mutex);
    m_shapes.emplace(made->key.data.get(), std::move(made));
    ++m_made;
}

void KeptRays::keep_only(const GeometryList& geometries) {
    const std::set<const GeometryData*> there = geometries.members();
    const std::lock_guard lock(m_mutex);
    std::erase_if(m_shapes, [&](const auto& entry) { return !there.contains(entry.first); });
}

std::size_t KeptRays::embree_bytes() const {
    return static_cast<std::size_t>(std::max(0LL, m_bytes.load()));
}

}  // namespace granita
