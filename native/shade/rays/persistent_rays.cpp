// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/persistent_rays.h"

#include <algorithm>
#include <new>
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

RTCDevice PersistentRays::device() {
    m_started.call([&] {
        m_device.reset(rtcNewDevice(nullptr));
        if (!m_device) {
            const RTCError error = rtcGetDeviceError(nullptr);
            if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
            throw Error("Embree cannot start: error " + std::to_string(error));
        }
        rtcSetDeviceMemoryMonitorFunction(m_device.get(), add_bytes, &m_bytes);
    });
    return m_device.get();
}

std::shared_ptr<const PersistentRayShape> PersistentRays::find(const RayKey& key) {
    const std::lock_guard lock(m_mutex);
    const auto shapes = m_shapes.find(of(key));
    if (shapes == m_shapes.end()) return nullptr;
    Shapes& all = shapes->second;
    const auto found =
        std::ranges::find_if(all, [&](const auto& shape) { return shape->key == key; });
    if (found == all.end()) return nullptr;
    std::rotate(all.begin(), found, found + 1);
    return all.front();
}

std::shared_ptr<const PersistentRayShape> PersistentRays::find_mesh(const GeometryData* data,
                                                                    float frame_time) {
    const std::lock_guard lock(m_mutex);
    const auto shapes = m_shapes.find({data, false, 0});
    if (shapes == m_shapes.end()) return nullptr;
    const auto found = std::ranges::find_if(
        shapes->second, [&](const auto& shape) { return shape->key.frame_time == frame_time; });
    return found == shapes->second.end() ? nullptr : *found;
}

void PersistentRays::add(std::shared_ptr<const PersistentRayShape> made) {
    std::shared_ptr<const PersistentRayShape> dropped;  // freed outside the lock
    const std::lock_guard lock(m_mutex);
    Shapes& all = m_shapes[of(made->key)];
    all.insert(all.begin(), std::move(made));
    ++m_made;
    if (all.size() <= kMostOfOne) return;
    dropped = std::move(all.back());
    all.pop_back();
}

void PersistentRays::keep_only(const GeometryList& geometries) {
    const std::set<const GeometryData*> there = geometries.members();
    const std::lock_guard lock(m_mutex);
    std::erase_if(m_shapes, [&](const auto& entry) {
        return !there.contains(std::get<const GeometryData*>(entry.first));
    });
}

std::size_t PersistentRays::embree_bytes() const {
    return static_cast<std::size_t>(std::max(0LL, m_bytes.load()));
}

}  // namespace granita
